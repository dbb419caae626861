//! Tests that the files in `.github` agree with the repository: the oldest Rust, and every lock file that is to be kept
//! up to date.

use crate::common::paths;
use std::{fs, path::Path};

fn read(path: impl AsRef<Path>) -> String {
    let path = paths::root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Returns the directories with a file whose name is accepted, in the form `/a/b`.
fn with(is_wanted: fn(&str) -> bool) -> Vec<String> {
    let (root, mut found) = (paths::root(), Vec::new());
    let mut waiting = vec![root.clone()];
    while let Some(place) = waiting.pop() {
        for entry in fs::read_dir(&place).unwrap().map(Result::unwrap) {
            let name = entry.file_name().into_string().unwrap();
            if entry.file_type().unwrap().is_dir() {
                let is_made = ["target", "node_modules"].contains(&&*name) || name.starts_with('.');
                if !is_made {
                    waiting.push(entry.path());
                }
            } else if is_wanted(&name) {
                let place = place.strip_prefix(&root).unwrap().to_str().unwrap();
                found.push(format!("/{place}"));
            }
        }
    }
    found.sort();
    found.dedup();
    found
}

/// Returns the directories that `dependabot.yml` lists for an ecosystem.
fn kept(ecosystem: &str) -> Vec<String> {
    let text = read(".github/dependabot.yml");
    let start = format!("package-ecosystem: {ecosystem}\n");
    let (_, entry) = text.split_once(&start).unwrap();
    let entry = entry.split("package-ecosystem").next().unwrap();
    let words = entry.split_whitespace().filter(|word| word.starts_with('/'));
    let mut found: Vec<String> = words.map(String::from).collect();
    found.sort();
    found
}

#[test]
fn every_lock_file_and_every_list_of_packages_is_kept_up_to_date() {
    assert_eq!(kept("cargo"), with(|name| name == "Cargo.lock"));
    // The emulator's packages are locked where they are installed.
    assert_eq!(kept("npm"), with(|name| name == "package-lock.json"));
    let lists = |name: &str| name.ends_with("requirements.txt") || name == "ros2.txt";
    assert_eq!(kept("pip"), with(lists));
}

#[test]
fn the_least_rust_is_that_of_the_manifests() {
    let least = |manifest: &str| {
        let text = read(manifest);
        let line = text.lines().find_map(|line| line.strip_prefix("rust-version = "));
        line.unwrap_or_else(|| panic!("{manifest} names no least Rust"))
            .trim_matches('"')
            .to_owned()
    };
    let named = least("Cargo.toml");
    let family = ["cameras", "chips", "network", "flight-logs", "laptop/cli"];
    for member in family {
        assert_eq!(least(&format!("{member}/Cargo.toml")), named, "{member}");
    }
    let workflow = read(".github/workflows/verify.yml");
    let calls: Vec<&str> = workflow.lines().filter(|line| line.contains("cargo +")).collect();
    assert!(!calls.is_empty(), "no job compiles with the least Rust");
    for call in calls {
        assert!(call.contains(&format!("cargo +{named} ")), "{call}");
    }
    assert!(
        workflow.contains(&format!("toolchain install {named} ")),
        "its compiler is not installed"
    );
}
