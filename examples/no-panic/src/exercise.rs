//! Every method, on values of which the compiler knows nothing.

use core::hint::black_box;
use spikewire::{Code, Encoder, Output, Scheme, Start};

/// A scheme whose encoder starts by itself.
pub fn scheme<P: Start>(scheme: &P) {
    codec(scheme, P::START);
    let mut encoder = black_box(scheme.encoder());
    encoder.reset();
    black_box(encoder.rejected());
}

/// A scheme, from a state of its encoder.
pub fn codec<P: Scheme>(scheme: &P, start: P::EncoderState) {
    let mut encoder = black_box(Encoder::with_state(scheme, start));
    let mut decoder = black_box(scheme.decoder());
    let samples = black_box([P::Sample::default(); 4]);

    encoder.prime(black_box(&samples));
    let mut outputs = samples.map(|sample| encoder.encode(sample));
    black_box(encoder.encode_slice(&samples, &mut outputs));
    for code in black_box(outputs).into_iter().filter_map(Output::code) {
        for firing in code.firings() {
            black_box(firing);
        }
        black_box(P::Code::assemble(code.firings()));
        let mut values = [decoder.decode(code)];
        black_box(decoder.decode_slice(black_box(&[code]), &mut values));
        black_box(values);
    }
    while let Some(code) = encoder.finish_next() {
        black_box(decoder.decode(code));
    }
    black_box(encoder.finish().count());
    if let Some(value) = encoder.keyframe() {
        decoder.resync(value);
    }
    black_box(decoder.held());
    black_box(encoder.rejected());
    decoder.reset();
    black_box((encoder, decoder));
}
