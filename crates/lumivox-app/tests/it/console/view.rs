//! Views and overlays.

use super::session::Session;

#[test]
#[ignore = "slow: over three seconds"]
pub fn surface_voxel_and_wire_switches_change_the_picture() {
    let mut session = Session::new("--scene builtin:cornell");
    let start = session.picture();
    session.says("objs", &["objs off"]);
    let nothing = session.changes("echo");
    session.equals("objs on", start);
    session.says("objsW", &["objsW on"]);
    let wires = session.changes("echo");
    session.equals("objsw off", start);
    // The switches are independent.
    session.equals("objsW; overlayW; overlayW; objsW", start);
    let over = session.changes("overlayW on");
    session.changes("wireframe through");
    session.equals("overlayw off", start);
    session.says("voxs", &["voxs on"]);
    let cubes = session.changes("echo");
    session.changes("lod 2");
    session.says("lod", &["level 2"]);
    session.equals("lod 0", cubes);
    session.changes("voxsW on");
    session.equals("voxsw off", cubes);
    session.equals("voxs; voxsW; voxs; voxsW", cubes);
    session.equals("voxs off", start);
    session.changes("loclod on");
    let coarse = session.changes("lod 1");
    session.equals("iLight", coarse);
    session.says("iLight", &["iLight on"]);
    session.equals("loclod off; lod 0", start);
    session.changes("iLight off");
    session.says("view", &["view direct"]);
    session.equals("ilight on", start);
    session.changes("show_grid on");
    session.says("ray", &["material \"white\"", "normal", "m away"]);
    session.changes("show_grid off; ray 10 10");
    session.equals("ray off", start);
    session.says("ray 0,1,10 0,0.1,1", &["the ray hits nothing"]);
    // Removing the ray's lines keeps the wires.
    session.changes("overlayW; ray; ray off");
    session.equals("overlayW", start);
    session.says("ray 0,0.5,0 0,-1,0", &["floor, ceiling, back wall"]);
    session.differs(nothing, wires);
    session.differs(wires, over);
    session.differs(over, cubes);
    session.finish();
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn light_component_switches_work_in_the_physical_look() {
    let mut session = Session::new("--scene builtin:spheres --exposure -2");
    let all = session.picture();
    session.changes("phong_only");
    session.says("view", &["view direct"]);
    session.changes("shadows_only");
    session.changes("specular_only");
    session.changes("diffuse_only");
    session.equals("all", all);
    session.says("phong", &["phong off"]);
    session.says("view", &["view indirect"]);
    session.equals("phong on", all);
    session.says("vox_diffuse", &["vox_diffuse off: bounces 0"]);
    session.changes("echo");
    session.equals("vdiff on", all);
    session.changes("vox_specular off");
    session.equals("vspec", all);
    session.changes("vox_shadows on");
    session.says("shadows", &["shadows cone"]);
    session.equals("vshad off", all);
    session.finish();
}
