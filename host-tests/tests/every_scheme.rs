//! What a scheme needs that nothing can generate: a test with a reference of its own, and its rows in the docs.

use catalogue::{Channel, Flight, Storable};
use host_tests::flight;
use spikewire::ConfigError;
use std::{any::type_name, collections::BTreeSet, fs, path::Path};

/// The schemes' types, such as `StepForward`.
#[derive(Default)]
struct Types(BTreeSet<String>);

impl Flight for Types {
    type Sample = f32;
    type Error = ConfigError;

    fn visit<P: Storable<Sample = f32>>(
        &mut self,
        _: &'static str,
        _: &'static str,
        _: &P,
        _: P::EncoderState,
    ) -> Result<(), ConfigError> {
        let path = type_name::<P>().split('<').next().unwrap();
        self.0.insert(path.rsplit("::").next().unwrap().to_owned());
        Ok(())
    }
}

#[test]
fn has_a_test_and_rows_in_the_docs() {
    let samples = flight::flown::<f32>(0, 1.0);
    let mut types = Types::default();
    catalogue::fly(&Channel::new(0, flight::calibrated(&samples)), &mut types).unwrap();
    assert!(types.0.contains("StepForward"), "{:?}", types.0);

    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let read = |path: &Path| fs::read_to_string(path).unwrap();
    let sources_of = |room: &str| {
        let files = fs::read_dir(root.join(room)).unwrap().map(|entry| entry.unwrap().path());
        let sources = files.filter(|path| path.extension().is_some_and(|it| it == "rs"));
        sources.map(|path| read(&path)).collect::<Vec<_>>()
    };
    let tests = sources_of("host-tests/tests");
    for name in types.0 {
        assert!(
            tests.iter().any(|test| test.contains(&name)),
            "no test compares `{name}` with a reference: CONTRIBUTING.md, “A scheme”, step 3"
        );
        for page in ["src/lib.rs", "docs/schemes.md", "docs/codes.md"] {
            assert!(
                read(&root.join(page)).contains(&name),
                "{page} has no `{name}`: CONTRIBUTING.md, “A scheme”, step 4"
            );
        }
    }
}
