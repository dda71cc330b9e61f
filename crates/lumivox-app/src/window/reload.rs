//! Reloading a scene when its files change.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

use lumivox_scene::may_name;
use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};

/// Changes less than this apart count as one: programs write files in pieces.
const QUIET: Duration = Duration::from_millis(250);
/// Larger scene files are not searched for names of other files.
const MOST_BYTES: u64 = 8 << 20;

/// Watches a scene's files until it is dropped.
#[derive(Debug)]
pub struct Watched {
    _watcher: RecommendedWatcher,
}

/// Calls `changed` when a scene's file or a file that it names changes.
///
/// # Errors
/// When the system cannot watch the files.
pub fn watch(
    scene: &Path,
    allow_outside: bool,
    changed: impl Fn() + Send + 'static,
) -> notify::Result<Watched> {
    let files: BTreeSet<PathBuf> =
        files_of(scene, allow_outside).into_iter().map(|file| canonical(&file)).collect();
    // Watch folders: some programs write a new file and rename it, which a watched file does not
    // report.
    let folders: BTreeSet<&Path> = files.iter().filter_map(|file| file.parent()).collect();
    let (sender, changes) = mpsc::channel();
    let seen = files.clone();
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
        let Ok(event) = event else { return };
        let is_change = !event.kind.is_access();
        if is_change && event.paths.iter().any(|path| seen.contains(&canonical(path))) {
            // The receiver may be gone.
            let _ = sender.send(());
        }
    })?;
    for folder in folders {
        watcher.watch(folder, RecursiveMode::NonRecursive)?;
    }
    std::thread::spawn(move || forward(&changes, &changed));
    Ok(Watched { _watcher: watcher })
}

/// Calls `changed` once for each burst of changes, until the watcher with the sender is dropped.
fn forward(changes: &Receiver<()>, changed: &dyn Fn()) {
    while changes.recv().is_ok() {
        // Wait for a pause, or for the watcher to be dropped.
        while changes.recv_timeout(QUIET).is_ok() {}
        changed();
    }
}

/// Canonicalizes only the folder: the file may be missing during a rename.
fn canonical(file: &Path) -> PathBuf {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    file.file_name().map_or(folder.clone(), |name| folder.join(name))
}

/// A scene's file and the existing files that it names. Every word or quoted text in it counts as a
/// name, whatever the format. Files named by those are included, such as the textures of a material
/// library. Files that the scene may not name are not read.
pub fn files_of(scene: &Path, allow_outside: bool) -> Vec<PathBuf> {
    let mut files = vec![scene.to_owned()];
    let mut next = 0;
    // Listing each file once makes this end if files name each other.
    while next < files.len() && files.len() < 4096 {
        for file in named_in(&files[next]) {
            if !files.contains(&file) && (allow_outside || may_name(scene, &file)) {
                files.push(file);
            }
        }
        next += 1;
    }
    files
}

