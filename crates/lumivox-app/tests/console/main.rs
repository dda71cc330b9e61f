//! The console through `lumivox run`: each command by its effect on the picture or by what it prints.

#![allow(clippy::unwrap_used, reason = "in a test a panic is the message")]

#[path = "../common/mod.rs"]
mod common;
mod errors;
mod files;
mod frames;
mod light;
mod objects;
mod page;
mod program;
mod round_trip;
mod session;
mod view;
mod vxct;

use common::{folder, lumivox};

/// The tests of this folder.
const SOURCES: [&str; 8] = [
    include_str!("files.rs"),
    include_str!("frames.rs"),
    include_str!("light.rs"),
    include_str!("objects.rs"),
    include_str!("program.rs"),
    include_str!("round_trip.rs"),
    include_str!("view.rs"),
    include_str!("vxct.rs"),
];

/// A command is covered when a line of a test begins with it.
#[test]
fn every_command_has_a_test() {
    let folder = folder();
    let list = lumivox(folder.path(), "commands").expect_ok().stdout;
    let sources = SOURCES.concat();
    let is_covered = |name: &str| {
        ["(\"{}\"", "(\"{} ", ", \"{}\","]
            .iter()
            .any(|form| sources.contains(&form.replace("{}", name)))
    };
    let mut missing = Vec::new();
    let mut count = 0;
    for line in list.lines() {
        let (form, _) = line.split_once(": ").unwrap();
        let name = form.split_whitespace().next().unwrap();
        // `NAME USAGE (ALIAS or ALIAS)`
        let aliases = form.rsplit_once(" (").and_then(|(_, aliases)| aliases.strip_suffix(')'));
        let aliases = aliases.unwrap_or_default().replace(" or ", ", ");
        for name in [name].into_iter().chain(aliases.split(", ").filter(|alias| !alias.is_empty()))
        {
            count += 1;
            if !is_covered(name) {
                missing.push(name.to_owned());
            }
        }
    }
    assert!(count > 100, "{count} names in\n{list}");
    assert!(missing.is_empty(), "no line of a test begins with: {missing:?}");
}
