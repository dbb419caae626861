//! Arguments as `ros2 run` and `ros2 launch` give them: `--ros-args -p name:=value --params-file FILE -r from:=to`.

use crate::settings::Parameters;
use anyhow::{Context, Result, bail};
use std::fs;
use yaml_rust2::{Yaml, YamlLoader, yaml::Hash};

/// What a node was started with.
#[derive(Debug, PartialEq)]
pub(crate) struct Arguments {
    pub name: String,
    /// Begins with a slash.
    pub namespace: String,
    /// New names of topics by the old ones, as given.
    pub remaps: Vec<(String, String)>,
    pub parameters: Parameters,
}

impl Arguments {
    /// Reads arguments for a node that has this name unless another is given.
    ///
    /// # Errors
    /// An argument, or a file of parameters, cannot be understood.
    pub(crate) fn read(name: &str, mut given: impl Iterator<Item = String>) -> Result<Self> {
        let mut own = Self {
            name: name.to_owned(),
            namespace: "/".to_owned(),
            remaps: Vec::new(),
            parameters: Parameters::new(),
        };
        let (mut files, mut single) = (Vec::new(), Parameters::new());
        while let Some(argument) = given.next() {
            let mut next =
                || given.next().with_context(|| format!("{argument}: a value is missing"));
            match argument.as_str() {
                "--ros-args" | "--" => {}
                "--params-file" => files.push(next()?),
                "-p" | "--param" => {
                    let (name, value) = assigned(&next()?)?;
                    let read = YamlLoader::load_from_str(&value).with_context(|| name.clone())?;
                    single.insert(name, read.into_iter().next().unwrap_or(Yaml::Null));
                }
                "-r" | "--remap" => {
                    let (from, to) = assigned(&next()?)?;
                    match from.rsplit(':').next().unwrap_or(&from) {
                        "__node" | "__name" => own.name = to,
                        "__ns" => own.namespace = to,
                        from => own.remaps.push((from.to_owned(), to)),
                    }
                }
                "--log-level" | "--log-config-file" | "-e" | "--enclave" => drop(next()?),
                flag if flag.starts_with("--") && flag.contains("-log") => {}
                other => bail!("{other}: it is none of --ros-args, -p, --params-file, -r"),
            }
        }
        for file in files {
            let text = fs::read_to_string(&file).with_context(|| file.clone())?;
            own.add(&text).with_context(|| file)?;
        }
        own.parameters.extend(single);
        Ok(own)
    }

    /// Adds what a file of parameters has for this node.
    fn add(&mut self, text: &str) -> Result<()> {
        for document in YamlLoader::load_from_str(text)? {
            let tree = document.as_hash().context("it is no file of parameters")?;
            self.walk(tree, "")?;
        }
        Ok(())
    }

    /// Goes down through namespaces and names of nodes to `ros__parameters`.
    fn walk(&mut self, tree: &Hash, path: &str) -> Result<()> {
        for (key, value) in tree {
            let key = key.as_str().context("a name that is no text")?;
            let below =
                value.as_hash().with_context(|| format!("{path}/{key}: nothing is below"))?;
            if key != "ros__parameters" {
                self.walk(below, &format!("{path}/{}", key.trim_matches('/')))?;
            } else if self.is_meant(path) {
                flatten(below, "", &mut self.parameters)?;
            }
        }
        Ok(())
    }

    /// Whether a pattern, in which `*` is one name and `**` any number of them, is this node's.
    fn is_meant(&self, pattern: &str) -> bool {
        let own = format!("{}/{}", self.namespace, self.name);
        fits(&parts(pattern), &parts(&own))
    }

    /// Returns the full name of a topic of this node, such as `event` or `~/decoded`.
    pub(crate) fn topic(&self, name: &str) -> String {
        let full = self.full(name);
        let new = self.remaps.iter().find(|(from, _)| self.full(from) == full);
        new.map_or(full, |(_, to)| self.full(to))
    }

    fn full(&self, name: &str) -> String {
        let base = self.namespace.trim_end_matches('/');
        match name.strip_prefix('~') {
            _ if name.starts_with('/') => name.to_owned(),
            Some(own) => format!("{base}/{}/{}", self.name, own.trim_start_matches('/')),
            None => format!("{base}/{name}"),
        }
    }
}

/// Splits `name:=value`.
fn assigned(text: &str) -> Result<(String, String)> {
    let (name, value) =
        text.split_once(":=").with_context(|| format!("{text}: it is not name:=value"))?;
    Ok((name.to_owned(), value.to_owned()))
}

fn flatten(tree: &Hash, before: &str, into: &mut Parameters) -> Result<()> {
    for (key, value) in tree {
        let name = format!("{before}{}", key.as_str().context("a parameter's name is no text")?);
        match value.as_hash() {
            Some(below) => flatten(below, &format!("{name}."), into)?,
            None => drop(into.insert(name, value.clone())),
        }
    }
    Ok(())
}

fn parts(path: &str) -> Vec<&str> {
    path.split('/').filter(|part| !part.is_empty()).collect()
}

fn fits(pattern: &[&str], path: &[&str]) -> bool {
    match (pattern.split_first(), path.split_first()) {
        (None, None) => true,
        (Some((&"**", rest)), _) => {
            fits(rest, path) || path.split_first().is_some_and(|(_, path)| fits(pattern, path))
        }
        (Some((first, rest)), Some((name, path))) => {
            (*first == "*" || first == name) && fits(rest, path)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::Arguments;
    use crate::settings::Parameters;
    use yaml_rust2::Yaml;

    fn read(line: &str) -> anyhow::Result<Arguments> {
        Arguments::read("encode", line.split(' ').map(str::to_owned))
    }

    #[test]
    fn names_remaps_and_parameters() {
        let own =
            read("--ros-args -r __ns:=/left -r event:=/spikes -p threshold:=0.5 --log-level debug")
                .unwrap();
        assert_eq!(own.topic("event"), "/spikes");
        assert_eq!(own.topic("~/decoded"), "/left/encode/decoded");
        assert_eq!(own.topic("imu"), "/left/imu");
        assert_eq!(own.parameters["threshold"], Yaml::Real("0.5".to_owned()));
        for bad in ["-p", "-p threshold", "--params", "-p a:=["] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_file_of_parameters_is_read_for_the_nodes_that_it_names() {
        for (pattern, is_meant) in [
            ("/**", true),
            ("encode", false),
            ("/left/encode", true),
            ("/*/encode", true),
            ("/**/encode", true),
            ("/left", false),
        ] {
            let mut own = read("-r __ns:=/left").unwrap();
            own.add(&format!(
                "{pattern}:\n  ros__parameters:\n    threshold: 2\n    a: {{b: 1}}\n"
            ))
            .unwrap();
            let names = ["threshold", "a.b"].map(|name| own.parameters.contains_key(name));
            assert_eq!(names, [is_meant; 2], "{pattern}");
        }
        let mut own = read("-r __ns:=/left").unwrap();
        own.add("left:\n  encode:\n    ros__parameters: {a: 1}\n  decode:\n    ros__parameters: {b: 1}\n").unwrap();
        assert_eq!(own.parameters, Parameters::from([("a".to_owned(), Yaml::Integer(1))]));
    }
}
