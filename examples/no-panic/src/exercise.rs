//! Every method, on values of which the compiler knows nothing.

use core::hint::black_box;
use spikewire::{Bank, Code, Decoder, Encoder, Output, Scheme};

/// A scheme's encoder, alone and in a bank, and its decoder.
pub fn scheme<P: Scheme>(scheme: P) {
    let scheme = black_box(scheme);
    codec(scheme.encoder(), scheme.decoder());
    bank(Bank::<_, 3>::new(scheme));
}

/// An encoder and the decoder that belongs to it.
pub fn codec<E, D>(encoder: E, decoder: D)
where
    E: Encoder,
    D: Decoder<Sample = E::Sample, Code = <E::Output as Output>::Code>,
{
    let (mut encoder, mut decoder) = black_box((encoder, decoder));
    let samples = black_box([E::Sample::default(); 4]);

    let mut outputs = samples.map(|sample| encoder.encode(sample));
    black_box(encoder.encode_slice(&samples, &mut outputs));
    for code in black_box(outputs).into_iter().filter_map(Output::code) {
        for firing in code.firings() {
            black_box(firing);
        }
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
    black_box(encoder.rejected());
    encoder.reset();
    decoder.reset();
    black_box((encoder, decoder));
}

fn bank<E: Encoder, const N: usize>(bank: Bank<E, N>) {
    let mut bank = black_box(bank).with_slot_ticks(black_box(100));
    let samples = black_box([E::Sample::default(); N]);
    bank.encode(black_box(0), samples, |event| {
        black_box(event);
    });
    black_box(bank.rejected());
    bank.reset();
    black_box(bank);
}
