//! Scenes and pictures.

use super::session::{Session, project};
use crate::common::{CORNER, glb, moving_glb, names};

#[test]
pub fn scenes_are_loaded_by_path_and_by_name() {
    let mut session = Session::new("");
    let scenes = session.folder.path().join("scenes");
    std::fs::create_dir(&scenes).unwrap();
    std::fs::write(scenes.join("corner.glb"), glb(&CORNER)).unwrap();
    session.says("load", &["no scene is open"]);
    session.does("load corner");
    session.says("load", &["load", "corner.glb"]);
    session.says("scenes", &["builtin:cornell", "corner"]);
    session.says("stats", &["corner: 4 triangles", "1 object"]);
    let plain = session.picture();
    let lit = session.changes("load scenes/corner.glb --sun 0.3,1,0.4,50000 --rotate 0,20,0");
    session.says("load", &["--sun", "50000", "--rotate 0,20,0"]);
    session.does("load builtin:cornell");
    session.changes("hide all; show 'left wall'");
    session.changes("reload");
    session.equals("load corner", plain);
    session.does("close");
    session.says("load", &["no scene is open"]);
    session.differs(lit, plain);
    session.finish();
}

#[test]
pub fn pictures_are_written_and_compared() {
    let mut session = Session::new("--scene builtin:cornell");
    session.says("screenshot a.png", &["a.png: 48x36, 1 frame"]);
    session.says("screenshot a.exr", &["a.exr"]);
    session.does("size 24x18");
    session.says("screenshot small.png", &["24x18"]);
    session.says("reference truth.exr 2", &["truth.exr: 24x18, 2 samples a pixel"]);
    session.says("reference truth.png 1", &["truth.png"]);
    session.says("compare 4", &["bias", "RMSE", "FLIP", "final"]);
    session.says("size", &["24x18"]);
    session.says("script now.txt", &["now.txt: ", " commands"]);
    let keep = tempfile::tempdir().unwrap();
    session.does(&format!("screenshot '{}'", keep.path().join("elsewhere.png").display()));
    session.finish();
    assert_eq!(names(keep.path()), ["elsewhere.png"]);
    assert_eq!(image::open(keep.path().join("elsewhere.png")).unwrap().width(), 24);
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn animations_play() {
    let mut session = Session::new("--scene moving.glb");
    std::fs::write(session.folder.path().join("moving.glb"), moving_glb()).unwrap();
    session.says("animation", &["0 \"slide\", 2 s, on", "1 \"rise\", 1 s, off"]);
    session.says("time", &["time 0 of 2 s, paused"]);
    let start = session.picture();
    // The grid contains the whole motion.
    session.says("grid_bounds", &["-1,0,-1 1.2,2,1"]);
    let middle = session.changes("time 1");
    session.changes("animation rise; time 0.5");
    session.equals("animation 0; time 1", middle);
    // The animation's end does not wrap to its start.
    session.does("time 2");
    session.says("time", &["time 2 of 2 s"]);
    session.equals("time 0", start);
    // Edits of an object move along with the animation.
    let moved = session.changes("translate 'node 1' 0 0.3 0");
    session.changes("time 1");
    session.equals("time 0", moved);
    session.equals("translate 'node 1' 0 -0.3 0", start);
    session.does("play; wait 15; pause");
    session.says("time", &["time 0.5", "paused"]);
    session.does("wait 5");
    session.says("time", &["time 0.5", "paused"]);
    session.does("play");
    session.says("time", &["playing"]);
    session.does("pause");
    session.says("time", &["paused"]);
    session.finish();
}

#[test]
pub fn load_finds_names_beside_the_open_scene() {
    let mut session = Session::new("");
    session.does(&format!("load '{}'", project("scenes/cornell.scene").display()));
    session.does("load emit");
    session.says("load", &["emit.scene"]);
    session.finish();
}
