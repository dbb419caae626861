//! Reads trained networks, runs them in double precision, and brings them onto chips or the flight controller.

mod bring;
mod chip;
mod controller;
mod costs;
mod distance;
mod fault;
mod nir;
mod plain;
mod reckon;
mod tiny_odin;
mod trained;

pub use bring::{
    Brought, Figures, HeldOut, LayerFigures, Outputs, PotentialFigures, Request, WINDOW, bring,
};
pub use chip::{CHIPS, Chip, Compare, OnChip, Ran, Remarks, Stepped};
pub use controller::{
    Asked, Choice, ControllerRequest, Current, Decay, Fires, Flown, Found, Framework, Model,
    Numbers, Reset, Rule, State, bring_to_controller,
};
pub use costs::Cost;
pub use distance::Distance;
pub use fault::{FitKind, LayerKind, ModelKind, NetworkKind, NirKind};
pub use reckon::ReckOn;
pub use tiny_odin::TinyOdin;
pub use trained::{Trained, Trains};

use crate::error::At;
use crate::{Error, Result};
use std::fs;
use std::path::Path;

/// The first bytes of every HDF5 file.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// A network file that was read, in one of the supported formats.
pub enum File {
    /// A network in JSON. Its parameters, such as decay factors, apply to one time step.
    Plain(Trained),
    /// A network as a NIR graph. Its time constants are in seconds.
    Nir(Box<nir::Chain>),
    /// A network in TOML, which holds the rule of its neurons.
    Toml(Model),
}

impl File {
    /// Reads a network from a file: a NIR graph, or a network in JSON or TOML.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or has none of these formats.
    pub fn read(path: &Path) -> Result<Self> {
        let unread = |error| Error::open(path.display().to_string(), error);
        let bytes = fs::read(path).map_err(unread)?;
        if bytes.starts_with(HDF5) {
            return Ok(Self::Nir(Box::new(nir::read(bytes).at(|| path)?)));
        }
        if bytes.trim_ascii_start().starts_with(b"{") {
            return Ok(Self::Plain(plain::read(&bytes).at(|| path)?));
        }
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
            let text = String::from_utf8_lossy(&bytes);
            return Ok(Self::Toml(Model::from_toml(&text).at(|| path)?));
        }
        Err(NetworkKind::NoNetwork.at(path))
    }

    /// Finds the rule by which the network gives the recorded `outputs`. The parts in `asked` are kept. Returns `None` if
    /// the file holds the rule itself, as all files except NIR graphs do.
    ///
    /// # Errors
    /// Returns an error if the recording is not one of this network, if no rule gives its outputs, or if several do.
    pub fn find_rule(
        &self,
        asked: &Asked,
        inputs: &Trains,
        outputs: &Outputs,
    ) -> Result<Option<Found>> {
        let layer = match self {
            Self::Plain(trained) => trained.outputs(),
            Self::Nir(chain) => chain.outputs(),
            Self::Toml(model) => model.outputs(),
        };
        outputs.check(&layer, inputs.len())?;
        let Self::Nir(chain) = self else { return Ok(None) };
        for step in inputs {
            let is_known = step.iter().all(|input| usize::from(*input) < chain.inputs());
            fault::ensure!(
                is_known,
                NetworkKind::NoInputs { inputs: chain.inputs(), step: step.clone() }
            );
        }
        controller::find(chain, asked, inputs, outputs).map(Some)
    }

    /// Converts the network to the form that `spikewire-network` runs on the flight controller. If the file leaves open
    /// how neurons decay, fire or reset, `asked` decides.
    ///
    /// # Errors
    /// Returns an error if the file and `asked` together leave part of the rule open, or if they contradict each other.
    pub fn on_controller(self, asked: &Asked) -> Result<Model> {
        match self {
            Self::Plain(trained) => Model::of_plain(trained, asked),
            Self::Nir(chain) => Model::of_nir(*chain, asked),
            Self::Toml(model) => model.unless_asked(asked),
        }
    }

    /// Converts the network to the form that can be brought onto chips. If the file leaves open how neurons decay, fire
    /// or reset, `asked` decides. `asked` may also set the duration of a step. Otherwise, a step lasts `seconds`, as in
    /// the recording.
    ///
    /// # Errors
    /// Returns an error if the file and `asked` together leave part of the rule open, or if no chip supports the
    /// network's neurons.
    pub fn on_chip(self, asked: &Asked, seconds: Option<f64>) -> Result<Trained> {
        let trained = match self {
            Self::Plain(trained) => trained.reset_by(asked),
            Self::Nir(chain) => Model::of_nir(*chain, &asked.on_chip(seconds))?.on_chip(),
            Self::Toml(model) => model.unless_asked(asked)?.on_chip(),
        }?;
        let all_reset = trained.layers.iter().all(|layer| layer.reset != Reset::NoReset);
        fault::ensure!(all_reset, FitKind::NoReset);
        Ok(trained)
    }
}
