//! The packages of the repository, as `cargo metadata` lists them, and which of them a command builds.

use crate::common::{command, output, paths::root, shell::Ran};
use anyhow::{Context, Result};
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// All packages by name, and all workspaces.
pub struct Packages {
    by_name: BTreeMap<String, Package>,
    workspaces: Vec<Metadata>,
}

/// What `cargo metadata` says of a workspace.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    workspace_root: PathBuf,
    workspace_default_members: Vec<String>,
}

#[derive(Clone, Deserialize)]
struct Package {
    id: String,
    name: String,
    manifest_path: PathBuf,
    dependencies: Vec<Dependency>,
    targets: Vec<Target>,
}

#[derive(Clone, Deserialize)]
struct Dependency {
    name: String,
    kind: Option<String>,
}

#[derive(Clone, Deserialize)]
struct Target {
    name: String,
    src_path: PathBuf,
}

impl Package {
    fn directory(&self) -> &Path {
        self.manifest_path.parent().unwrap_or(Path::new(""))
    }

    fn has_target(&self, names: &[&str]) -> bool {
        self.targets.iter().any(|target| names.contains(&target.name.as_str()))
    }
}

impl Packages {
    /// Reads all manifests among the files.
    pub fn read(files: &BTreeSet<String>) -> Result<Self> {
        let mut manifests: Vec<&String> =
            files.iter().filter(|file| file.ends_with("Cargo.toml")).collect();
        manifests.sort_by_key(|file| file.matches('/').count());
        let mut all = Self { by_name: BTreeMap::new(), workspaces: Vec::new() };
        for manifest in manifests {
            let path = root().join(manifest);
            if all.by_name.values().any(|package| package.manifest_path == path) {
                continue; // in a workspace that was read
            }
            let mut cargo = command("cargo");
            cargo
                .args(["metadata", "--no-deps", "--format-version", "1", "--manifest-path"])
                .arg(path);
            let metadata: Metadata =
                serde_json::from_str(&output(&mut cargo)?).context(manifest.clone())?;
            for package in &metadata.packages {
                all.by_name.insert(package.name.clone(), package.clone());
            }
            all.workspaces.push(metadata);
        }
        Ok(all)
    }

    /// Returns the packages that a command builds or is about: those that it names after `--package`, those in whose
    /// directory it runs, and those whose directory it is given.
    pub fn built_by(&self, ran: &Ran) -> BTreeSet<String> {
        let mut built: BTreeSet<String> = BTreeSet::new();
        for word in &ran.words {
            let path = ran.directory.join(word);
            let is_given = |package: &&Package| package.directory() == path && path != root();
            built
                .extend(self.by_name.values().filter(is_given).map(|package| package.name.clone()));
        }
        let named: Vec<&str> = ran.behind(&["--package", "-p", "--test-package"]).collect();
        built.extend(
            named
                .iter()
                .filter(|name| self.by_name.contains_key(**name))
                .map(|name| (*name).to_owned()),
        );
        if !ran.is_cargo() || !named.is_empty() {
            return built;
        }
        if let Some(manifest) = &ran.manifest {
            built.extend(self.named_in(manifest));
            return built;
        }
        let manifest = ran.behind(&["--manifest-path"]).next();
        let place = manifest.map_or(ran.directory.clone(), |path| {
            ran.directory.join(path).parent().map(PathBuf::from).unwrap_or_default()
        });
        let Some(workspace) = self.workspaces.iter().find(|one| one.workspace_root == place) else {
            let here = self.by_name.values().filter(|package| package.directory() == place);
            built.extend(here.map(|package| package.name.clone()));
            return built;
        };
        let targets: Vec<&str> = ran.behind(&["--test", "--bin", "--example", "--bench"]).collect();
        let is_whole = ran.words.iter().any(|word| word == "--workspace" || word == "--all");
        // With `--lib` the libraries of all packages are built beside the named targets.
        let is_chosen = !targets.is_empty() && !ran.words.iter().any(|word| word == "--lib");
        for package in &workspace.packages {
            let is_member = is_whole || workspace.workspace_default_members.contains(&package.id);
            if is_member && (!is_chosen || package.has_target(&targets)) {
                built.insert(package.name.clone());
            }
        }
        built
    }

    /// Returns the packages on which a manifest outside the repository depends.
    fn named_in(&self, manifest: &str) -> Vec<String> {
        let table: toml::Table = toml::from_str(manifest).unwrap_or_default();
        let mut named = Vec::new();
        for kind in ["dependencies", "dev-dependencies", "build-dependencies"] {
            for (key, value) in
                table.get(kind).and_then(toml::Value::as_table).into_iter().flatten()
            {
                let renamed = value.get("package").and_then(toml::Value::as_str);
                let name = renamed.unwrap_or(key);
                if self.by_name.contains_key(name) {
                    named.push(name.to_owned());
                }
            }
        }
        named
    }

    /// Returns the local packages on which this one depends directly.
    pub fn dependencies(&self, name: &str) -> Vec<&str> {
        let all = self.by_name.get(name).into_iter().flat_map(|package| &package.dependencies);
        let names = all.map(|dependency| dependency.name.as_str());
        names.filter(|name| self.by_name.contains_key(*name)).collect()
    }

    /// Returns the directories, from the repository's top and with a slash at their ends, of these packages and of all on
    /// which they depend; what others need for their tests alone does not count.
    pub fn directories(&self, names: &BTreeSet<String>) -> BTreeSet<String> {
        let mut found: BTreeSet<&str> = BTreeSet::new();
        let mut waiting: Vec<&str> = names.iter().map(String::as_str).collect();
        while let Some(name) = waiting.pop() {
            if let Some(package) = self.by_name.get(name)
                && found.insert(name)
            {
                let is_of_tests =
                    |dependency: &&Dependency| dependency.kind.as_deref() == Some("dev");
                let needed = package
                    .dependencies
                    .iter()
                    .filter(|one| names.contains(name) || !is_of_tests(one));
                waiting.extend(needed.map(|dependency| dependency.name.as_str()));
            }
        }
        found.iter().filter_map(|name| self.by_name.get(*name)).flat_map(directories_of).collect()
    }
}

/// Returns the directory of a package, or those of its sources if the package lies at the repository's top.
fn directories_of(package: &Package) -> Vec<String> {
    let from_top = |path: &Path| Some(format!("{}/", path.strip_prefix(root()).ok()?.display()));
    if package.directory() != root() {
        return from_top(package.directory()).into_iter().collect();
    }
    let sources = package.targets.iter().filter_map(|target| target.src_path.parent());
    sources.filter_map(from_top).collect()
}
