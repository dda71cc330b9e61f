//! The fly-through: an animated camera on a smooth path through the city.

use std::sync::Arc;

use glam::{Quat, Vec3};

use crate::pose::{Animation, Channel, Interpolation, Local, Node, Parts, Property, Rig, Track};
use crate::{Camera, Scene, SceneError};

/// The name of the camera that flies.
pub(super) const NAME: &str = "flight";
/// Keys per second; between them the camera moves in a straight line.
const KEYS_PER_SECOND: u32 = 4;

/// A time, s, with the camera's position and target at that time.
#[derive(Clone, Copy)]
pub(super) struct Stop {
    pub(super) time_s: f32,
    pub(super) eye: [f32; 3],
    pub(super) target: [f32; 3],
}

/// Adds an animation that moves the scene's last camera; the other cameras stay.
pub(super) fn install(scene: &mut Scene, stops: &[Stop]) -> Result<(), SceneError> {
    let place = |camera: &Camera| {
        let world = camera.world_from_camera();
        let (scale, rotation, translation) = world.to_scale_rotation_translation();
        Local::Parts { translation, rotation, scale }
    };
    let node = |camera: &Camera| Node {
        name: camera.name.as_str().into(),
        parent: None,
        rest: place(camera),
        weights: Vec::new(),
    };
    let nodes: Vec<Node> = scene.cameras.iter().map(node).collect();
    let duration_s = stops.last().map_or(0.0, |stop| stop.time_s);
    let steps = (duration_s * KEYS_PER_SECOND as f32).round() as u32;
    let times: Arc<[f32]> = (0..=steps).map(|step| step as f32 / KEYS_PER_SECOND as f32).collect();
    let mut eyes = Vec::new();
    let mut rotations: Vec<f32> = Vec::new();
    for &time_s in times.iter() {
        let camera = at(stops, time_s);
        eyes.extend(camera.position.to_array());
        rotations.extend(Quat::from_mat4(&camera.world_from_camera()).to_array());
    }
    let track = |values: Vec<f32>, components| Track {
        times_s: Arc::clone(&times),
        values: values.into(),
        components,
        interpolation: Interpolation::Linear,
    };
    let last = nodes.len() - 1;
    let channel = |property, track| Channel { node: last, property, track };
    let channels = vec![
        channel(Property::Translation, track(eyes, 3)),
        channel(Property::Rotation, track(rotations, 4)),
    ];
    let parts = Parts {
        cameras: (0..nodes.len()).collect(),
        nodes,
        animations: vec![Animation { name: NAME.to_owned(), duration_s, channels }],
        ..Parts::default()
    };
    Rig::install(scene, parts)
}

/// The camera at a time. Eye and target follow a spline through the stops (Catmull and Rom 1974, "A
/// class of local interpolating splines"); the velocity at a stop is the mean velocity between its
/// neighbours.
pub(super) fn at(stops: &[Stop], time_s: f32) -> Camera {
    let last = stops.len() - 1;
    let next = stops.partition_point(|stop| stop.time_s <= time_s).clamp(1, last);
    let (from, to) = (stops[next - 1], stops[next]);
    let length_s = to.time_s - from.time_s;
    let t = ((time_s - from.time_s) / length_s).clamp(0.0, 1.0);
    let way = |of: fn(&Stop) -> Vec3| {
        let slope = |at: usize| {
            let (before, after) = (&stops[at.saturating_sub(1)], &stops[(at + 1).min(last)]);
            (of(after) - of(before)) / (after.time_s - before.time_s) * length_s
        };
        hermite(of(&from), slope(next - 1), of(&to), slope(next), t)
    };
    let eye = way(|stop| Vec3::from(stop.eye));
    let target = way(|stop| Vec3::from(stop.target));
    Camera { name: NAME.to_owned(), ..Camera::look_at(eye, target, 1.05) }
}

/// Cubic Hermite interpolation between two points with given slopes.
fn hermite(from: Vec3, leaving: Vec3, to: Vec3, arriving: Vec3, t: f32) -> Vec3 {
    let (t2, t3) = (t * t, t * t * t);
    from * (2.0 * t3 - 3.0 * t2 + 1.0)
        + to * (3.0 * t2 - 2.0 * t3)
        + leaving * (t3 - 2.0 * t2 + t)
        + arriving * (t3 - t2)
}
