//! Texts that name settings. The library words each text once, and each front end spells the settings in its own way:
//! as an option, a keyword, or a box of a page.

use std::borrow::Cow;
use std::fmt;

/// Spells the name of a setting for a front end, such as `--loop-bandwidth` for `loop_bandwidth`.
pub type Spell = fn(&str) -> String;

/// Spells a setting as the library does by default: its name in backticks.
pub fn quoted(name: &str) -> String {
    format!("`{name}`")
}

/// Spells several settings, separated by `between`.
pub fn joined<N: AsRef<str>>(names: &[N], spell: Spell, between: &str) -> String {
    names.iter().map(|name| spell(name.as_ref())).collect::<Vec<_>>().join(between)
}

/// A value that can be put into words, in which a front end spells the settings.
pub trait Worded {
    /// Writes the words.
    ///
    /// # Errors
    /// Returns the formatter's errors.
    fn word(&self, f: &mut fmt::Formatter<'_>, spell: Spell) -> fmt::Result;

    /// Returns the words, with the spelling of a front end.
    fn spelled(&self, spell: Spell) -> Spelled<'_, Self> {
        Spelled(self, spell)
    }
}

/// A value in words, with the spelling of a front end.
pub struct Spelled<'a, T: ?Sized>(&'a T, Spell);

impl<T: Worded + ?Sized> fmt::Display for Spelled<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.word(f, self.1)
    }
}

/// The setting that an error is about, with its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Given {
    /// Name, as in the catalogue and in requests.
    pub name: Cow<'static, str>,
    /// Value as text, if one was given.
    pub value: Option<String>,
    /// Whether the name is that in a file, or in complete settings; front ends do not respell it.
    pub is_listed: bool,
}

impl Given {
    /// Makes a setting without a value.
    pub fn named(name: impl Into<Cow<'static, str>>) -> Self {
        Self { name: name.into(), value: None, is_listed: false }
    }

    /// Makes a setting with its value.
    pub fn new(name: impl Into<Cow<'static, str>>, value: impl fmt::Display) -> Self {
        Self { name: name.into(), value: Some(value.to_string()), is_listed: false }
    }

    /// Makes a setting whose name front ends do not respell.
    pub fn listed(name: &str, value: Option<impl fmt::Display>) -> Self {
        let value = value.map(|value| value.to_string());
        Self { name: name.to_owned().into(), value, is_listed: true }
    }

    /// Returns the spelled name, followed by the value.
    pub fn subject(&self, spell: Spell) -> String {
        let name = if self.is_listed { self.name.to_string() } else { spell(&self.name) };
        match &self.value {
            None => name,
            Some(value) => format!("{name} {value}"),
        }
    }
}

/// Declares kinds of errors, each with its data and its words. In the words, `subject` stands for the setting with its
/// value, and `spell` for the front end's spelling.
#[macro_export]
macro_rules! kinds {
    ($(#[$about:meta])* pub enum $Kinds:ident by $spell:ident of $subject:ident {
        $($kind:ident $({ $($field:ident: $type:ty),* $(,)? })? => ($($words:tt)+)),* $(,)?
    }) => {
        $(#[$about])*
        #[derive(Debug)]
        #[non_exhaustive]
        #[allow(missing_docs)] // the words say it
        pub enum $Kinds {
            $(#[doc = stringify!($($words)+)] $kind $({ $($field: $type),* })?),*
        }

        impl $Kinds {
            /// Returns the name of the kind, for programs.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$kind { .. } => stringify!($kind)),*
                }
            }

            /// Writes the words about a setting. If there is none, the words after it stand alone.
            ///
            /// # Errors
            /// Returns the formatter's errors.
            pub fn word_about(
                &self,
                f: &mut std::fmt::Formatter<'_>,
                spell: $crate::run::Spell,
                about: Option<&$crate::run::Given>,
            ) -> std::fmt::Result {
                match about {
                    Some(own) => self.word_of(f, spell, &own.subject(spell)),
                    None => {
                        let mut words = String::new();
                        self.word_of(&mut words, spell, "")?;
                        f.write_str(words.trim_start_matches([':', ' ']))
                    }
                }
            }

            #[allow(unused_variables)]
            fn word_of(
                &self,
                f: &mut dyn std::fmt::Write,
                $spell: $crate::run::Spell,
                $subject: &str,
            ) -> std::fmt::Result {
                match self {
                    $(Self::$kind $({ $($field),* })? => write!(f, $($words)+)),*
                }
            }
        }
    };
}

/// A note for people that names settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Words(Vec<Part>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Text(String),
    Setting(&'static str),
}

impl Words {
    /// Appends a text.
    #[must_use]
    pub fn text(mut self, text: impl fmt::Display) -> Self {
        self.0.push(Part::Text(text.to_string()));
        self
    }

    /// Appends the name of a setting.
    #[must_use]
    pub fn setting(mut self, name: &'static str) -> Self {
        self.0.push(Part::Setting(name));
        self
    }

    /// Appends other words.
    #[must_use]
    pub fn words(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }
}

impl<T: Into<String>> From<T> for Words {
    fn from(text: T) -> Self {
        Self(vec![Part::Text(text.into())])
    }
}

impl Worded for Words {
    fn word(&self, f: &mut fmt::Formatter<'_>, spell: Spell) -> fmt::Result {
        self.0.iter().try_for_each(|part| match part {
            Part::Text(text) => f.write_str(text),
            Part::Setting(name) => f.write_str(&spell(name)),
        })
    }
}

impl fmt::Display for Words {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.word(f, quoted)
    }
}

#[cfg(test)]
mod tests {
    use super::{Given, Worded, Words};
    use crate::run::{Error, ErrorKind};

    fn option(name: &str) -> String {
        format!("--{}", name.replace('_', "-"))
    }

    #[test]
    fn a_front_spells_settings_and_nothing_else() {
        let error = |given| Error::of(given, ErrorKind::NotANumber);
        for (value, own, spelled) in [
            (
                error(Given::new("max_rmse", "`min`")),
                "`max_rmse` `min` is not a number",
                "--max-rmse `min` is not a number",
            ),
            (
                error(Given::listed("max_rmse", Some("x"))),
                "max_rmse x is not a number",
                "max_rmse x is not a number",
            ),
            (ErrorKind::NotANumber.into(), "is not a number", "is not a number"),
        ] {
            assert_eq!(value.to_string(), own);
            assert_eq!(value.spelled(option).to_string(), spelled);
        }
        let words = Words::from("column `rate`: is ").setting("time_unit").text(" another?");
        assert_eq!(words.to_string(), "column `rate`: is `time_unit` another?");
        assert_eq!(words.spelled(option).to_string(), "column `rate`: is --time-unit another?");
    }
}
