//! `ReckOn`'s driver, on a bus that does nothing.

use core::hint::black_box;
use embedded_hal::spi::ErrorKind;
use spikewire_chips::{
    ReckOn, ReckOnBytes, ReckOnLearning, ReckOnOutputs, ReckOnPort, ReckOnSettings, ReckOnStep,
    ReckOnSteps, ReckOnStepsState, ReckOnTarget, ReckOnTick,
};

use crate::exercise::hide;
use crate::links::Bus;

pub fn reckon() {
    let mut chip = black_box(ReckOn::new(Bus, Bus, black_box(3)));
    let learning = black_box(ReckOnLearning {
        learns: [true; 3],
        traces: [1; 3],
        signal: 2,
        thresholds: [3; 4],
        slopes: [4; 5],
        rates: [(5, 6); 3],
        is_linear: true,
    });
    let settings = ReckOnSettings { learning: Some(learning), ..black_box(ReckOnSettings::LABEL) };
    let (a, b) = black_box((1, 2));
    if let Ok(mut programmed) = chip.reset(&mut Bus) {
        if let Ok(network) = ReckOnBytes::new(black_box(&[0; 64])) {
            hide(programmed.load(&network, |progress| hide(progress.done)).is_ok());
            hide(programmed.verify(&network).is_ok());
            let mut copy = [0; 64];
            hide(ReckOnBytes::write(&network, &mut copy).is_ok());
        }
        hide([
            programmed.input_weight(a, b).is_ok(),
            programmed.recurrent_weight(a, b).is_ok(),
            programmed.output_weight(a, b).is_ok(),
            programmed.set_register(black_box(3), black_box(4)).is_ok(),
        ]);
        hide(programmed.run(&settings).is_ok());
    }
    if let Ok(started) = chip.started() {
        hide(started.begin().is_ok());
    }
    if let Ok(mut sample) = chip.sample() {
        let targets = black_box([1, 2, 3]);
        let some = targets.get(..black_box(2)).unwrap_or_default();
        for target in [ReckOnTarget::Label(a), ReckOnTarget::Potentials(some)] {
            hide(sample.send(a).is_ok());
            let step = ReckOnStep { counts: black_box(true), target: Some(target) };
            hide(sample.step(step).is_ok());
        }
        let keeps = black_box([0.5; 3]);
        let (ticks, unit) = black_box(([ReckOnTick { always: &[1], raises: &[2] }; 2], 0.1));
        for outputs in [
            ReckOnOutputs::Spikes,
            ReckOnOutputs::Potentials { unit },
            ReckOnOutputs::Leaky { unit, keeps: &keeps },
        ] {
            let (inputs, late) = black_box((4, 3));
            let steps = black_box(ReckOnSteps { inputs, ticks: &ticks, late, outputs });
            let mut state = black_box(ReckOnStepsState::REST);
            hide(sample.run(&steps, &mut state, black_box([1, 2])).is_ok());
            hide(state.values());
        }
        hide(sample.end().is_ok());
    }
    if let Ok(started) = chip.started() {
        hide(started.program().is_ok());
    }
    hide(chip.programmed().is_ok());
}

impl ReckOnPort for Bus {
    type Error = ErrorKind;

    fn set_input(&mut self, byte: u8, is_target: bool) -> Result<(), ErrorKind> {
        hide((byte, is_target));
        told()
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        told()
    }

    fn input_acknowledge(&mut self) -> Result<bool, ErrorKind> {
        black_box(Ok(true))
    }

    fn output_request(&mut self) -> Result<bool, ErrorKind> {
        black_box(Ok(true))
    }

    fn output(&mut self) -> Result<u8, ErrorKind> {
        black_box(Ok(1))
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        told()
    }

    fn set_sample(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        told()
    }

    fn set_tick(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        told()
    }

    fn set_target_valid(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        told()
    }

    fn set_infer(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        told()
    }

    fn ready(&mut self) -> Result<bool, ErrorKind> {
        black_box(Ok(true))
    }

    fn set_reset(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        told()
    }
}

fn told() -> Result<(), ErrorKind> {
    black_box(Ok(()))
}
