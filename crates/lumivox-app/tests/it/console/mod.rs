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
    files::load_finds_names_beside_the_open_scene,
    frames::frame_commands_render_and_time_frames,
    frames::revoxelize_modes_update_voxels_or_wait,
    light::lights_can_be_added_changed_and_removed,
    light::environment_and_sky_commands_change_the_light,
    light::a_sky_command_replaces_the_command_line_sky,
    objects::objects_move_and_hide,
    objects::material_commands_change_the_picture,
    objects::setmat_accepts_vxct_property_names,
    objects::camera_commands_move_store_and_restore_the_view,
    objects::cameras_are_stored_under_names,
    objects::undo_and_redo_restore_pictures,
    program::help_echo_and_list_commands_print_text,
    program::settings_are_printed_set_and_reset,
    program::scripts_run_scripts,
    program::quit_ends_the_script_at_once,
    view::surface_voxel_and_wire_switches_change_the_picture,
    view::light_component_switches_work_in_the_physical_look,
    vxct::vxct_switches_toggle_and_restore_the_picture,
    vxct::vxct_number_settings_change_and_restore_the_picture,
    vxct::vxct_commands_and_their_inverses_restore_the_picture,
    vxct::vxct_time_and_frame_commands_work,
];

/// A command is covered if sessions use each of its names.
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
        // The tests of the table of settings cover these commands.
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
