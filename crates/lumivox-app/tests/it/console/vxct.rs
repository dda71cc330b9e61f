//! VXCT's own numbers and switches, in its look.

use super::session::{Session, project};

fn session() -> Session {
    let mut session = Session::new("--preset vxct");
    session.does(&format!("load '{}'", project("scenes/cornell.scene").display()));
    session
}

#[test]
pub fn switches() {
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
    ] {
        session.changes(line);
        session.equals(back, start);
    }
    session.says("side_cones", &["side_cones on"]);
    session.finish();
}

#[test]
pub fn numbers() {
    let mut session = session();
    // Highlights have a use for the shininess falloff, and mirrors for cones that are as sharp.
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
