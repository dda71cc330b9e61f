//! Random rooms, to measure light in scenes for which Lumivox was not tuned.
//!
//! A room is 3 to 8 m wide, with walls of 1 to 60 cm, single- or double-sided, along the axes or
//! turned by any rotation, lit by a lamp, a glowing panel, a sky through a window, or a lamp by
//! day; or closed and dark under a bright sky. Sensors are on the floor, at a desk, near a wall, in
//! a corner and under the ceiling, and a camera looks across the room.
//!
//! | file | is |
//! | --- | --- |
//! | `kinds.rs` | the shape of each kind of room |
//! | `build.rs` | the solids of a room, its surfaces, and what is free between them |
//! | `dice.rs` | the random numbers |
//!
//! A seed gives the same room on any machine, since the random numbers come from an integer hash.
//! Systems round sines and cosines differently, but these only place the corners of round and
//! oblique things.

mod build;
mod dice;
mod kinds;
#[cfg(test)]
mod tests;

use glam::{Mat4, Vec3};
use lumivox_scene::builtin::build::point_light;
use lumivox_scene::{Camera, Environment, Picker, Scene, SceneError};

use self::build::Build;
use self::dice::Dice;

/// The radiance of the sky, in cd/m².
pub const SKY_RADIANCE: f32 = 1000.0;

/// The thicknesses of walls, in metres.
const WALLS_M: [f32; 8] = [0.01, 0.03, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6];
/// The fewest sensors of a room.
const FEWEST_SENSORS: usize = 3;
/// Number of random sensors in rooms that are not plain.
const RANDOM_SENSORS: usize = 3;
/// Number of eyes among which a camera is chosen.
const EYES: usize = 24;

/// The kinds of rooms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// A box with up to three blocks in it.
    Plain,
    /// A pent roof or a gable.
    SlopedRoof,
    /// The plan of an L.
    LShape,
    /// Steps along a wall, solid or open.
    Stairs,
    /// Columns from floor to ceiling.
    Columns,
    /// Spheres and tubes.
    Round,
    /// A tent of single sheets.
    Tent,
    /// Cupboards and tables in the corners.
    Corners,
    /// A room in a room, mostly with a doorway.
    RoomInRoom,
    /// A wall across the room, with a door ajar.
    DoorAjar,
    /// A lamp of 2 to 5 cm, up to 1.5 m long.
    ThinLamp,
    /// Bodies of thousands of triangles.
    Mesh,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 12] = [
        Self::Plain,
        Self::SlopedRoof,
        Self::LShape,
        Self::Stairs,
        Self::Columns,
        Self::Round,
        Self::Tent,
        Self::Corners,
        Self::RoomInRoom,
        Self::DoorAjar,
        Self::ThinLamp,
        Self::Mesh,
    ];

    /// The kind's name, and its description.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Plain => ("plain", "a box with up to three blocks, rough walls"),
            Self::SlopedRoof => ("sloped-roof", "a pent roof or a gable"),
            Self::LShape => ("l-shape", "the plan of an L"),
            Self::Stairs => ("stairs", "steps along a wall, solid or open"),
            Self::Columns => ("columns", "columns from floor to ceiling"),
            Self::Round => ("round", "spheres and tubes"),
            Self::Tent => ("tent", "a tent of single sheets"),
            Self::Corners => ("corners", "cupboards and tables in the corners"),
            Self::RoomInRoom => ("room-in-room", "a room in a room"),
            Self::DoorAjar => ("door-ajar", "a wall across the room, with a door ajar"),
            Self::ThinLamp => ("thin-lamp", "a lamp of 2 to 5 cm, up to 1.5 m long"),
            Self::Mesh => ("mesh", "bodies of thousands of triangles"),
        }
    }

    /// The kind's name.
    pub fn name(self) -> &'static str {
        self.words().0
    }

    /// A description of the kind.
    pub fn summary(self) -> &'static str {
        self.words().1
    }
}

/// The light of a room.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RoomLight {
    /// A point light by night, sometimes with a window.
    Lamp,
    /// A surface that glows, in a closed room by night.
    Panel,
    /// A sky through a window.
    Sky,
    /// A point light by day, sometimes with a window.
    Day,
    /// No light: a closed room by day.
    Dark,
}

