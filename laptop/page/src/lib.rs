//! The laptop library for a browser: requests in JSON in; answers in JSON and arrays of numbers out.
//!
//! A worker of the page lends the files that its user dropped, and asks. Nothing leaves the browser.

mod ask;
mod board;
mod catalogue;
mod export;
mod flight;
mod frames;
mod front;
mod host;
mod recording;
mod run;
mod words;
