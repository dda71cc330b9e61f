//! Commands about the program and its settings.

use super::session::{Session, run_script};
use crate::common::{folder, lumivox_with};

#[test]
pub fn help_echo_and_list_commands_print_text() {
    let mut session = Session::new("");
    session.says("help", &["Settings: cones", "translate", "`help NAME`"]);
    session.says("help translate", &["translate NAME X Y Z", "along its own axes", "In VXCT"]);
    session.says("? bounces", &["a whole number from 0 to 64"]);
    session.says("commands cone", &["side_cones", "front_cone"]);
    session.says("echo 'two  lamps'; echo three # four", &["two  lamps\nthree\n"]);
    session.says("parameters cones", &["voxel_per_diameter", "from 0.05 to 1"]);
    session.says("views", &["wire-voxels"]);
    session.says("scenes", &["builtin:atrium"]);
    session.finish();
}

#[test]
pub fn settings_are_printed_set_and_reset() {
    let mut session = Session::new("");
    session.says("bounces", &["bounces 16"]);
    session.does("bounces 3; cones 12");
    session.says("reset", &["bounces 3 (preset: 16)", "cones 12 (preset: 9)"]);
    session.says("reset bounces", &["bounces 16"]);
    session.does("view albedo; reset all");
    session.says("reset", &["all settings are those of the preset balanced"]);
    session.says("size", &["48x36"]);
    session.does("preset high");
    session.says("preset", &["preset high"]);
    session.says("cones", &["cones 12"]);
    session.does("grid_offset 0.5 0 0.25");
    session.says("grid_offset", &["0.5,0,0.25"]);
    session.says("script", &["preset high", "grid_offset 0.5,0,0.25", "size 48x36"]);
    session.finish();
}

#[test]
pub fn scripts_run_scripts() {
    let mut session = Session::new("");
    let inner = "echo inner\nrun deeper.txt; echo after\n";
    std::fs::write(session.folder.path().join("inner.txt"), inner).unwrap();
    std::fs::write(session.folder.path().join("deeper.txt"), "\u{feff}echo deeper").unwrap();
    session.says("run inner.txt; echo end", &["inner\ndeeper\nafter\nend\n"]);
    session.finish();
    let folder = folder();
    std::fs::write(folder.path().join("self.txt"), "run self.txt").unwrap();
    let run = lumivox_with(folder.path(), &["run", "self.txt"], "");
    assert_eq!(run.code, 3, "{}", run.stderr);
    assert!(run.stderr.contains("16 deep"), "{}", run.stderr);
}

#[test]
pub fn quit_ends_the_script_at_once() {
    let folder = folder();
    let ends = [("quit", 0), ("exit", 0), ("q", 0)];
    for (name, code) in ends {
        let Some(run) = run_script(folder.path(), &format!("echo a; {name}; echo b"), "") else {
            continue;
        };
        assert_eq!((run.code, run.stdout.as_str()), (code, "a\n"), "{}", run.stderr);
    }
}
