//! VXCT's parameters and switches, in its look.

use super::session::{Session, project};

fn session() -> Session {
    let mut session = Session::new("--preset vxct");
    session.does(&format!("load '{}'", project("scenes/cornell.scene").display()));
    session
}

#[test]
pub fn vxct_switches_toggle_and_restore_the_picture() {
    let mut session = session();
    let start = session.picture();
    for (line, back) in [
        ("phong off", "phong on"),
        ("phong_ambient off", "phong_ambient on"),
        ("phong_diffuse", "phong_diffuse"),
        ("phong_specular", "phong_specular"),
        ("front_cone", "front_cone"),
        ("side_cones", "side_cones"),
        ("intermediate_cones", "intermediate_cones"),
        ("vox_diffuse", "vdiff"),
        ("vox_specular", "vspec"),
        ("vox_shadows", "vshad"),
        ("phong_only", "all"),
        ("shadows_only", "all"),
        ("specular_only", "all"),
        ("diffuse_only", "all"),
        ("iLight off", "iLight on"),
        ("vdiff; vspec; phong", "all"),
    ] {
        session.changes(line);
        session.equals(back, start);
    }
    session.says("side_cones", &["side_cones on"]);
    // Each part of light has an independent switch: show only one, then add others.
    session.does("all; side_cones off; phong off; vspec off");
    let both = session.changes("echo");
    session.equals("shadows_only; vdiff", both);
    session.does("all; vdiff; vspec; vshad");
    let alone = session.picture();
    session.equals("phong_only", alone);
    session.finish();
}

/// A script of the commands in VXCT's documentation, in their order, each followed by its inverse.
#[test]
#[ignore = "slow: over three seconds"]
pub fn vxct_commands_and_their_inverses_restore_the_picture() {
    let mut session = session();
    session.picture();
    let there_and_back = [
        ("objs", "objs"),
        ("objsW", "objsW"),
        ("overlayW", "overlayW"),
        ("pos1", "pos2"),
        ("setmat LeftWall diffuse_str 0.4", "setmat LeftWall diffuse_str 1"),
        ("setmat LeftWall ambient_str 1.5", "setmat LeftWall ambient_str 0.08"),
        ("setmat TallBlock specular_str 105", "setmat TallBlock specular_str 0.4"),
        ("translate TallBlock x 0.25", "translate TallBlock x -0.25"),
        ("translate TallBlock y 0.25", "translate TallBlock y -0.25"),
        ("translate TallBlock z 0.25", "translate TallBlock z -0.25"),
        ("scale ShortBlock 2", "scale ShortBlock 0.5"),
        ("toggle TallBlock", "toggle TallBlock"),
        ("voxs", "voxs"),
        ("loclod", "loclod"),
        ("iLight", "iLight"),
        ("phong", "phong"),
        ("phong_ambient", "phong_ambient"),
        ("phong_specular", "phong_specular"),
        ("phong_diffuse", "phong_diffuse"),
        ("front_cone", "front_cone"),
        ("side_cones", "side_cones"),
        ("intermediate_cones", "intermediate_cones"),
        ("phong_only", "all"),
        ("shadows_only", "all"),
        ("specular_only", "all"),
        ("diffuse_only", "all"),
        ("vox_diffuse", "vdiff"),
        ("vox_specular", "vspec"),
        ("vox_shadows", "vshad"),
        ("diffuse_dist_factor 1.5", "ddf 0.1"),
        ("occlusion_dist_factor 1.5", "odf 0.35"),
        ("specular_dist_factor 3", "sdf 0.8"),
        ("diffuse_offset 0.5", "do 0.19"),
        ("diffuse_origin_offset 0.3", "doo 0.05"),
        ("occlusion_offset 0.5", "oo 0.08"),
        ("specular_offset 0.6", "so 0.15"),
        ("diffuse_aperture 1.2", "da 0.55"),
        ("occlusion_aperture 1", "oa 0.4"),
        ("specular_aperture 0.6", "sa 0.04"),
        ("shadow_str 4", "ss 1.5"),
        ("shininess_falloff 0.1", "sf 3"),
    ];
    session.does("pos2");
    let home = session.changes("setmat LeftWall specular_str 1.5");
    for (there, back) in there_and_back {
        session.changes(there);
        session.equals(back, home);
    }
    for (print, value) in [
        ("diffuse_offset", "diffuse_offset 0.19"),
        ("do", "diffuse_offset 0.19"),
        ("so", "specular_offset 0.15"),
        ("oo", "occlusion_offset 0.08"),
    ] {
        session.says(print, &[value]);
    }
    // A rotation by 45 degrees and back changes the last bits of f32.
    session.changes("rotate TallBlock y 45");
    session.does("rotate TallBlock y -45");
    let turned = session.picture();

    // Levels of voxels, and their wires.
    let solid = session.changes("voxs");
    session.changes("lod 6");
    session.equals("lod 0", solid);
    session.changes("voxsW");
    session.equals("voxsW", solid);
    session.equals("voxs", turned);
    session.finish();
}

/// Commands about time: revoxelization, frames and their times, other scenes.
#[test]
pub fn vxct_time_and_frame_commands_work() {
    let mut session = session();
    session.does("pos2");
    session.picture();
    session.does("vox");
    // `vox_freq` sets how often voxels are rebuilt, `dynamic` whether.
    session.does("vox_freq 1");
    session.says("dynamic", &["dynamic on: revoxelize every 1"]);
    session.says("dynamic", &["dynamic off"]);
    session.says("sfMode", &["sfMode on"]);
    session.says("sf", &["frame 1 of 1"]);
    session.says("sfMode", &["sfMode off"]);
    session.says("draw_block", &["draw_block"]);
    session.does("clearf");
    session.says("avgf", &[" ms, mean of "]);
    session.says("lastframes 2", &["\n"]);
    session.says("ray", &["normal"]);
    session.does("ray off");
    // Another scene keeps the camera.
    session.says("camera", &["at 0,0,1.8, looking along 0,0,-1"]);
    session.changes("load gallery");
    session.says("camera", &["at 0,0,1.8, looking along 0,0,-1"]);
    session.does("quit");
    session.finish();
}

#[test]
pub fn vxct_number_settings_change_and_restore_the_picture() {
    let mut session = session();
    // Without specular reflection, shininess falloff and specular cones would have no effect.
    session.does("setmat TallBlock specular_str 1");
    let start = session.picture();
    for (name, alias, other) in [
        ("diffuse_offset", "do", "1"),
        ("specular_offset", "so", "0.6"),
        ("occlusion_offset", "oo", "0.5"),
        ("diffuse_origin_offset", "doo", "0.3"),
        ("diffuse_dist_factor", "ddf", "1.5"),
        ("occlusion_dist_factor", "odf", "1.5"),
        ("specular_dist_factor", "sdf", "3"),
        ("diffuse_aperture", "da", "1.2"),
        ("occlusion_aperture", "oa", "1"),
        ("specular_aperture", "sa", "0.6"),
        ("shadow_str", "ss", "4"),
        ("shininess_falloff", "sf", "0.5"),
    ] {
        session.changes(&format!("{alias} {other}"));
        session.says(name, &[&format!("{name} {other}")]);
        session.equals(&format!("reset {name}"), start);
    }
    session.changes("sa 0.5; oo 0.4");
    session.says("script", &["specular_aperture 0.5", "occlusion_offset 0.4"]);
    session.does("reset specular_aperture; reset occlusion_offset");
    session.equals("echo", start);
    session.finish();
}
