//! Frames, and how long they take.

use super::session::Session;

#[test]
#[ignore = "slow: over three seconds"]
pub fn frame_commands_render_and_time_frames() {
    let mut session = Session::new("--scene builtin:cornell");
    session.does("frames 3");
    session.says("lastframes 1", &["no frame has been rendered yet"]);
    session.says("sf", &["frame 1 of 3, ", " ms"]);
    session.does("wait 1");
    session.says("lastframes 8", &["\n"]);
    session.does("wait 1");
    session.says("sf", &["frame 3 of 3: the picture is complete"]);
    let picture = session.picture();
    session.does("clearf");
    session.says("lastframes 2", &["no frame has been rendered yet"]);
    // Measuring renders more frames, but does not change the picture.
    session.says("avgf", &[" ms, mean of "]);
    session.equals("echo", picture);
    session.says("draw_block", &["draw_block off"]);
    session.does("clearf");
    session.says("avgf", &[" ms, mean of "]);
    session.says("draw_block", &["draw_block on"]);
    session.says("frame_budget", &["frame_budget 33"]);
    session.says("frame_budget 16.5; frame_budget", &["frame_budget 16.5"]);
    session.says("sfMode", &["sfMode on"]);
    session.says("sfmode off", &["sfMode off"]);
    session.says("timing on", &["timing on"]);
    session.does("fov 50; wait 1");
    session.says("times", &["stage", "G-buffer", "trace"]);
    session.says("times passes", &["accumulate"]);
    let run = session.finish();
    // Two frames had been rendered.
    let (list, _) = run.stdout.split_once("frame 3 of 3").unwrap();
    let times = list.lines().filter(|line| line.parse::<f64>().is_ok_and(|ms| ms > 0.0));
    assert_eq!(times.count(), 2, "{list}");
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn revoxelize_modes_update_voxels_or_wait() {
    let mut session = Session::new("--scene builtin:cornell --view voxels");
    let start = session.picture();
    session.says("revoxelize", &["when_moved"]);
    let moved = session.changes("translate 'tall block' 0.1 0.1 0");
    session.equals("matrix 'tall block' 1 0 0 0 1 0 0 0 1 0 0 0", start);
    session.does("revoxelize when_asked");
    session.equals("translate 'tall block' 0.1 0.1 0", start);
    session.does("vox");
    session.equals("echo", moved);
    session.does("matrix 'tall block' 1 0 0 0 1 0 0 0 1 0 0 0; vox");
    session.says("dynamic", &["dynamic on: revoxelize every 0.5"]);
    session.says("vox_freq", &["vox_freq 0.5"]);
    session.does("vox_freq 0.1");
    session.says("revoxelize", &["every 0.1"]);
    // 0.1 s is slightly more than three of a script's frames.
    session.equals("translate 'tall block' 0.1 0.1 0; wait 2", start);
    session.does("wait 2");
    session.equals("echo", moved);
    session.does("vox_freq 0");
    session.says("revoxelize", &["every_frame"]);
    session.says("dynamic off", &["dynamic off: revoxelize when_moved"]);
    session.says("vox_freq", &["vox_freq 0\n"]);
    session.says("dynamic on", &["dynamic on: revoxelize every_frame"]);
    session.does("vox_freq 0.25; dynamic off; dynamic on");
    session.says("vox_freq", &["vox_freq 0.25"]);
    session.does("vox_freq 0.0");
    session.says("dynamic off", &["dynamic off"]);
    session.says("stats", &["voxels", "triangles given", "48x36"]);
    session.says("info", &["GPU"]);
    session.says("memory", &["total", "picture"]);
    session.says("grid_bounds", &["grid_bounds "]);
    session.changes("grid_bounds -3,-3,-3 3,3,3");
    session.says("grid_bounds", &["-3,-3,-3 3,3,3"]);
    session.changes("grid_bounds auto");
    // A requested box stays, although the scene is larger.
    let small = session.changes("grid_bounds -0.2,0,-0.2 0.2,0.4,0.2");
    session.equals("exposure 1; exposure auto", small);
    session.says("grid_bounds", &["-0.2,0,-0.2 0.2,0.4,0.2"]);
    session.changes("grid_bounds auto -0.2,0,-0.2 0.2,0.4,0.2");
    session.finish();
}
