//! The files of the repository that anything opens while a step runs.

use std::{collections::BTreeSet, path::Path};

/// Returns what a function returns, and the files among `files` that were opened meanwhile, by this program or another;
/// `None` if the system cannot tell.
#[cfg(target_os = "linux")]
pub fn opened<T>(
    top: &Path,
    files: &BTreeSet<String>,
    function: impl FnOnce() -> T,
) -> (T, Option<BTreeSet<String>>) {
    use std::{
        sync::atomic::{AtomicBool, Ordering},
        thread,
        time::Duration,
    };

    let Ok(watch) = Watch::new(top, files) else { return (function(), None) };
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        let names = scope.spawn(|| {
            let mut names = BTreeSet::new();
            loop {
                // Read before looking, so that the last events are not lost.
                let was_over = is_over.load(Ordering::Acquire);
                let is_complete = watch.read(&mut names);
                if was_over || !is_complete {
                    return is_complete.then_some(names);
                }
                // The system keeps 16 384 events; a step opens far fewer in this time.
                thread::sleep(Duration::from_millis(20));
            }
        });
        let returned = function();
        is_over.store(true, Ordering::Release);
        let names = names.join().ok().flatten();
        (returned, names.map(|names| names.intersection(files).cloned().collect()))
    })
}

/// Calls the function: this system cannot tell which files it opens.
#[cfg(not(target_os = "linux"))]
pub fn opened<T>(
    _top: &Path,
    _files: &BTreeSet<String>,
    function: impl FnOnce() -> T,
) -> (T, Option<BTreeSet<String>>) {
    (function(), None)
}

#[cfg(target_os = "linux")]
struct Watch {
    inotify: nix::sys::inotify::Inotify,
    /// The directory of each watch, with a slash at its end.
    directories: std::collections::HashMap<nix::sys::inotify::WatchDescriptor, String>,
}

#[cfg(target_os = "linux")]
impl Watch {
    /// Watches the directories of all files.
    fn new(top: &Path, files: &BTreeSet<String>) -> nix::Result<Self> {
        use nix::sys::inotify::{AddWatchFlags, InitFlags, Inotify};

        let inotify = Inotify::init(InitFlags::IN_NONBLOCK | InitFlags::IN_CLOEXEC)?;
        let directory =
            |file: &String| file.rsplit_once('/').map_or("", |(place, _)| place).to_owned();
        let mut directories = std::collections::HashMap::new();
        for place in files.iter().map(directory).collect::<BTreeSet<_>>() {
            let watch = inotify.add_watch(&top.join(&place), AddWatchFlags::IN_OPEN)?;
            directories.insert(watch, if place.is_empty() { place } else { place + "/" });
        }
        Ok(Self { inotify, directories })
    }

    /// Adds the names that wait; returns whether none is lost.
    fn read(&self, names: &mut BTreeSet<String>) -> bool {
        use nix::{errno::Errno, sys::inotify::AddWatchFlags};

        loop {
            match self.inotify.read_events() {
                Ok(events) => {
                    for event in events {
                        if event.mask.contains(AddWatchFlags::IN_Q_OVERFLOW) {
                            return false;
                        }
                        let name = event.name.as_ref().and_then(|name| name.to_str());
                        if let (Some(place), Some(name)) = (self.directories.get(&event.wd), name) {
                            names.insert(format!("{place}{name}"));
                        }
                    }
                }
                Err(error) => return error == Errno::EAGAIN,
            }
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_that_another_program_opens_is_seen() {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir(place.path().join("a")).unwrap();
        let files = ["a/one", "a/two", "three"].map(str::to_owned);
        for file in &files {
            fs::write(place.path().join(file), file).unwrap();
        }
        let read = || {
            let mut cat = std::process::Command::new("cat");
            cat.current_dir(place.path()).arg("a/two").output().unwrap().stdout
        };
        let (said, names) = opened(place.path(), &files.into(), read);
        assert_eq!((said, names), (b"a/two".to_vec(), Some(["a/two".to_owned()].into())));
    }
}
