//! What a call returns, and what an initialisation tells of a bad parameter.

use core::ffi::{CStr, c_char};

use spikewire::ConfigError;
use spikewire::link::LinkError;

/// What a call returns: 0 or more if it did what it was asked, below 0 if not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Status(i32);

/// Declares the codes with their numbers and texts.
macro_rules! statuses {
    ($($(#[doc = $doc:literal])* $name:ident = $number:literal, $text:literal;)*) => {
        impl Status {
            $($(#[doc = $doc])* pub const $name: Self = Self($number);)*

            /// Every code: its name, its number and its text.
            pub const ALL: &[(&str, i32, &CStr)] = &[$((stringify!($name), $number, $text)),*];

            /// A line that says what it means.
            const fn text(self) -> &'static CStr {
                match self.0 {
                    $($number => $text,)*
                    _ => c"no such status",
                }
            }
        }
    };
}

statuses! {
    /// It is done.
    OK = 0, c"done";
    /// A rate code waits for later samples.
    WAITING = 1, c"the encoder waits for later samples";
    /// There is no keyframe, no item, no frame, no code now.
    NOTHING = 2, c"there is nothing now";
    /// See [`Reader::other_version`](spikewire::link::Reader::other_version).
    OTHER_VERSION = 3, c"the bytes are of another version of the link";
    /// See [`Withheld::Keyframe`](spikewire::link::Withheld::Keyframe).
    NO_KEYFRAME = 10, c"not exact: no keyframe since the start or the last loss";
    /// See [`Withheld::Samples`](spikewire::link::Withheld::Samples).
    NO_SAMPLES = 11, c"not exact: too few samples since the start or the last loss";
    /// See [`Withheld::Spike`](spikewire::link::Withheld::Spike).
    NO_SPIKE = 12, c"not exact: no spike in a whole sample since the start or the last loss";
    /// See [`Withheld::Heartbeat`](spikewire::link::Withheld::Heartbeat).
    NO_HEARTBEAT = 13, c"not exact: no heartbeat since the start or the last loss";
    /// See [`Withheld::Clock`](spikewire::link::Withheld::Clock).
    NO_CLOCK = 14, c"not exact: heartbeats are too far apart for sub-timesteps this short, with a clock known this well";
    /// See [`Withheld::Always`](spikewire::link::Withheld::Always).
    FADING = 15, c"not exact: the error of this code fades, and is never 0";
    /// See [`Withheld::Description`](spikewire::link::Withheld::Description).
    OTHER_FLIGHT = 17, c"not exact: the sender has another flight: other code, parameters, samples, filter, order or label";
    /// See [`Withheld::Contradicted`](spikewire::link::Withheld::Contradicted).
    CONTRADICTED = 18, c"not exact: a keyframe contradicts the value before it";
    /// Any other reason to call no value exact.
    WITHHELD = 19, c"not exact";
    /// A pointer is null.
    NULL = -1, c"a pointer is null";
    /// A pointer is misaligned.
    MISALIGNED = -2, c"a pointer is misaligned";
    /// Storage is too small.
    TOO_SMALL = -3, c"a buffer is too small";
    /// Two buffers overlap.
    OVERLAPPING = -4, c"two buffers overlap";
    /// A codec without its initialisation, or of another type.
    NOT_MADE = -5, c"the codec is not initialised, or is of another type";
    /// Storage without its start.
    NOT_STARTED = -6, c"it is not started";
    /// A number names no choice.
    BAD_CHOICE = -8, c"there is no such choice";
    /// A length is beyond the address space.
    BAD_LENGTH = -9, c"a length is beyond the address space";
    /// See [`ConfigError::NotPositive`].
    NOT_POSITIVE = -20, c"a parameter must be above 0 and finite";
    /// See [`ConfigError::Negative`].
    NEGATIVE = -21, c"a parameter must be 0 or more and finite";
    /// See [`ConfigError::NotFinite`].
    NOT_FINITE = -22, c"a parameter must be finite";
    /// See [`ConfigError::OutOfRange`].
    OUT_OF_RANGE = -23, c"a parameter is out of its range";
    /// See [`ConfigError::NotRising`].
    NOT_RISING = -24, c"a list must rise strictly";
    /// See [`ConfigError::AllZero`].
    ALL_ZERO = -25, c"a list is all 0";
    /// See [`ConfigError::EmptyCell`].
    EMPTY_CELL = -26, c"a cell holds no sample: the range is too narrow, or there are too many cells";
    /// See [`ConfigError::FieldTooWide`].
    FIELD_TOO_WIDE = -27, c"a receptive field wins where two others meet";
    /// See [`ConfigError::TooFewSamples`].
    TOO_FEW_SAMPLES = -28, c"the calibration has seen too few samples";
    /// A parameter is bad in a way that this version of the header does not name.
    BAD_PARAMETER = -29, c"a parameter is bad";
    /// The link refuses an item.
    LINK = -40, c"the link cannot write this item into a frame of this size";
}

impl From<Result<Self, Self>> for Status {
    fn from(result: Result<Self, Self>) -> Self {
        match result {
            Ok(status) | Err(status) => status,
        }
    }
}

impl From<LinkError> for Status {
    fn from(error: LinkError) -> Self {
        match error {
            LinkError::Full => Self::TOO_SMALL,
            _ => Self::LINK,
        }
    }
}

/// What is wrong with a parameter. Numbers that a status has no use for are 0.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Error {
    /// The status that the call returned.
    pub status: Status,
    /// Which of a list, from 0.
    pub index: u32,
    /// The parameter's name, not ended by 0; null if the status names none.
    pub parameter: *const c_char,
    /// The bytes of the name.
    pub parameter_length: u32,
    /// What it was.
    pub value: f32,
    /// The smallest value allowed.
    pub min: f32,
    /// The largest value allowed.
    pub max: f32,
}

impl Error {
    /// An error that names no parameter.
    pub(crate) const fn of(status: Status) -> Self {
        Self {
            status,
            index: 0,
            parameter: core::ptr::null(),
            parameter_length: 0,
            value: 0.0,
            min: 0.0,
            max: 0.0,
        }
    }

    fn named(status: Status, name: &'static str) -> Self {
        let (parameter, parameter_length) = (name.as_ptr().cast(), name.len() as u32);
        Self { parameter, parameter_length, ..Self::of(status) }
    }
}

impl From<ConfigError> for Error {
    fn from(error: ConfigError) -> Self {
        match error {
            ConfigError::NotPositive { parameter, value } => {
                Self { value, ..Self::named(Status::NOT_POSITIVE, parameter) }
            }
            ConfigError::Negative { parameter, value } => {
                Self { value, ..Self::named(Status::NEGATIVE, parameter) }
            }
            ConfigError::NotFinite { parameter, value } => {
                Self { value, ..Self::named(Status::NOT_FINITE, parameter) }
            }
            ConfigError::OutOfRange { parameter, value, min, max } => {
                Self { value, min, max, ..Self::named(Status::OUT_OF_RANGE, parameter) }
            }
            ConfigError::NotRising { parameter, index, value, previous } => Self {
                value,
                min: previous,
                index: index as u32,
                ..Self::named(Status::NOT_RISING, parameter)
            },
            ConfigError::AllZero { parameter } => Self::named(Status::ALL_ZERO, parameter),
            ConfigError::EmptyCell { cell, .. } => {
                Self { index: cell as u32, ..Self::of(Status::EMPTY_CELL) }
            }
            ConfigError::FieldTooWide { field, .. } => {
                Self { index: field as u32, ..Self::of(Status::FIELD_TOO_WIDE) }
            }
            ConfigError::TooFewSamples { seen, needed } => {
                Self { value: seen as f32, min: needed as f32, ..Self::of(Status::TOO_FEW_SAMPLES) }
            }
            _ => Self::of(Status::BAD_PARAMETER),
        }
    }
}

/// The version of the library, ended by 0: that of its header, unless the two were mixed up.
#[unsafe(no_mangle)]
extern "C" fn sw_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// A line that says what a status means, ended by 0.
#[unsafe(no_mangle)]
extern "C" fn sw_status_text(status: Status) -> *const c_char {
    status.text().as_ptr()
}
