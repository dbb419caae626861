//! The critical section that the crate's queue asks for once, when it is split into its two ends.

use critical_section::RawRestoreState;

struct Unneeded;

critical_section::set_impl!(Unneeded);

// SAFETY: the only section that this library enters is in the split of a queue, within `sw_queue_init`, on storage
// that C promises nothing else uses during that call. There is nothing to guard it from.
unsafe impl critical_section::Impl for Unneeded {
    unsafe fn acquire() -> RawRestoreState {}

    unsafe fn release((): RawRestoreState) {}
}
