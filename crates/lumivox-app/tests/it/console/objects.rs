//! Objects, materials, cameras.

use super::session::{Session, project};

#[test]
#[ignore = "slow: over three seconds"]
pub fn objects_move_and_hide() {
    let mut session = Session::new("--scene builtin:cornell");
    session.says("objects", &["tall block", "white", "shown", "static"]);
    let start = session.picture();
    let moved = session.changes("translate 'tall block' 0.3 0 0.1");
    session.changes("rotate 'tall block' 0 40 0");
    session.changes("scale 'tall block' 0.5 1 1.5");
    session.changes("scale 'tall block' 0.5");
    session.equals("matrix 'tall block' 1 0 0 0 1 0 0 0 1 0.3 0 0.1", moved);
    session.says("matrix 'tall block'", &["1 0 0 0 1 0 0 0 1 0.3 0 0.1"]);
    session.equals("matrix 'tall block' 1 0 0 0 1 0 0 0 1 0 0 0", start);
    session.changes("place 'short block' 0.2 0.5 0.1 0 45 0 1.5");
    session.says("place 'short block'", &["position 0.2,0.5,0.1 m", "scale 1.5"]);
    // All commands use the same order of rotations.
    session.does("place 'short block' 0 0 0 0 0 0 1; rotate 'short block' 20.5 30.5 0");
    session.says("place 'short block'", &["rotation 20.", ",30."]);
    session.does("matrix 'short block' 1 0 0 0 1 0 0 0 1 0 0 0");
    let hidden = session.changes("hide 'left wall'");
    session.equals("show 'left wall'", start);
    session.says("toggle 'left wall'", &["left wall hidden"]);
    session.equals("echo", hidden);
    session.equals("toggle 'left wall'", start);
    session.says("static 'tall block'", &["static tall block on"]);
    session.does("static 'tall block' off");
    session.says("objects 'tall block'", &["dynamic"]);
    session.equals("echo", start);
    session.finish();
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn material_commands_change_the_picture() {
    let mut session = Session::new("--scene builtin:cornell --exposure -4");
    session.says("materials", &["white", "red", "metallic_roughness"]);
    let start = session.picture();
    session.changes("material red albedo 0.1 0.1 0.8");
    session.says("material red", &["base_color 0.1 0.1 0.8 1", "roughness"]);
    session.changes("material white metallic 1 roughness 0.2");
    session.changes("material green emission 20 2 2");
    session.changes("material white shading phong");
    session.says("material white", &["diffuse", "shininess 16"]);
    session.changes("material white diffuse 0.2 0.2 0.2 specular 0.5 0.5 0.5 shininess 4");
    session.equals("reload", start);
    session.finish();
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn setmat_accepts_vxct_property_names() {
    let mut session = Session::new("--preset vxct");
    session.does(&format!("load '{}'", project("scenes/cornell.scene").display()));
    session.picture();
    session.changes("setmat TallBlock color 0.1 0.3 0.9");
    session.changes("setmat TallBlock diffuse_str 0.5");
    session.changes("setmat TallBlock ambient_str 0.9");
    let bright = session.changes("setmat TallBlock ambient_str 0.4");
    // Setting a strength to 0 and back restores the picture; other changes stay.
    session.changes("setmat TallBlock diffuse_str 0");
    session.equals("setmat TallBlock diffuse_str 0.5", bright);
    session.changes("setmat LeftWall specular_str 1");
    session.changes("phong_specular on");
    session.changes("setmat LeftWall shininess 2");
    session.says("objects LeftWall", &["LeftWall"]);
    session.changes("toggle FrontWall");
    session.finish();
}

#[test]
pub fn camera_commands_move_store_and_restore_the_view() {
    let mut session = Session::new("--scene builtin:cornell");
    session.says("cameras", &["0 \"front\"", "\"framing\""]);
    let start = session.picture();
    session.does("store 1");
    session.changes("camera 0.5,1,1.2,0,0.6,-0.5,60");
    session.says("camera", &["camera 0.5,1,1.2"]);
    session.does("store 2");
    let second = session.changes("fov 40; store 2");
    session.says("fov", &["fov 40"]);
    session.equals("pos1", start);
    session.equals("pos2", second);
    session.equals("camera front", start);
    session.changes("move 0.2 0.1 0.3");
    session.changes("orbit 20 10");
    session.changes("turn -10 5");
    session.changes("camera framing");
    session.changes("orbit 20 0 0,0.5,0");
    session.equals("camera 0", start);
    session.changes("camera_axes 0 0.8 1.5 0 0 -1 0 1 0 55");
    // Forward is the camera's direction, here -z.
    session.does("move 0.25 0.5 0.75");
    session.says("camera", &["camera 0.25,1.3,0.75,0.25,1.3,-0.25"]);
    // Orbit the target to the right, to +x. From there, the camera's right is -z.
    session.does("orbit 90 0 0.25,1.3,-0.25");
    session.says("camera", &["camera 1.2"]);
    session.does("turn 90 0; move 0 0 5");
    session.says("camera", &[",-5.2"]);
    // Turning up stops at the vertical; 45 degrees down from there is the original direction.
    session.does("camera_axes 0 0 0 0 0 -1 0 1 0 55; turn 0 170; turn 0 -45; move 0 0 2");
    session.says("camera", &[",-1.4"]);
    session.does("store 'window seat'");
    session.says("script", &["store 1", "store 2", "store 'window seat'"]);
    session.finish();
}

#[test]
pub fn cameras_are_stored_under_names() {
    let mut session = Session::new("--scene builtin:cornell");
    let start = session.picture();
    session.does("store 'window seat'");
    let second = session.changes("camera 0.5,1,1.2,0,0.6,-0.5,60; store corner");
    session.says("cameras", &["\"corner\", stored", "\"window seat\", stored"]);
    session.equals("camera 'window seat'", start);
    session.says("camera", &["(\"window seat\""]);
    session.equals("camera corner", second);
    // Storing a camera again under a name replaces it.
    session.equals("camera 0; store corner; camera framing; camera corner", start);
    session.finish();
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn undo_and_redo_restore_pictures() {
    let mut session = Session::new("--scene builtin:cornell");
    let start = session.picture();
    let moved = session.changes("translate 'tall block' 0.3 0 0.1");
    let hidden = session.changes("hide 'left wall'");
    let red = session.changes("material green albedo 0.1 0.1 0.8");
    let dark = session.changes("bounces 1; add_light point lamp strength 5");
    session.equals("camera framing; camera 0", dark);
    session.says("undo", &["undone: lights"]);
    session.says("undo", &["undone: bounces"]);
    session.equals("echo", red);
    session.says("undo", &["undone: material \"green\""]);
    session.equals("echo", hidden);
    session.says("undo", &["undone: object \"left wall\""]);
    session.equals("echo", moved);
    session.equals("undo", start);
    session.says("redo", &["redone: object \"tall block\""]);
    session.equals("echo", moved);
    session.equals("redo; redo; redo; redo", dark);
    // `undo` reverts only the last of two settings; printing is not a step.
    session.does("frames 3; frames 2; frames; undo");
    session.says("frames", &["frames 3"]);
    session.finish();
}
