//! Command-line options generated from the catalogue, which describes each scheme's parameters.

use crate::words;
use anyhow::{Result as Checked, bail};
use catalogue::run::{Asked, SET, SampleType, Value, Worded};
use catalogue::{Found, Info, Kind, Parameter, Unit};
use clap::builder::{MapValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command};
use lab::coding::Coding as File;
use lab::output::Output;
use lab::scheme::Scheme;
use std::fmt::{Display, Write as _};
use std::io::Write as _;
use std::path::Path;
use std::str::FromStr;

/// Options that choose the scheme, its sample type and its parameters. Values that are not on the command line are
/// taken from the file of `--params`.
#[derive(Args, Clone, Debug)]
pub(crate) struct Coding {
    /// Encoding scheme; may be left out if --params names it
    #[arg(long, value_parser = schemes())]
    scheme: Option<Scheme>,
    /// Sample type: f32, i16, i32, or fixed point such as q16.16 or q8.8; default: f32
    #[arg(long)]
    sample: Option<SampleType>,
    /// File of parameters (TOML), as written by `tune --emit toml`; options on the command line override it
    #[arg(long, value_name = "FILE", value_parser = read)]
    params: Option<File>,
    #[command(flatten)]
    parameters: SchemeOptions,
}

/// Parses an unsigned integer.
///
/// # Errors
/// Returns a message if the text is not an integer, is negative, or is too large for `T`.
pub(crate) fn whole<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| "must be a whole number, 0 or more".to_owned())
}

/// Reads the file of parameters at `path`, the value of `--params`.
pub(crate) fn read(path: &str) -> Result<File, String> {
    File::read(path).map_err(|error| words::of_lab(&error))
}

/// The scheme if one was named, the sample type, and the parameters that were given.
pub(crate) type Chosen = (Option<Scheme>, SampleType, Asked);

impl Coding {
    /// Combines the options with the file of `--params`, and returns scheme, sample type and parameters. The scheme is
    /// `None` if neither the options nor the file name one.
    ///
    /// # Errors
    /// Returns an error if `--scheme` and the file name different schemes.
    pub(crate) fn chosen(&self) -> Checked<Chosen> {
        let Self { scheme, sample, params, parameters } = self;
        let mut chosen = (*scheme, sample.unwrap_or_default(), parameters.0.clone());
        if let Some(params) = params {
            let scheme = agreed(params, *scheme)?;
            let sample = sample.unwrap_or(params.sample);
            chosen = (Some(scheme), sample, parameters.0.or(&params.asked));
        }
        Ok(chosen)
    }

    /// Returns the scheme, the sample type and the parameters, from the command line and the file of `--params`.
    ///
    /// # Errors
    /// Returns an error if neither command line nor file names a scheme, or if they name different schemes.
    pub(crate) fn one(&self) -> Checked<(Scheme, SampleType, Asked)> {
        let (scheme, sample, parameters) = self.chosen()?;
        let Some(scheme) = scheme else {
            let names: Vec<&str> = Scheme::all().map(Scheme::name).collect();
            bail!("--scheme must say which, or --params; there are {}", names.join(", "))
        };
        Ok((scheme, sample, parameters))
    }

    /// Returns whether `--scheme` or `--params` is given.
    pub(crate) fn is_named(&self) -> bool {
        self.scheme.is_some() || self.params.is_some()
    }
}

/// Returns the scheme of a file of parameters.
///
/// # Errors
/// Returns an error if `named`, the scheme given by `--scheme`, is a different one.
pub(crate) fn agreed(file: &File, named: Option<Scheme>) -> Checked<Scheme> {
    match named {
        Some(named) if named != file.scheme => {
            bail!("--params is of {}, --scheme says {}", file.scheme.name(), named.name())
        }
        _ => Ok(file.scheme),
    }
}

