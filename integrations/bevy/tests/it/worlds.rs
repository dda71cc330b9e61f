//! Cascades, suns, masks and environment maps: what is outside of a room.

use bevy::light::EnvironmentMapLight;
use bevy::prelude::*;
use bevy_lumivox::{GiVolume, LumivoxGi};

use crate::common::{headless, scene};
use crate::stage::{Stage, alone, difference, quick};
use crate::truth;

#[test]
fn cascades_light_a_room_as_a_box_does() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    // The finest box of four metres holds the room.
    let inside = Transform::from_xyz(0.0, 1.0, 0.9).looking_at(Vec3::new(0.0, 0.8, -1.0), Vec3::Y);
    stage.app.world_mut().entity_mut(stage.camera).insert(inside);
    let boxed = stage.settled();
    let volume = GiVolume::Cascades { count: 3, resolution: 64, voxel_size: 0.0625 };
    let gi = LumivoxGi { volume, ..quick() };
    stage.app.world_mut().entity_mut(stage.camera).insert(gi);
    headless::wait_until_ready(&mut stage.app);
    let nested = stage.settled();
    nested.save("target/pictures/cascades.png", 2.0);
    boxed.save("target/pictures/cascades-boxed.png", 2.0);
    println!("{} {}", nested.mean_luminance(), boxed.mean_luminance());
    let change = difference(&nested, &boxed);
    println!("cascades: {change}");
    assert!(change < 0.1, "{change}");
}
