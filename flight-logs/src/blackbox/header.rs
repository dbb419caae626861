//! The header of a Betaflight blackbox log: lines `H name:value`, which define the fields of each kind of frame.

use super::encoding::Encoding;

/// Values of the header that are needed to decode frames.
#[derive(Clone, Debug)]
pub(crate) struct Header {
    pub version: i64,
    /// Number of loop iterations from one full frame (I-frame) to the next.
    pub full_every: i64,
    /// Share of loop iterations that is logged, as numerator and denominator.
    pub logged: (i64, i64),
    pub min_throttle: i32,
    pub min_motor: i32,
    pub battery: i32,
    pub counts: Counts,
    /// Fields of full frames.
    pub full: Fields,
    /// Fields of difference frames (P-frames), whose values are differences from earlier frames. Names and signs are
    /// those of `full`.
    pub changes: Fields,
    pub slow: Fields,
    pub gps: Fields,
    pub home: Fields,
}

/// Number of counts of the sensors in one unit, if the header gives it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counts {
    /// Counts of a gyroscope in 1 °/s.
    per_degree: Option<f64>,
    /// Counts of an accelerometer in 1 g.
    per_g: Option<f64>,
}

impl Counts {
    fn parse<'a>(get: &impl Fn(&str) -> Option<&'a str>) -> Self {
        // Ten times finer numbers, of both sensors.
        let is_fine = get("blackbox_high_resolution").is_some_and(|value| value != "0");
        let finer = if is_fine { 10.0 } else { 1.0 };
        // The bits of a number of 32 bits: the size of a count in °/s. Baseflight alone writes it in radians a µs.
        let degrees = get("gyro_scale").or_else(|| get("gyro.scale")).and_then(|value| {
            let bits = u32::from_str_radix(value.trim_start_matches("0x"), 16).ok()?;
            let degrees = f64::from(f32::from_bits(bits));
            (1e-4..1e4).contains(&degrees).then_some(degrees)
        });
        let per_g =
            get("acc_1G").and_then(|value| value.parse::<u32>().ok()).filter(|own| *own > 0);
        Self {
            per_degree: degrees.map(|degrees| finer / degrees),
            per_g: per_g.map(|counts| finer * f64::from(counts)),
        }
    }

    /// Returns the unit of a field of the main loop's frames; `None` if it is no sensor's or the header has no size of a
    /// count.
    pub(crate) fn unit(self, field: &str) -> Option<String> {
        let (base, counts) = match field.split('[').next()? {
            "gyroADC" | "gyroUnfilt" => ("deg/s", self.per_degree?),
            "accSmooth" => ("g", self.per_g?),
            _ => return None,
        };
        // The scale has 24 bits: more digits than these are its rounding.
        let counts = (counts * 1e4).round() / 1e4;
        Some(if (counts - 1.0).abs() < f64::EPSILON {
            base.to_owned()
        } else {
            format!("{base}/{counts}")
        })
    }
}

/// The fields of one kind of frame. Each vector holds one property of all fields. The items with the same index
/// describe the same field.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fields {
    pub names: Vec<String>,
    pub signed: Vec<bool>,
    pub predictors: Vec<i64>,
    pub encodings: Vec<Encoding>,
}

/// Predictor of a field whose value is the difference from the time of the last frame of the main loop.
pub(crate) const LAST_TIME: i64 = 10;
/// Largest number of a predictor that is known.
const LAST_PREDICTOR: i64 = 11;

/// Largest value that is used for an interval in the header. Larger values are reduced to this one. The bound applies
/// to the `I interval`, and to the numerator and the denominator of the `P interval`.
const MOST: i64 = 1 << 12;

