//! What is in a scene.

use glam::Vec3;
use lumivox_scene::{AlphaMode, Light, LightKind, Scene};
use serde::Serialize;

use crate::report::{SceneCounts, count, counted};

/// What is in a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    #[serde(flatten)]
    counts: SceneCounts,
    /// Of the box around everything, m.
    bounds_min: [f32; 3],
    bounds_max: [f32; 3],
    /// Radiance of the surroundings, cd/m².
    environment: [f32; 3],
    emissive_materials: usize,
    masked_materials: usize,
    blended_materials: usize,
    /// Texels of all textures, finest levels.
    texels: u64,
    lights: Vec<LightReport>,
    cameras: Vec<CameraReport>,
    /// Triangles of no area that were removed.
    degenerate_triangles: usize,
    warnings: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct LightReport {
    name: String,
    kind: &'static str,
    /// Illuminance in lux or intensity in candela.
    strength: f32,
    unit: &'static str,
    color: [f32; 3],
    /// None for directional lights.
    position: Option<[f32; 3]>,
    /// Along which the light travels; none for point lights.
    direction: Option<[f32; 3]>,
}

#[derive(Clone, Debug, Serialize)]
struct CameraReport {
    name: String,
    position: [f32; 3],
    forward: [f32; 3],
    vertical_fov_deg: f32,
}

impl LightReport {
    fn new(light: &Light) -> Self {
        let (position, direction) = (light.position.to_array(), light.direction.to_array());
        let (kind, strength, unit, position, direction) = match light.kind {
            LightKind::Directional { illuminance_lux, .. } => {
                ("directional", illuminance_lux, "lux", None, Some(direction))
            }
            LightKind::Point { intensity_cd, .. } => {
                ("point", intensity_cd, "cd", Some(position), None)
            }
            LightKind::Spot { intensity_cd, .. } => {
                ("spot", intensity_cd, "cd", Some(position), Some(direction))
            }
        };
        let (name, color) = (light.name.clone(), light.color.to_array());
        Self { name, kind, strength, unit, color, position, direction }
    }
}

impl Report {
    /// Looks through a scene.
    pub fn new(scene: &Scene) -> Self {
        let bounds = scene.bounds();
        let materials = |which: fn(&lumivox_scene::Material) -> bool| {
            scene.materials.iter().filter(|material| which(material)).count()
        };
        let texels = scene.textures.iter().map(|t| u64::from(t.width) * u64::from(t.height));
        let cameras = scene.cameras.iter().map(|camera| CameraReport {
            name: camera.name.clone(),
            position: camera.position.to_array(),
            forward: camera.forward.to_array(),
            vertical_fov_deg: camera.vertical_fov_rad.to_degrees(),
        });
        Self {
            counts: SceneCounts::new(scene),
            bounds_min: bounds.min.to_array(),
            bounds_max: bounds.max.to_array(),
            environment: scene.environment.radiance.to_array(),
            emissive_materials: materials(|m| m.emissive.max_element() > 0.0),
            masked_materials: materials(|m| matches!(m.alpha, AlphaMode::Mask { .. })),
            blended_materials: materials(|m| m.alpha == AlphaMode::Blend),
            texels: texels.sum(),
            lights: scene.lights.iter().map(LightReport::new).collect(),
            cameras: cameras.collect(),
            degenerate_triangles: scene.notes.degenerate_triangles,
            warnings: scene.notes.warnings.clone(),
        }
    }

    /// The report for people.
    pub fn text(&self) -> String {
        let counts = &self.counts;
        let (min, max) = (Vec3::from(self.bounds_min), Vec3::from(self.bounds_max));
        let size = max - min;
        let mut text = format!("{}\n", counts.name);
        let mut line = |name: &str, value: String| {
            text += &format!("  {name:<12} {value}\n");
        };
        line(
            "triangles",
            format!(
                "{} in {} of {}",
                count(counts.triangles as u64),
                counted(counts.instances, "instance", "instances"),
                counted(counts.meshes, "mesh", "meshes")
            ),
        );
        line("bounds", format!("{} to {} m", point(self.bounds_min), point(self.bounds_max)));
        line("size", format!("{:.3} x {:.3} x {:.3} m", size.x, size.y, size.z));
        line(
            "materials",
            format!(
                "{}: {} emissive, {} masked, {} blended",
                count(counts.materials as u64),
                self.emissive_materials,
                self.masked_materials,
                self.blended_materials
            ),
        );
        line(
            "textures",
            format!("{} with {} texels", count(counts.textures as u64), count(self.texels)),
        );
        line("environment", format!("{} cd/m2", point(self.environment)));
        line("lights", count(counts.lights as u64));
        for light in &self.lights {
            let place = match (light.position, light.direction) {
                (Some(at), Some(towards)) => {
                    format!(" at {} towards {}", point(at), point(towards))
                }
                (Some(at), None) => format!(" at {}", point(at)),
                (None, Some(towards)) => format!(" towards {}", point(towards)),
                (None, None) => String::new(),
            };
            let LightReport { name, kind, strength, unit, .. } = light;
            line("", format!("{name}: {kind}, {strength} {unit}{place}"));
        }
        line("cameras", count(counts.cameras as u64));
        for (index, camera) in self.cameras.iter().enumerate() {
            line(
                "",
                format!(
                    "{index} {}: at {} towards {}, {:.1} degrees high",
                    camera.name,
                    point(camera.position),
                    point(camera.forward),
                    camera.vertical_fov_deg
                ),
            );
        }
        if self.degenerate_triangles > 0 {
            let removed = counted(self.degenerate_triangles, "triangle", "triangles");
            line("note", format!("{removed} of no area left out"));
        }
        for warning in &self.warnings {
            line("warning", warning.clone());
        }
        text
    }
}

fn point([x, y, z]: [f32; 3]) -> String {
    format!("({x:.3}, {y:.3}, {z:.3})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_builtin_scene_is_described() {
        for name in lumivox_scene::builtin::names() {
            let scene = lumivox_scene::builtin::scene(name).unwrap();
            let report = Report::new(&scene);
            let text = report.text();
            assert!(text.starts_with(name), "{text}");
            for camera in &scene.cameras {
                assert!(text.contains(&camera.name), "{text}");
            }
            serde_json::to_string(&report).unwrap();
        }
    }
}
