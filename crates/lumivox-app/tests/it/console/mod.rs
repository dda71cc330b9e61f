//! The console through `lumivox run`: each command's effect on the picture, or its output.

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

use std::collections::HashSet;

use crate::common::{folder, lumivox};
use session::rehearse;

/// The tests that give commands to the console.
const SESSIONS: [fn(); 25] = [
    files::scenes_are_loaded_by_path_and_by_name,
    files::pictures_are_written_and_compared,
    files::animations_play,
    files::names_are_looked_for_beside_the_open_scene,
    frames::frames_come_on_demand_and_are_timed,
    frames::voxels_follow_or_wait,
    light::lights_come_change_and_go,
    light::surroundings_are_light_and_panoramas,
    light::a_sky_takes_the_place_of_the_command_lines,
    objects::objects_move_and_hide,
    objects::materials_change,
    objects::materials_have_the_names_of_vxct,
    objects::the_camera_goes_about,
    objects::cameras_are_stored_under_names,
    objects::changes_are_taken_back_and_done_again,
    program::help_echo_and_lists,
    program::settings_are_printed_set_and_reset,
    program::scripts_run_scripts,
    program::the_end_is_the_end,
    view::surfaces_voxels_and_wires,
    view::parts_of_light_in_the_physical_look,
    vxct::switches,
    vxct::numbers,
    vxct::a_script_of_its_own,
    vxct::a_script_that_goes_on,
];

/// A command is covered if sessions give it to the console by each of its names.
#[test]
fn every_command_has_a_test() {
    let folder = folder();
    let list = lumivox(folder.path(), "commands").expect_ok().stdout;
    let rehearsed: String = SESSIONS.iter().map(|test| rehearse(*test)).collect();
    let given: HashSet<&str> = rehearsed
        .split(['\n', ';'])
        .filter_map(|command| command.split_whitespace().next())
        .collect();
    let mut missing = Vec::new();
    let mut count = 0;
    for line in list.lines() {
        let (form, _) = line.split_once(": ").unwrap();
        // The tests of the settings' table cover all settings.
        if form.contains("[VALUE]") {
            continue;
        }
        let name = form.split_whitespace().next().unwrap();
        // `NAME USAGE (ALIAS or ALIAS)`
        let aliases = form.rsplit_once(" (").and_then(|(_, aliases)| aliases.strip_suffix(')'));
        let aliases = aliases.unwrap_or_default().replace(" or ", ", ");
        for name in [name].into_iter().chain(aliases.split(", ").filter(|alias| !alias.is_empty()))
        {
            count += 1;
            if !given.contains(name) {
                missing.push(name.to_owned());
            }
        }
    }
    assert!(count > 100, "{count} names in\n{list}");
    assert!(missing.is_empty(), "no session has a line with: {missing:?}");
}
