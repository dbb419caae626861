//! D in C, which was written by hand, on the same spikes. It takes other bits of the same weights: only their number counts.

use crate::sizes::{float as floats, integer as integers, measure};
use board::stopwatch::{instructions, keep};
use core::ffi::c_void;
use core::fmt;
use core::ptr::from_ref;

/// A neuron of `plain.c`: the decays of its current and potential, its bias and its threshold.
#[repr(C)]
struct Neuron<T>([T; 4]);

/// The state of `plain.c`, in words of two currents and potentials a neuron, four outputs, two lists and a count.
#[repr(C, align(4))]
struct State([u32; 2 * 256 + 4 + 256 + 1]);

type Step<T> = unsafe extern "C" fn(
    *const c_void,
    *const c_void,
    *const c_void,
    *const Neuron<T>,
    *mut State,
    *const u16,
    usize,
) -> usize;

unsafe extern "C" {
    fn plain_float(
        weights: *const c_void,
        back: *const c_void,
        out: *const c_void,
        neurons: *const Neuron<f32>,
        state: *mut State,
        inputs: *const u16,
        count: usize,
    ) -> usize;
    fn plain_int(
        weights: *const c_void,
        back: *const c_void,
        out: *const c_void,
        neurons: *const Neuron<i32>,
        state: *mut State,
        inputs: *const u16,
        count: usize,
    ) -> usize;
}

fn run<T: Copy>(
    out: &mut impl fmt::Write,
    name: &str,
    step: Step<T>,
    weights: [*const c_void; 3],
    neuron: impl Fn(bool) -> [T; 4],
) -> fmt::Result {
    let mut state = State([0; 773]);
    let mut neurons = [(); 256].map(|()| Neuron(neuron(false)));
    let [weights, back, last] = weights;
    measure::<256>(out, name, 16, size_of::<State>(), |fires, input| {
        for (own, &fires) in neurons.iter_mut().zip(fires) {
            own.0 = neuron(fires);
        }
        let mut fired = 0;
        let count = instructions(|| {
            // SAFETY: the arrays are of the sizes that `plain.c` has, and its inputs below 16.
            fired = unsafe {
                step(
                    weights,
                    back,
                    last,
                    neurons.as_ptr(),
                    &raw mut state,
                    input.as_ptr(),
                    input.len(),
                )
            };
            keep(&fired);
        });
        (count, fired)
    })
}

pub fn float(out: &mut impl fmt::Write) -> fmt::Result {
    let weights = [
        from_ref(&floats::D_IN).cast(),
        from_ref(&floats::D_BACK).cast(),
        from_ref(&floats::D_OUT).cast(),
    ];
    let bias = |fires| if fires { 10_000.0 } else { -10_000.0 };
    run(out, "D,f32 in C", plain_float, weights, |fires| [0.25, 0.25, bias(fires), 1.0])
}

pub fn integer(out: &mut impl fmt::Write) -> fmt::Result {
    let weights = [
        from_ref(&integers::D_IN).cast(),
        from_ref(&integers::D_BACK).cast(),
        from_ref(&integers::D_OUT).cast(),
    ];
    let bias = |fires| if fires { 1 << 24 } else { -(1 << 24) };
    run(out, "D,i8 in C", plain_int, weights, |fires| [16_384, 16_384, bias(fires), 1_000])
}
