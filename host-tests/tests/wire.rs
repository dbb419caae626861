//! Queues, links and sinks, as one program: what its files share is compiled and linked once.

mod beside;
mod bus;
mod common;
mod interleaving_world;

mod heapless;
mod interleaving;
mod link_description;
mod link_drift;
mod link_ends;
mod link_frames;
mod link_loss;
mod link_outage;
mod link_readout;
mod link_receiver;
mod link_short;
mod link_time;
mod queue;
mod sink_bus;
mod sink_io06;