impl Header {
    /// Parses the header of a log from its lines, given as pairs of name and value.
    ///
    /// # Errors
    /// Returns the reason if a definition is missing or unknown.
    pub(crate) fn parse(lines: &[(String, String)]) -> Result<Self, String> {
        let get = |key: &str| {
            lines.iter().rev().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
        };
        let number = |key: &str| {
            let first = get(key)?.split(',').next()?;
            first.trim().parse::<i64>().ok()
        };
        let fields = |kind: &str| Fields::parse(kind, &get);
        let full = fields("I")?;
        if full.names.is_empty() {
            return Err("no fields are defined".to_owned());
        }
        let mut changes = fields("P")?;
        changes.names.clone_from(&full.names);
        changes.signed.clone_from(&full.signed);
        if changes.encodings.len() != full.names.len() {
            let (changes, full) = (changes.encodings.len(), full.names.len());
            return Err(format!("frames of changes have {changes} fields, full ones {full}"));
        }
        let logged = match get("P interval")
            .map(|interval| interval.split_once('/').unwrap_or(("1", interval)))
        {
            Some((some, of)) => (some.trim().parse().unwrap_or(1), of.trim().parse().unwrap_or(1)),
            None => (1, 1),
        };
        Ok(Self {
            version: number("Data version").unwrap_or(1),
            full_every: number("I interval").unwrap_or(1).clamp(1, MOST),
            logged: (i64::clamp(logged.0, 1, MOST), i64::clamp(logged.1, 1, MOST)),
            min_throttle: number("minthrottle").unwrap_or(1150) as i32,
            min_motor: number("motorOutput").unwrap_or(0) as i32,
            battery: number("vbatref").unwrap_or(4095) as i32,
            counts: Counts::parse(&get),
            full,
            changes,
            slow: fields("S")?,
            gps: fields("G")?,
            home: fields("H")?,
        })
    }

    /// Returns the number of loop iterations that the log leaves out directly after iteration `after`, calculated from
    /// the header's intervals.
    pub(crate) fn skipped(&self, after: i64) -> i64 {
        let (some, of) = self.logged;
        let is_logged =
            |iteration: i64| (iteration.rem_euclid(self.full_every) + some - 1) % of < some;
        let next = (1..=self.full_every.min(of)).find(|step| is_logged(after.wrapping_add(*step)));
        next.map_or(0, |step| step - 1)
    }
}

