//! x
#![allow(dead_code)]
mod codec;
mod sample_type;
mod scheme;
mod settings;
fn main() {
    let c = codec::Codec::new(
        sample_type::SampleType::F32,
        &settings::Settings::Gaussian(settings::Evenly {
            neurons: std::env::args().count(),
            min: 0.0,
            max: 1.0,
        }),
    )
    .unwrap();
    println!("{}", c.latency());
}
