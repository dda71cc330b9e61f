//! Finding the files that a scene or a material library names.
//!
//! Names are often written on another machine: with backslashes, in another case or encoding, or
//! with the full path of a folder that does not exist here. The search tries, in this order: the
//! unchanged path; the path in any case; and the path without its leading folders, down to the bare
//! name, in each of some folders, such as the folder of the file that names it, and the scene's.
//! All of this is then repeated without quotation marks and without a comment after the name, and
//! with URI escapes (`%20`) decoded.

use std::path::{Component, Path, PathBuf};

use super::files::{self, Reach};
use super::source::key;
use super::text::readable;

/// Bytes of a path: the limit of Linux.
const LONGEST_PATH: usize = 4096;
/// The most components of a path that remain when its leading folders are dropped.
const MOST_FOLDERS: usize = 32;

/// Finds the file called `name` in the folders of the files `beside`, in order; the error gives the
/// reason and a remedy.
pub(super) fn find(beside: &[&Path], name: &[u8], reach: Reach<'_>) -> Result<PathBuf, String> {
    if name.len() > LONGEST_PATH {
        return Err(format!("\"{}\" is too long for a path", readable(name)));
    }
    let found = find_spelling(beside, name, reach);
    // Some programs write names as URIs.
    let bare = bare(name);
    let unescaped = std::str::from_utf8(bare).map(files::decode_percent).unwrap_or_default();
    let others = [bare, &unescaped].into_iter().filter(|other| !other.is_empty() && *other != name);
    others.fold(found, |found, other| {
        found.or_else(|why| find_spelling(beside, other, reach).or(Err(why)))
    })
}

/// Removes a comment after a name, and quotation marks around it.
pub(super) fn bare(name: &[u8]) -> &[u8] {
    let is_comment = |pair: &[u8]| pair[0].is_ascii_whitespace() && pair[1] == b'#';
    let end = name.windows(2).position(is_comment).unwrap_or(name.len());
    let name = name[..end].trim_ascii();
    match name {
        [b'"', inner @ .., b'"'] | [b'\'', inner @ .., b'\''] => inner.trim_ascii(),
        _ => name,
    }
}

fn find_spelling(beside: &[&Path], name: &[u8], reach: Reach<'_>) -> Result<PathBuf, String> {
    let text = decode(name);
    let (mut reason, mut unreadable) = (None, None);
    for &base in beside {
        if let Some(found) = admitted(same_bytes(base, name, reach), reach, &mut reason) {
            return Ok(found);
        }
        match files::resolve(base, &text, reach.anywhere) {
            Ok(path) => {
                let exact = reach.is_file(&path).then(|| path.clone());
                let found = exact.or_else(|| ignoring_case(base, &path, reach));
                if let Some(found) = admitted(found, reach, &mut reason) {
                    return Ok(found);
                }
                unreadable = unreadable.or_else(|| reach.obstacle(&path));
            }
            Err(why) => reason = Some(why),
        }
    }
    // Also for paths that lead out of the folder: without their leading folders they stay in it.
    let words: Vec<&str> = text.split(['/', '\\']).filter(|word| !word.is_empty()).collect();
    for first in words.len().saturating_sub(MOST_FOLDERS)..words.len() {
        let rest = words[first..].join("/");
        for &base in beside {
            // Drives and ".." are refused.
            let Ok(path) = files::resolve(base, &rest, false) else { continue };
            let found = ignoring_case(base, &path, reach);
            if let Some(found) = admitted(found, reach, &mut reason) {
                return Ok(found);
            }
        }
    }
    let name = readable(name);
    Err(match (reason, unreadable) {
        (None, Some(obstacle)) => format!("\"{name}\" cannot be read: {obstacle}"),
        (Some(reason), _) => format!(
            "\"{name}\" is not read, for {reason}, and no such file lies beside the scene; copy it \
             there, or allow files outside of the scene's folder (--allow-outside)"
        ),
        (None, None) => format!("\"{name}\" does not exist; put it beside the scene"),
    })
}

/// Returns `found` if it may be read; otherwise sets `refused` to the reason.
fn admitted(
    found: Option<PathBuf>,
    reach: Reach<'_>,
    refused: &mut Option<String>,
) -> Option<PathBuf> {
    let found = found?;
    let reason = reach.admit(&found).err();
    if reason.is_none() {
        return Some(found);
    }
    *refused = reason;
    None
}