impl Fields {
    fn parse<'a>(kind: &str, get: &impl Fn(&str) -> Option<&'a str>) -> Result<Self, String> {
        const MOST: usize = 256;
        let list = |what: &str| {
            let text = get(&format!("Field {kind} {what}")).unwrap_or_default();
            text.split(',').map(str::trim).filter(|part| !part.is_empty())
        };
        let number = |text: &str| {
            text.parse::<i64>().map_err(|_| format!("`{text}` of a field is no number"))
        };
        let names: Vec<String> = list("name").map(str::to_owned).collect();
        let field = |index: usize| match get(&format!(
            "Field {} name",
            if kind == "P" { "I" } else { kind }
        )) {
            Some(names) => names.split(',').nth(index).unwrap_or("?").trim(),
            None => "?",
        };
        let predictors: Vec<i64> = list("predictor").map(number).collect::<Result<_, _>>()?;
        let is_known = |predictor: &i64| (0..=LAST_PREDICTOR).contains(predictor);
        if let Some(odd) = predictors.iter().position(|predictor| !is_known(predictor)) {
            let (predictor, name) = (predictors[odd], field(odd));
            return Err(format!(
                "predictor {predictor} of field `{name}` in frames {kind} is not known"
            ));
        }
        let encodings = list("encoding").enumerate().map(|(index, text)| {
            let unknown = || {
                format!("encoding {text} of field `{}` in frames {kind} is not known", field(index))
            };
            Encoding::of(number(text)?).ok_or_else(unknown)
        });
        let encodings: Vec<Encoding> = encodings.collect::<Result<_, _>>()?;
        let signed: Vec<bool> = list("signed").map(|text| text == "1").collect();
        let counts = [names.len(), signed.len(), predictors.len(), encodings.len()];
        let count = encodings.len();
        let is_same = |other: usize| other == count || (kind == "P" && other == 0);
        if predictors.len() != count
            || !is_same(names.len())
            || !is_same(signed.len())
            || count > MOST
        {
            let [names, signed, predictors, encodings] = counts;
            return Err(format!(
                "fields {kind} differ in number from line to line: {names} names, {signed} signs, {predictors} \
                 predictors, {encodings} encodings"
            ));
        }
        Ok(Self { names, signed, predictors, encodings })
    }

    /// Returns the index of the field `name`.
    pub(crate) fn index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|field| field == name)
    }

    /// Returns whether a field holds the difference from the time of the last frame of the main loop.
    pub(crate) fn is_relative(&self, index: usize) -> bool {
        self.predictors.get(index) == Some(&LAST_TIME)
    }

    /// Returns the text of a message definition in which each field is an `int64`. Fields `name[0]`, `name[1]` and so
    /// on form an array.
    pub(crate) fn definition(&self) -> String {
        let mut text = String::new();
        let mut names = self.names.as_slice();
        while let Some(first) = names.first() {
            let (base, count) = match first.strip_suffix("[0]") {
                Some(base) => {
                    let numbered = (0..).zip(names);
                    let count = numbered
                        .take_while(|(n, name): &(usize, _)| **name == format!("{base}[{n}]"));
                    (base.to_owned(), count.count())
                }
                None => (first.replace(['[', ']'], "_"), 1),
            };
            let kind =
                if first.ends_with("[0]") { format!("int64[{count}]") } else { "int64".to_owned() };
            text.extend([&kind, " ", &base, "\n"]);
            names = &names[count..];
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::{Counts, Fields, Header};

    #[test]
    fn units_are_those_of_the_head() {
        let unit = |lines: &[(&str, &str)], field: &str| {
            let get =
                |key: &str| lines.iter().find(|(own, _)| *own == key).map(|(_, value)| *value);
            Counts::parse(&get).unit(field).unwrap_or_default()
        };
        let betaflight = [("gyro_scale", "0x3f800000"), ("acc_1G", "2048")];
        assert_eq!(unit(&betaflight, "gyroADC[0]"), "deg/s");
        assert_eq!(unit(&betaflight, "accSmooth[2]"), "g/2048");
        assert_eq!(unit(&betaflight, "motor[0]"), "");
        assert_eq!(unit(&[], "gyroADC[0]"), "");
        let fine =
            [("gyro_scale", "0x3f800000"), ("acc_1G", "2048"), ("blackbox_high_resolution", "1")];
        assert_eq!(unit(&fine, "gyroUnfilt[1]"), "deg/s/10");
        assert_eq!(unit(&fine, "accSmooth[0]"), "g/20480");
        // 16.4 counts in 1 °/s, as older firmware has them.
        let counts = [("gyro_scale", "3d79c190"), ("acc_1G", "0")];
        assert_eq!(unit(&counts, "gyroADC[0]"), "deg/s/16.4");
        assert_eq!(unit(&counts, "accSmooth[0]"), "");
    }

    #[test]
    fn arrays_are_joined() {
        let names = ["time", "gyroADC[0]", "gyroADC[1]", "vbat", "debug[2]"];
        let fields = Fields { names: names.map(str::to_owned).to_vec(), ..Fields::default() };
        assert_eq!(
            fields.definition(),
            "int64 time\nint64[2] gyroADC\nint64 vbat\nint64 debug_2_\n"
        );
    }

    #[test]
    fn iterations_that_are_not_logged_are_known() {
        let line = |key: &str, value: &str| (key.to_owned(), value.to_owned());
        let mut lines = vec![
            line("Field I name", "loopIteration"),
            line("Field I signed", "0"),
            line("Field I predictor", "0"),
            line("Field I encoding", "1"),
            line("Field P predictor", "6"),
            line("Field P encoding", "9"),
            line("I interval", "32"),
            line("P interval", "1/2"),
        ];
        let header = Header::parse(&lines).unwrap();
        assert_eq!((header.skipped(0), header.skipped(30)), (1, 1));
        lines.push(line("P interval", "1"));
        assert_eq!(Header::parse(&lines).unwrap().skipped(0), 0);
        lines.push(line("Field I encoding", "5"));
        assert_eq!(
            Header::parse(&lines).unwrap_err(),
            "encoding 5 of field `loopIteration` in frames I is not known"
        );
    }
}
