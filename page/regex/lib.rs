//! `regex` for those who need it on ASCII only.

pub use regex_lite::*;
