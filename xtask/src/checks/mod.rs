//! The steps of `cargo verify`, except those that belong to a figure or a product; `verify` lists all steps.

pub mod emulate;
mod emulator;
pub mod everyday;
pub mod fifo;
pub mod firmware;
pub mod fuzz;
pub mod interface;
pub mod link;
pub mod logging;
pub mod long;
pub mod network;
pub mod network_flies;
pub mod nucleo;
pub mod package;
pub mod peers;
pub mod rate_loop;
pub mod real_boards;
pub mod reckon;
mod recording;
pub mod ros;
pub mod ros2;
pub mod simulated_drone;
pub mod soak;
pub mod storm;
pub mod templates;
pub mod tuned;
pub mod video;
