//! No two rooms of this program name each other, directly or through others; nor do two files of a room.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};
use syn::{ItemUse, UseTree, visit::Visit};

/// What imports what, by path: a room, or a file of a room.
type Imports = BTreeMap<String, BTreeSet<String>>;

/// Paths that begin with `crate`.
#[derive(Default)]
struct Named(Vec<Vec<String>>);

impl Visit<'_> for Named {
    fn visit_item_use(&mut self, item: &ItemUse) {
        self.tree(Vec::new(), &item.tree);
    }

    fn visit_path(&mut self, path: &syn::Path) {
        self.0.push(path.segments.iter().map(|one| one.ident.to_string()).collect());
        syn::visit::visit_path(self, path);
    }
}

impl Named {
    fn tree(&mut self, mut path: Vec<String>, tree: &UseTree) {
        match tree {
            UseTree::Path(one) => {
                path.push(one.ident.to_string());
                self.tree(path, &one.tree);
            }
            UseTree::Group(group) => {
                group.items.iter().for_each(|one| self.tree(path.clone(), one));
            }
            UseTree::Name(one) => self.0.push([path, vec![one.ident.to_string()]].concat()),
            UseTree::Rename(one) => self.0.push([path, vec![one.ident.to_string()]].concat()),
            UseTree::Glob(_) => self.0.push(path),
        }
    }
}

/// Adds what the files below a directory import; `module` is the directory's path from the crate's root.
fn read(directory: &Path, module: &[String], rooms: &mut Imports, files: &mut Imports) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let own: Vec<String> = [module, std::slice::from_ref(&name)].concat();
        if path.is_dir() {
            read(&path, &own, rooms, files);
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            let own = if name == "mod" { module } else { &own };
            let mut named = Named::default();
            named.visit_file(&syn::parse_file(&fs::read_to_string(&path).unwrap()).unwrap());
            for to in named.0.iter().filter(|to| to[0] == "crate" && to.len() > 1) {
                let [from, to] = [&own[0], &to[1]];
                rooms.entry(from.clone()).or_default().insert(to.clone());
            }
            for to in named.0.iter().filter(|to| to[0] == "crate" && to.len() > 2) {
                if let [from, file, ..] = own
                    && *from == to[1]
                {
                    let [from, to] = [file, &to[2]].map(|file| format!("{from}/{file}"));
                    files.entry(from).or_default().insert(to);
                }
            }
        }
    }
}

/// Takes away those that import none that is left, until none is left.
fn ensure_no_circle(mut imports: Imports) {
    for (from, to) in &mut imports {
        to.remove(from);
    }
    while !imports.is_empty() {
        let left: BTreeSet<String> = imports.keys().cloned().collect();
        imports.retain(|_, to| to.iter().any(|to| left.contains(to)));
        assert!(imports.len() < left.len(), "these name each other: {imports:?}");
    }
}

#[test]
fn none_names_another_that_names_it() {
    let (mut rooms, mut files) = (Imports::new(), Imports::new());
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
    read(Path::new(source), &[], &mut rooms, &mut files);
    assert!(rooms["figures"].contains("programs"), "imports are not read: {rooms:?}");
    assert!(files["figures/demo"].contains("figures/picture"), "imports are not read: {files:?}");
    ensure_no_circle(rooms);
    ensure_no_circle(files);
}
