//! Things that move.

use bevy::prelude::*;

use crate::common::{headless, scene};
use crate::stage::{Stage, alone, difference, quick};

#[test]
fn a_block_that_has_moved_looks_as_if_it_had_been_there_always() {
    let _alone = alone();
    let given = scene::builtin("cornell");
    let mut stage = Stage::cornell();
    let before = stage.settled();
    let block = stage.instance(&given, "tall block");
    for step in 0..20 {
        let mut transform = stage.app.world_mut().get_mut::<Transform>(block).expect("a transform");
        transform.translation.x = -0.33 + 0.03 * step as f32;
        stage.app.update();
    }
    let moved = stage.settled();
    moved.save("target/pictures/moved.png", 2.0);
    let mut there = given.clone();
    let instance = there.instances.iter_mut().find(|instance| instance.name == "tall block");
    let matrix = &mut instance.expect("the block").world_from_local;
    matrix.w_axis.x = -0.33 + 0.03 * 19.0;
    let mut fresh = Stage::of(&there, UVec2::new(48, 36));
    fresh.use_small_shadow_maps();
    fresh.app.world_mut().entity_mut(fresh.camera).insert(quick());
    headless::wait_until_ready(&mut fresh.app);
    let always = fresh.settled();
    let [from_always, from_before] = [&always, &before].map(|other| difference(&moved, other));
    println!("from always {from_always}, from before {from_before}");
    assert!(from_always < 0.04 && from_before > 0.2, "{from_always} {from_before}");
}
