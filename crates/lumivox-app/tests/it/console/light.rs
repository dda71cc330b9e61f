//! Lamps and surroundings.

use super::session::Session;

#[test]
#[ignore = "slow: over three seconds"]
pub fn lights_can_be_added_changed_and_removed() {
    let mut session = Session::new("--scene builtin:cornell --exposure -4");
    let start = session.picture();
    session.says("add_light point bulb position 0 1 0 strength 40", &["added the light \"bulb\""]);
    let lit = session.changes("echo");
    session.says("lights", &["lamp", "20 cd", "bulb", "40 cd"]);
    session.says("light bulb", &["strength 40", "position 0 1 0", "range none"]);
    session.changes("light bulb color 1 0.2 0.1");
    session.changes("light bulb position 0.3 0.5 0.2 radius 0.1");
    session.changes("light bulb strength 5");
    session.equals("light bulb strength 40 color 1 1 1 position 0 1 0 radius 0", lit);
    session.equals("remove_light bulb", start);
    session.does("add_light spot direction 0 -1 0 outer 20 inner 5 position 0 1.5 0");
    session.changes("light spot strength 500");
    session.changes("light spot outer 50");
    session.says("light spot", &["outer 50", "inner 5"]);
    session.does("light spot inner 40; light spot outer 30");
    session.says("light spot", &["outer 30", "inner 30"]);
    session.changes("remove_light all");
    session.says("lights", &["the scene has no lights"]);
    session.changes("add_light sun direction 0 -0.3 -1");
    session.changes("light sun illuminance 20000");
    session.says("light sun", &["strength 20000", "angular_radius"]);
    session.equals("reload", start);
    session.finish();
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn environment_and_sky_commands_change_the_light() {
    let mut session = Session::new("--scene builtin:atrium --exposure -12");
    session.picture();
    session.changes("environment 20000,10000,5000");
    session.says("environment", &["20000,10000,5000"]);
    session.changes("environment_intensity 3000");
    session.says("environment_intensity", &["3000,3000,3000"]);
    let sky = session.changes("sky 30,120");
    session.says("lights", &["sun of the sky"]);
    let turned = session.changes("environment_rotation 90");
    session.says("environment_rotation", &["environment_rotation 90"]);
    session.equals("environment_rotation 0", sky);
    session.changes("sky 10,200 4");
    session.equals("sky 30,120; environment_rotation 90", turned);
    session.finish();
}

#[test]
#[ignore = "slow: over three seconds"]
pub fn a_sky_command_replaces_the_command_line_sky() {
    let mut session = Session::new("--scene builtin:spheres --exposure -14 --sky 30,120");
    session.picture();
    let plain = session.changes("environment 5000,5000,5000; lights");
    session.changes("sky 30,120");
    session.equals("environment 5000,5000,5000", plain);
    session.does("sky 20,20");
    let run = session.finish();
    let table = run.stdout.matches("sun of the sky").count();
    assert_eq!(table, 0, "the first sky's sun is still there:\n{}", run.stdout);
}
