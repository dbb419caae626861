//! Chips' drivers against their models, as one program: what its files share is compiled and linked once.

mod bus;
mod common;

mod chip_akd1500;
mod chip_faults;
mod chip_handshake;
mod chip_network;
mod chip_reckon;
mod chip_reckon_pairs;
mod chip_search;
mod chip_silicon;
mod chip_words;
mod chip_xylo;