/// Returns a parser of a scheme's name, whose help lists all schemes.
pub(crate) fn schemes() -> MapValueParser<PossibleValuesParser, fn(String) -> Scheme> {
    let values = catalogue::INFO.iter().map(|info| PossibleValue::new(info.name).help(info.words));
    PossibleValuesParser::new(values.collect::<Vec<_>>()).map(|name| {
        // `PossibleValuesParser` accepts no other name.
        Scheme::named(&name).unwrap_or_default()
    })
}

/// Implements clap's traits for a newtype around [`Asked`], so that it can be flattened into a command's options.
/// `$declare` adds the options to a command; `$read` makes the [`Asked`] from the parsed arguments.
macro_rules! option_group {
    ($name:ident, $declare:expr, $read:expr) => {
        impl clap::Args for $name {
            fn augment_args(command: clap::Command) -> clap::Command {
                $declare(command)
            }

            fn augment_args_for_update(command: clap::Command) -> clap::Command {
                Self::augment_args(command)
            }
        }

        impl clap::FromArgMatches for $name {
            fn from_arg_matches(matches: &clap::ArgMatches) -> Result<Self, clap::Error> {
                Ok(Self($read(matches)))
            }

            fn update_from_arg_matches(
                &mut self,
                matches: &clap::ArgMatches,
            ) -> Result<(), clap::Error> {
                *self = Self::from_arg_matches(matches)?;
                Ok(())
            }
        }
    };
}
pub(crate) use option_group;

/// Options for the parameters of all schemes.
#[derive(Clone, Debug)]
pub(crate) struct SchemeOptions(pub Asked);

option_group!(
    SchemeOptions,
    |command| augment(command, |_| true).arg(
        Arg::new("paper").long("paper").action(ArgAction::SetTrue).help_heading(PARAMETERS).help(
            "Settings of the paper's benchmark, scaled to the signal's range, for what is not given"
        ),
    ),
    |matches: &ArgMatches| {
        let mut asked = given(matches, |_| true);
        asked.paper = matches.get_flag("paper");
        asked
    }
);

const PARAMETERS: &str = "Parameters";
const CALIBRATION: &str = "Instead of calibration";

/// Adds options to `command` for the parameters of all schemes, except for parameters for which `is_taken` returns
/// false. Schemes with a parameter of the same name share one option.
pub(crate) fn augment(mut command: Command, is_taken: fn(&Parameter) -> bool) -> Command {
    for (name, owners) in parameters(is_taken) {
        let Some(&(_, parameter)) = owners.first() else { continue };
        let heading = if parameter.found.is_some() { CALIBRATION } else { PARAMETERS };
        let arg = Arg::new(name).long(name).help(help(&owners)).help_heading(heading);
        let arg = match parameter.kind {
            Kind::Number => arg.allow_negative_numbers(true).value_name("NUMBER"),
            Kind::Count => arg.value_name("COUNT"),
            Kind::Choice(words) => {
                arg.value_parser(PossibleValuesParser::new(words).map(Value::from))
            }
            Kind::Flag => arg.action(ArgAction::SetTrue),
            Kind::Text => arg.allow_hyphen_values(true).value_name("VALUE"),
            Kind::Filter => arg.value_name("FILTER"),
        };
        let arg = match parameter.kind {
            Kind::Choice(_) | Kind::Flag => arg,
            _ => arg.value_parser(move |text: &str| read_value(parameter, text)),
        };
        command = command.arg(arg);
    }
    command
}

/// Returns the parameters that `is_taken` accepts and that were given on the command line.
pub(crate) fn given(matches: &ArgMatches, is_taken: fn(&Parameter) -> bool) -> Asked {
    let mut asked = Asked::default();
    for (name, owners) in parameters(is_taken) {
        if owners.first().is_some_and(|(_, parameter)| parameter.kind == Kind::Flag) {
            if matches.get_flag(name) {
                asked.set(name, SET);
            }
        } else if let Some(value) = matches.get_one::<Value>(name) {
            asked.set(name, value.clone());
        }
    }
    asked
}

