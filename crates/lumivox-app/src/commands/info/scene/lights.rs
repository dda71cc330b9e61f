//! The reports on lights and cameras of a scene.

use lumivox_console::report::Table;
use lumivox_scene::{Camera, Environment, Light, Scene};
use serde::Serialize;

/// The report on a light.
#[derive(Clone, Debug, Serialize)]
pub struct LightReport {
    name: String,
    kind: &'static str,
    /// Illuminance in lux, or intensity in candela.
    strength: f32,
    unit: &'static str,
    color: [f32; 3],
    /// `None` for directional lights.
    position: Option<[f64; 3]>,
    /// The direction in which the light travels; `None` for point lights.
    direction: Option<[f32; 3]>,
}

/// The report on a camera.
#[derive(Clone, Debug, Serialize)]
pub struct CameraReport {
    pub name: String,
    position: [f64; 3],
    forward: [f32; 3],
    vertical_fov_deg: f32,
}

/// The report on a panorama.
#[derive(Clone, Debug, Serialize)]
pub struct PanoramaReport {
    name: String,
    width: u32,
    height: u32,
    rotation_deg: f32,
}

impl LightReport {
    /// The report on a light.
    pub fn new(scene: &Scene, light: &Light) -> Self {
        let kind = light.kind;
        Self {
            name: light.name.clone(),
            kind: kind.name(),
            strength: light.intensity,
            unit: kind.unit(),
            color: light.color.to_array(),
            position: kind.has("position").then(|| scene.to_file(light.position).to_array()),
            direction: kind.has("direction").then(|| light.direction.to_array()),
        }
    }
}

impl CameraReport {
    /// The report on a camera.
    pub fn new(scene: &Scene, camera: &Camera) -> Self {
        Self {
            name: camera.name.clone(),
            position: scene.to_file(camera.position).to_array(),
            forward: camera.forward.to_array(),
            vertical_fov_deg: camera.vertical_fov_rad.to_degrees(),
        }
    }
}

impl PanoramaReport {
    /// The report on an environment's map, if it has one.
    pub fn new(environment: &Environment) -> Option<Self> {
        let map = environment.map.as_ref()?;
        Some(Self {
            name: map.name.clone(),
            width: map.width,
            height: map.height,
            rotation_deg: environment.rotation_rad.to_degrees(),
        })
    }

    /// A summary in one line.
    pub fn text(&self) -> String {
        format!(
            "{}, {}x{} texels, turned by {:.0} degrees",
            self.name, self.width, self.height, self.rotation_deg
        )
    }
}

/// A table of lights.
pub fn light_table(lights: &[LightReport]) -> Table {
    let mut table =
        Table::left(&["#", "light", "kind", "strength", "colour", "position in m", "towards"]);
    for (index, light) in lights.iter().enumerate() {
        let [r, g, b] = light.color;
        table.row([
            index.to_string(),
            light.name.clone(),
            light.kind.to_owned(),
            format!("{} {}", light.strength, light.unit),
            format!("{r:.3},{g:.3},{b:.3}"),
            light.position.map_or(String::new(), point),
            light.direction.map_or(String::new(), |towards| point(towards.map(f64::from))),
        ]);
    }
    table
}

/// A table of cameras.
pub fn camera_table(cameras: &[CameraReport]) -> Table {
    let mut table = Table::left(&["#", "camera", "position in m", "towards", "degrees high"]);
    for (index, camera) in cameras.iter().enumerate() {
        table.row([
            index.to_string(),
            camera.name.clone(),
            point(camera.position),
            point(camera.forward.map(f64::from)),
            format!("{:.1}", camera.vertical_fov_deg),
        ]);
    }
    table
}

/// Coordinates in words.
pub fn point([x, y, z]: [f64; 3]) -> String {
    format!("({x:.3}, {y:.3}, {z:.3})")
}