/// Decodes UTF-8, or else Latin-1, as older programs wrote it.
fn decode(name: &[u8]) -> String {
    match std::str::from_utf8(name) {
        Ok(text) => text.to_owned(),
        Err(_) => name.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// Finds a file beside `base` by a name that is not UTF-8, byte for byte: both names may have the
/// same other encoding. Only Unix has such names.
fn same_bytes(base: &Path, name: &[u8], reach: Reach<'_>) -> Option<PathBuf> {
    if std::str::from_utf8(name).is_ok() || reach.source.is_some() {
        return None;
    }
    // Some encodings have a backslash in the second byte of a character.
    let last = name.iter().rposition(|byte| b"/\\".contains(byte)).map_or(0, |place| place + 1);
    let (above, tail) = name.split_at(last);
    let above = std::str::from_utf8(above).unwrap_or_default();
    [("", name), (above, tail), ("", tail)].into_iter().find_map(|(above, wanted)| {
        let folder = files::resolve(base, &format!("./{above}"), false).ok()?;
        let listed = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
        let mut entries =
            std::fs::read_dir(listed).ok()?.filter_map(|entry| Some(entry.ok()?.file_name()));
        let found = entries.find(|entry| entry.as_encoded_bytes() == wanted)?;
        Some(folder.join(found)).filter(|path| path.is_file())
    })
}

/// Finds the file at `path`, whose components below the folder of `base` may differ in case.
fn ignoring_case(base: &Path, path: &Path, reach: Reach<'_>) -> Option<PathBuf> {
    let folder = base.parent().unwrap_or(Path::new(""));
    let below = path.strip_prefix(folder).unwrap_or(path);
    if let Some(source) = reach.source {
        return source.find_ignoring_case(&key(&folder.join(below))).map(PathBuf::from);
    }
    let mut at = folder.to_owned();
    for component in below.components() {
        let Component::Normal(wanted) = component else {
            at.push(component);
            continue;
        };
        let exact = at.join(wanted);
        if exact.exists() {
            at = exact;
            continue;
        }
        let wanted = wanted.to_string_lossy().to_lowercase();
        let listed = if at.as_os_str().is_empty() { Path::new(".") } else { at.as_path() };
        let mut names: Vec<_> = std::fs::read_dir(listed)
            .ok()?
            .filter_map(|entry| Some(entry.ok()?.file_name()))
            .filter(|name| name.to_string_lossy().to_lowercase() == wanted)
            .collect();
        // Sorted, so that every run picks the same one of names that differ only in case.
        names.sort_unstable();
        at.push(names.first()?);
    }
    at.is_file().then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reach(folders: &[PathBuf]) -> Reach<'_> {
        Reach { anywhere: false, folders, source: None }
    }

    #[test]
    fn file_names_match_across_case_and_separators() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.obj");
        let textures = folder.path().join("Textures");
        std::fs::create_dir(&textures).unwrap();
        let wood = textures.join("Wood Planks.PNG");
        std::fs::write(&wood, "wood").unwrap();
        let stone = folder.path().join("stone.png");
        std::fs::write(&stone, "stone").unwrap();
        let folders = [folder.path().to_owned()];
        let find = |name: &[u8]| find(&[&scene], name, reach(&folders));
        for name in [
            "Textures/Wood Planks.PNG",
            "textures\\wood planks.png",
            ".\\TEXTURES\\Wood Planks.png",
        ] {
            assert_eq!(find(name.as_bytes()).unwrap().canonicalize().unwrap(), wood, "{name}");
        }
        for name in
            ["C:\\Maps\\Stone.png", "/home/me/stone.png", "../../stone.PNG", "maps/stone.png"]
        {
            assert_eq!(find(name.as_bytes()).unwrap(), stone, "{name}");
        }
        let moved = b"D:\\old project\\textures\\wood planks.png";
        assert_eq!(find(moved).unwrap().canonicalize().unwrap(), wood);
    }

    #[test]
    #[cfg(unix)]
    fn file_names_in_other_encodings_are_found() {
        use std::os::unix::ffi::OsStrExt as _;
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.obj");
        // The second character of the name ends in a backslash (Shift JIS).
        let name = b"\x95\x5c\x83\x5c.mtl";
        let file = folder.path().join(std::ffi::OsStr::from_bytes(name));
        std::fs::write(&file, "").unwrap();
        std::fs::write(folder.path().join("caf\u{e9}.png"), "").unwrap();
        let folders = [folder.path().to_owned()];
        let find = |name: &[u8]| find(&[&scene], name, reach(&folders));
        for name in [&name[..], b"\"\x95\x5c\x83\x5c.mtl\"", b"\x95\x5c\x83\x5c.mtl # sheet"] {
            assert_eq!(find(name).unwrap(), file);
        }
        assert!(find(b"caf\xe9.png").is_ok());
        let maps = folder.path().join("maps");
        std::fs::create_dir(&maps).unwrap();
        std::fs::write(maps.join(std::ffi::OsStr::from_bytes(b"\xff.png")), "").unwrap();
        assert!(find(b"maps\\\xff.png").is_ok());
        assert!(find(b"C:\\x\\\x95\x5c\x83\x5c.mtl").is_err());
        assert!(find(b"\x95\x5d.mtl").is_err());
    }

    #[test]
    fn files_outside_are_refused_with_a_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let below = folder.path().join("below");
        std::fs::create_dir(&below).unwrap();
        let secret = folder.path().join("secret.png");
        std::fs::write(&secret, "secret").unwrap();
        let scene = below.join("scene.obj");
        let folders = [below];
        let refused = find(&[&scene], b"../secret.png", reach(&folders)).unwrap_err();
        assert!(refused.contains("leaves the scene's folder"), "{refused}");
        assert!(refused.contains("allow files outside"), "{refused}");
        let anywhere = Reach { anywhere: true, ..reach(&folders) };
        let allowed = find(&[&scene], b"../secret.png", anywhere).unwrap();
        assert_eq!(allowed.canonicalize().unwrap(), secret.canonicalize().unwrap());
        for name in [&b".."[..], b"", b".", b"a/..", b"c:", b"a\0b", b"caf\xe9.png", &[b'/'; 5000]]
        {
            assert!(find(&[&scene], name, reach(&folders)).is_err(), "{name:?}");
        }
    }
}
