//! The bodies of the examples on the host: against exact bus transactions, and against a sensor that fails in every way that
//! a bus and a supply can.

mod bmi088;
mod bmi323;
mod code;
mod device;
mod i2c;
mod sampler;

/// The result of what is a future without the feature `blocking`. Nothing here ever waits.
#[cfg(not(feature = "blocking"))]
fn finish<F: Future>(future: F) -> F::Output {
    use std::{pin::pin, task::Context, task::Poll, task::Waker};
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(result) => result,
        Poll::Pending => panic!("a bus on the host does not wait"),
    }
}

#[cfg(feature = "blocking")]
fn finish<T>(result: T) -> T {
    result
}