/// Parses the value that an option gives to a parameter. If the parameter is a filter, the text may also be [`FREE`].
///
/// # Errors
/// Returns a message if the text is not a value of the parameter's kind.
fn read_value(parameter: &Parameter, text: &str) -> Result<Value, String> {
    if parameter.kind == Kind::Filter && text == FREE {
        return Ok(FREE.into());
    }
    parameter.read(text).map_err(|error| error.without_subject().spelled(words::option).to_string())
}

/// The value of `--filter` with which `tune` searches for each coefficient of the filter, rather than for the filter's
/// shape, length and sum.
pub(crate) const FREE: &str = "free";

/// The name of an option, and a pair (scheme, parameter) for each parameter of this name.
type Owned = (&'static str, Vec<(&'static Info, &'static Parameter)>);

fn parameters(is_taken: fn(&Parameter) -> bool) -> Vec<Owned> {
    let mut all: Vec<Owned> = Vec::new();
    for scheme in catalogue::INFO {
        for parameter in scheme.parameters.iter().filter(|parameter| is_taken(parameter)) {
            match all.iter_mut().find(|(name, _)| *name == parameter.name) {
                Some((_, owners)) => owners.push((scheme, parameter)),
                None => all.push((parameter.name, vec![(scheme, parameter)])),
            }
        }
    }
    all
}

/// Returns the help text of an option. `owners` are the schemes that share the option, each with its parameter. Schemes
/// for which the option has the same meaning are listed together: `sf, mw: MEANING, in the signal's unit, such as 0.1.
/// tbr: OTHER MEANING`.
fn help(owners: &[(&'static Info, &'static Parameter)]) -> String {
    let mut meanings: Vec<(Vec<&str>, String)> = Vec::new();
    for (info, parameter) in owners {
        let meaning = meaning(parameter);
        match meanings.iter_mut().find(|(_, known)| *known == meaning) {
            Some((names, _)) => names.push(info.name),
            None => meanings.push((vec![info.name], meaning)),
        }
    }
    let all =
        meanings.into_iter().map(|(names, meaning)| format!("{}: {meaning}", names.join(", ")));
    all.collect::<Vec<_>>().join(". ")
}

fn meaning(parameter: &Parameter) -> String {
    let mut text = parameter.help.to_owned();
    // Writing to a string cannot fail.
    let _ = match parameter.unit {
        Unit::Signal if parameter.kind == Kind::Number => write!(text, ", in the signal's unit"),
        _ => Ok(()),
    };
    if !parameter.example.is_empty() {
        let _ = write!(text, ", such as `{}`", parameter.example);
    }
    let default = match parameter.found {
        Some(Found::First) | None => parameter.default,
        Some(_) => Some("found by a pass over the signal"),
    };
    if let Some(default) = default {
        let _ = write!(text, "; {default} unless given");
    }
    text
}

/// Checks that the name of an output fits what is written: it ends in `ending` or `.txt`, or has no ending. A device may
/// have any name.
///
/// # Errors
/// Returns an error that says `what` is written if the name has another ending.
pub(crate) fn check_ending(output: Option<&Path>, ending: &str, what: &str) -> Checked<()> {
    let Some(path) = output else { return Ok(()) };
    let Some(own) = path.extension() else { return Ok(()) };
    let is_device = path.metadata().is_ok_and(|data| !data.is_file());
    if is_device || [ending, "txt"].iter().any(|ending| own.eq_ignore_ascii_case(ending)) {
        return Ok(());
    }
    let (path, own) = (path.display(), own.display());
    bail!(
        "{path}: {what} is written, and no .{own}; the name ends in .{ending} or .txt, or has no ending"
    )
}

/// Writes a command's result to standard output.
///
/// # Errors
/// Returns an error if standard output cannot be written.
pub(crate) fn answer(text: impl Display) -> Checked<()> {
    let mut output = Output::to(None)?;
    write!(output, "{text}")?;
    Ok(output.finish()?)
}
