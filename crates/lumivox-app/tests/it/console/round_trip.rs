//! `script`: the commands that it prints lead to the same picture, to the bit.

use std::fs;

use super::session::{Session, project};
use crate::common::{lumivox_with, moving_glb};

/// Runs lines, then in a new run the commands that `script` prints after them; both pictures must
/// be equal.
#[track_caller]
fn repeats(options: &str, lines: &[&str]) {
    let mut session = Session::new(options);
    fs::write(session.folder.path().join("moving.glb"), moving_glb()).unwrap();
    // Render a picture first: the renderer's state must not matter.
    session.picture();
    for line in lines {
        session.does(line);
    }
    let again = tempfile::tempdir().unwrap();
    fs::write(again.path().join("moving.glb"), moving_glb()).unwrap();
    let kept = again.path().to_owned();
    session.does(&format!("screenshot '{}'", kept.join("first.exr").display()));
    session.does(&format!("screenshot '{}'", kept.join("first.png").display()));
    session.does(&format!("script '{}'", kept.join("again.txt").display()));
    session.finish();
    let script = fs::read_to_string(kept.join("again.txt")).unwrap();
    let all = script.clone() + "screenshot second.exr\nscreenshot second.png\n";
    // Omit the first run's options: the script contains everything.
    lumivox_with(&kept, &["run", "-"], &all).expect_ok();
    for (first, second) in [("first.exr", "second.exr"), ("first.png", "second.png")] {
        let read = |name: &str| fs::read(kept.join(name)).unwrap();
        assert!(read(first) == read(second), "{first} differs; the script was\n{script}");
    }
}

#[test]
pub fn script_restores_objects_materials_lights_and_camera() {
    repeats(
        "--scene builtin:cornell",
        &[
            "translate 'tall block' 0.123 0.017 0.1; rotate 'tall block' 0 33.3 7; hide 'left wall'",
            "place 'short block' 0.2 0.31 0.1 0 41 3 1.1; static 'short block' off",
            "material red albedo 0.137 0.71 0.3 roughness 0.37; material green emission 3 1 0.1",
            "add_light spot 'my lamp' direction 0.1 -1 0.2 outer 33.3 inner 11.1 position 0 0.9 0 strength 77",
            "add_light point position 0.3 0.4 0.5 radius 0.05; bounces 3; resolution 40",
            "camera 0.4,0.9,1.3,0.1,0.5,-0.3,57.3; orbit 13 7; turn 3.3 -2.1; frames 2",
        ],
    );
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn script_restores_surroundings() {
    repeats(
        "--scene builtin:spheres",
        &[
            "environment 100,200,300; sky 23.7,111 3",
            "environment_intensity 0.9; environment_rotation 37.7",
        ],
    );
    repeats(
        "--scene builtin:spheres --sun 0.31,0.9,0.2,54321",
        &["light 'sun of the command line' color 1 0.9 0.7; volume octree; exposure -11"],
    );
}

#[test]
pub fn script_restores_animations_and_overlays() {
    repeats(
        "--scene moving.glb",
        &[
            "animation 0; time 0.77; wireframe over; show_grid on; ray 20 20",
            "translate 'node 1' 0 0.2 0",
        ],
    );
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn script_restores_views_that_need_an_octree() {
    repeats(
        "--scene builtin:cornell",
        &[
            "volume octree; view nodes; level 1; grid_bounds -0.3,-0.1,-0.3 0.3,0.9,0.4",
            "scale 'tall block' 1.3; scale 'tall block' 0.7; hide all; show 'tall block'; show 'left wall'",
        ],
    );
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn script_restores_skies_that_replaced_others() {
    repeats(
        "--scene builtin:spheres --sky 30,120",
        &["sky 50,200", "light 'sun of the sky' color 1 0.9 0.7"],
    );
    repeats("--scene builtin:spheres --sky 30,120", &["environment 900,700,500"]);
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn script_restores_the_vxct_look() {
    let scene = format!("load '{}'", project("scenes/cornell.scene").display());
    repeats(
        "--scene builtin:cornell",
        &[
            "preset vxct",
            &scene,
            "toggle FrontWall; setmat TallBlock color 0.2 0.4 0.8; da 0.7; side_cones on; store 1; orbit 5 5",
        ],
    );
    repeats(
        "--scene builtin:cornell",
        &["preset vxct", &scene, "grid_bounds -0.9,-1,-1.1 1.2,1,1; tone_map aces; exposure 0.5"],
    );
}
