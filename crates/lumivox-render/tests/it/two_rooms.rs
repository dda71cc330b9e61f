//! Tests with two rooms, separated by a wall of 5 mm, thinner than a voxel, and a lamp in one room.
//! Light in the other room came through the doorway, or leaked.

use glam::{UVec2, Vec3};
use lumivox_render::{Picture, RenderSettings, Renderer, View};
use lumivox_scene::Scene;

use crate::common::{builtin, camera, gpu, mean_luminance, picture, renderer};

/// The wall's position within voxels determines the leak, most of all at coarse levels.
const GRID_OFFSETS: [Vec3; 3] = [Vec3::ZERO, Vec3::new(0.5, 0.25, 0.75), Vec3::new(0.25, 0.6, 0.1)];

struct Rooms {
    scene: Scene,
    renderer: Renderer,
}

impl Rooms {
    fn new(name: &str, resolution: u32, grid_offset: Vec3, bounces: u32) -> Self {
        let scene = builtin(name);
        let settings = RenderSettings {
            size: UVec2::new(64, 36),
            resolution,
            grid_offset,
            bounces,
            frames: 4,
            ..RenderSettings::default()
        };
        let renderer = renderer(&gpu(), &scene, settings);
        Self { scene, renderer }
    }

    /// Changes the number of bounces and keeps the voxels.
    fn set_bounces(&mut self, bounces: u32) {
        let settings = RenderSettings { bounces, ..self.renderer.settings().clone() };
        pollster::block_on(self.renderer.set_settings(settings, &mut |_| {})).expect("in range");
    }

    fn show(&mut self, room: &str, view: View) -> Picture {
        self.renderer.set_camera(camera(&self.scene, room));
        self.renderer.set_view(view, 0).expect("level 0 exists");
        picture(&mut self.renderer)
    }

    /// The share of a room's pixels that the lamp lights directly.
    fn share_in_the_lamps_light(&mut self, room: &str) -> f64 {
        let direct = self.show(room, View::Direct).hdr;
        let lit = direct.iter().filter(|[r, g, b, _]| r.max(*g).max(*b) > 0.0).count();
        lit as f64 / direct.len() as f64
    }

    /// Mean indirect irradiance in the dark room, as a share of the lit room's. The cameras mirror
    /// each other, so they see the same surfaces, except for the colours of the end walls.
    fn indirect_share(&mut self) -> f64 {
        let mut mean = |room| mean_luminance(&self.show(room, View::Diffuse));
        mean("dark room") / mean("lit room")
    }
}

#[test]
#[ignore = "slow: 128 voxels"]
fn a_wall_thinner_than_a_voxel_keeps_the_dark_room_dark() {
    // llvmpipe, at the three offsets: 0.25, 0.36 and 0.26 % by the gather at the pixels, 0.54, 0.83
    // and 0.56 % with three more gathers in the voxels. The second offset puts both sides of the
    // wall into the middle of one voxel. The bounds have a margin of a quarter.
    for offset in GRID_OFFSETS {
        let mut rooms = Rooms::new("two-rooms-closed", 128, offset, 1);
        for (bounces, most) in [(1, 0.0046), (4, 0.0105)] {
            rooms.set_bounces(bounces);
            let leak = rooms.indirect_share();
            println!("closed, {bounces} gathers, offset {offset}: {:.2} %", 100.0 * leak);
            assert!(leak < most, "{bounces} gathers, offset {offset}: the dark room has {leak}");
        }
    }
}

/// Shadow maps do not depend on the size of voxels: the lamp lights no pixel behind the wall.
#[test]
fn the_lamp_does_not_shine_through_the_wall() {
    let mut rooms = Rooms::new("two-rooms-closed", 16, Vec3::ZERO, 0);
    let [dark, lit] = ["dark room", "lit room"].map(|room| rooms.share_in_the_lamps_light(room));
    assert!(dark <= 0.0, "{dark} of the dark room is in the lamp's light");
    assert!(lit > 0.9, "only {lit} of the lit room is in the lamp's light");
}

#[test]
#[ignore = "slow: 128 voxels"]
fn the_doorway_lets_light_into_the_dark_room() {
    let mut rooms = Rooms::new("two-rooms", 128, Vec3::ZERO, 4);
    let direct = rooms.share_in_the_lamps_light("dark room");
    let indirect = rooms.indirect_share();
    println!("doorway: {:.1} % direct, {:.1} % indirect", 100.0 * direct, 100.0 * indirect);
    // Pixels that show the lit room through the doorway, and pixels of the dark room that the lamp
    // reaches.
    assert!(
        (0.3..0.6).contains(&direct),
        "{direct} of the dark room's picture is in the lamp's light"
    );
    // llvmpipe: 21.8 %, including a leak of 1 %. Below 15 %, a third of the light would be missing;
    // the upper bound is far below the lit room's light.
    assert!((0.15..0.5).contains(&indirect), "the dark room has {indirect} of the lit one's light");
}