fn named_in(file: &Path) -> Vec<PathBuf> {
    let is_short = std::fs::metadata(file).is_ok_and(|m| m.is_file() && m.len() <= MOST_BYTES);
    let bytes = if is_short { std::fs::read(file).unwrap_or_default() } else { Vec::new() };
    let Ok(text) = String::from_utf8(bytes) else { return Vec::new() };
    let folder = file.parent().unwrap_or(Path::new(""));
    let quoted = text.split('"').skip(1).step_by(2).map(|name| name.replace("%20", " "));
    let bare = text.split(|c: char| c.is_whitespace() || "={}\",;".contains(c)).map(str::to_owned);
    // VXCT's scenes name models relative to the folder above theirs.
    let roots =
        [folder.to_owned(), folder.join(".."), folder.join("models"), folder.join("../models")];
    let mut found = Vec::new();
    // Names have an extension; numbers, which contain a dot, are skipped.
    let names = quoted.chain(bare).filter(|name| name.len() < 512 && name.contains('.'));
    for name in names.collect::<BTreeSet<String>>() {
        if name.parse::<f64>().is_ok() {
            continue;
        }
        let there = roots.iter().map(|root| root.join(&name)).find(|path| path.is_file());
        found.extend(there.filter(|path| path != file));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_referenced_by_a_scene_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("tex")).unwrap();
        std::fs::write(at("a.obj"), "mtllib a.mtl\nv 0.5 1.5 2\nf 1 1 1\n").unwrap();
        std::fs::write(at("a.mtl"), "newmtl m\nmap_Kd tex/wood.png\nmap_Ks gone.png\n").unwrap();
        std::fs::write(at("tex/wood.png"), [0xff, 0xd8]).unwrap();
        std::fs::write(at("b.gltf"), r#"{"images":[{"uri":"tex/wood.png"},{"uri":"c%20d.png"}]}"#)
            .unwrap();
        std::fs::write(at("c d.png"), "").unwrap();
        let files_of = |name: &str| files_of(&at(name), false);
        assert_eq!(files_of("a.obj"), [at("a.obj"), at("a.mtl"), at("tex/wood.png")]);
        assert_eq!(files_of("b.gltf"), [at("b.gltf"), at("c d.png"), at("tex/wood.png")]);
        assert_eq!(files_of("gone.glb"), [at("gone.glb")]);
    }

    /// A scene cannot make the window read arbitrary files.
    #[test]
    fn files_outside_the_folder_are_watched_only_if_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["inner", "scenes", "models"] {
            std::fs::create_dir(at(name)).unwrap();
        }
        let outside = at("outside.mtl");
        std::fs::write(&outside, "newmtl m\n").unwrap();
        let text = format!("mtllib ../outside.mtl\nmtllib {}\n", outside.display());
        std::fs::write(at("inner/a.obj"), text).unwrap();
        assert_eq!(files_of(&at("inner/a.obj"), false), [at("inner/a.obj")]);
        assert!(files_of(&at("inner/a.obj"), true).len() > 1);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../outside.mtl", at("inner/link.mtl")).unwrap();
            std::fs::write(at("inner/b.obj"), "mtllib link.mtl\n").unwrap();
            assert_eq!(files_of(&at("inner/b.obj"), false), [at("inner/b.obj")]);
        }
        // VXCT keeps models beside its scenes' folder.
        std::fs::write(at("models/tri.obj"), "v 0 0 0\n").unwrap();
        std::fs::write(at("scenes/a.scene"), "scene { model { path = models/tri.obj } }").unwrap();
        assert_eq!(files_of(&at("scenes/a.scene"), false).len(), 2);
    }

    /// Queues all changes before the thread starts, so that timing does not matter.
    #[test]
    fn a_burst_of_changes_is_reported_once() {
        let (sender, changes) = mpsc::channel();
        for _ in 0..3 {
            sender.send(()).unwrap();
        }
        let (forwarded, bursts) = mpsc::channel();
        let forwarding =
            std::thread::spawn(move || forward(&changes, &|| forwarded.send(()).unwrap()));
        assert!(bursts.recv().is_ok());
        drop(sender);
        assert!(bursts.recv().is_err(), "once");
        forwarding.join().unwrap();
    }

    #[test]
    fn a_change_of_the_file_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.obj");
        let other = folder.path().join("a.obj.tmp");
        let write: fn(&Path, &Path) = |file, _| std::fs::write(file, "v 1").unwrap();
        let replace: fn(&Path, &Path) = |file, other| {
            // Editors replace files like this.
            std::fs::write(other, "v 2 2 2").unwrap();
            std::fs::rename(other, file).unwrap();
        };
        for change in [write, replace] {
            std::fs::write(&file, "v 0 0 0").unwrap();
            let (sender, changes) = mpsc::channel();
            // Use a new watcher each time: it has no earlier events.
            let watched = watch(&file, false, move || {
                let _ = sender.send(());
            })
            .unwrap();
            change(&file, &other);
            changes.recv_timeout(Duration::from_mins(2)).unwrap();
            drop(watched);
        }
    }
}