impl RoomLight {
    /// All lights.
    pub const ALL: [Self; 5] = [Self::Lamp, Self::Panel, Self::Sky, Self::Day, Self::Dark];

    /// The light's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lamp => "lamp",
            Self::Panel => "panel",
            Self::Sky => "sky",
            Self::Day => "day",
            Self::Dark => "dark",
        }
    }
}

/// A room, with places where its light is measured.
#[derive(Clone, Debug)]
pub struct Room {
    /// The room, with one camera in it.
    pub scene: Scene,
    /// Places and directions of sensors, at least 3.
    pub sensors: Vec<(Vec3, Vec3)>,
    /// The seed.
    pub seed: u32,
    /// The kind.
    pub kind: Kind,
    /// The thickness of the walls in metres; 0 for sheets.
    pub wall_m: f32,
    /// `true` if all surfaces are double-sided.
    pub is_double_sided: bool,
    /// `true` if the room is turned against the axes.
    pub is_turned: bool,
    /// The light.
    pub light: RoomLight,
    /// `true` if there is a window or another opening.
    pub is_open: bool,
}

/// Makes the room of that seed and kind.
///
/// # Errors
/// [`SceneError`] if the scene were invalid, which no seed is known to cause.
pub fn room(seed: u32, kind: Kind) -> Result<Room, SceneError> {
    let mut dice = Dice::new(seed);
    let size_m = dice.point(Vec3::new(3.0, 2.4, 3.0), Vec3::new(8.0, 4.0, 8.0));
    let wall_m = if kind == Kind::Tent { 0.0 } else { dice.pick(&WALLS_M) };
    // A single-sided sheet lets light through from behind.
    let is_double_sided = dice.is(0.5) || kind == Kind::Tent;
    let light = match dice.draw() {
        _ if kind == Kind::ThinLamp => RoomLight::Panel,
        ..0.2 => RoomLight::Lamp,
        ..0.4 => RoomLight::Panel,
        ..0.7 => RoomLight::Sky,
        ..0.9 => RoomLight::Day,
        _ => RoomLight::Dark,
    };
    let is_open = match light {
        RoomLight::Sky => true,
        RoomLight::Lamp | RoomLight::Day => dice.is(0.4),
        RoomLight::Panel | RoomLight::Dark => false,
    };
    let turn = dice.is(0.6).then(|| dice.rotation());

    let mut build = Build::new(dice, kind, size_m, wall_m, is_open);
    build.shape();
    let lamp = matches!(light, RoomLight::Lamp | RoomLight::Day).then(|| build.lamp_position());
    if light == RoomLight::Panel {
        build.panel();
    }
    let mut sensors = build.sensors();
    let (eyes, target) = build.eyes();
    let mut scene = build.finish(is_double_sided);
    scene.name = format!("{}-{seed}", kind.name());
    if let Some(position) = lamp {
        point_light(&mut scene, "lamp", position, 100.0);
    }
    if matches!(light, RoomLight::Sky | RoomLight::Day | RoomLight::Dark) {
        scene.environment =
            Environment { radiance: Vec3::splat(SKY_RADIANCE), ..Environment::default() };
    }
    scene.validate()?;

    // Choose the camera that sees farthest.
    let picker = Picker::new(&scene);
    let look = |eye: Vec3| Camera::look_at(eye, target, 1.1);
    let view_m = |camera: &Camera| {
        picker.pick(camera.position, camera.forward).map_or(0.0, |met| met.distance_m)
    };
    let cameras = eyes.into_iter().map(look);
    let farthest = cameras.max_by(|a, b| view_m(a).total_cmp(&view_m(b)));
    scene.cameras.extend(farthest);

    if let Some(turn) = turn {
        scene.transform(Mat4::from_quat(turn));
        for (at, normal) in &mut sensors {
            (*at, *normal) = (turn * *at, turn * *normal);
        }
    }
    let is_turned = turn.is_some();
    Ok(Room { scene, sensors, seed, kind, wall_m, is_double_sided, is_turned, light, is_open })
}
