//! The report on a scene.

mod lights;
mod materials;
#[cfg(test)]
mod tests;

use std::cell::OnceCell;

use glam::DVec3;
use lumivox_console::report::{
    MemoryReport, SceneCounts, Table, bytes, count, counted, memory_table, total_bytes,
};
use lumivox_console::shown;
use lumivox_render::{MemoryEstimate, RenderSettings};
use lumivox_scene::{AlphaMode, Material, Mesh, Scene, Sight, SightOptions};
use serde::Serialize;

use lights::{CameraReport, LightReport, PanoramaReport, camera_table, light_table, point};
use materials::{MaterialReport, TextureReport, material_table, texture_table};

/// The most rows of a table for people; JSON has all.
const MOST_ROWS: usize = 50;

/// The report on a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    #[serde(flatten)]
    counts: SceneCounts,
    /// Triangles of static instances.
    static_triangles: usize,
    static_instances: usize,
    dynamic_triangles: usize,
    dynamic_instances: usize,
    /// Hidden instances. Only the counts in `mesh_list` include them, too.
    hidden_instances: usize,
    /// Instances that are drawn but not voxelized.
    unvoxelized_instances: usize,
    /// Vertices of all meshes, each mesh counted once.
    vertices: usize,
    /// The corners of the box around all shown instances, m; null if there are none.
    bounds_min: Option<[f64; 3]>,
    bounds_max: Option<[f64; 3]>,
    /// The program that wrote the file.
    generator: Option<String>,
    extensions_used: Vec<String>,
    extensions_required: Vec<String>,
    /// The file's scenes, in order.
    scenes: Vec<String>,
    mesh_list: Vec<MeshReport>,
    material_list: Vec<MaterialReport>,
    emissive_materials: usize,
    masked_materials: usize,
    blended_materials: usize,
    texture_list: Vec<TextureReport>,
    /// Texels of all textures at their finest levels.
    texels: u64,
    /// Radiance of the surroundings, cd/m²; for a panorama its factor.
    environment: [f32; 3],
    panorama: Option<PanoramaReport>,
    #[serde(rename = "light_list")]
    lights: Vec<LightReport>,
    #[serde(rename = "camera_list")]
    cameras: Vec<CameraReport>,
    /// The camera that is used by default.
    default_camera: CameraReport,
    /// The light that is added by default; `None` if the scene has enough.
    default_light: Option<String>,
    /// The view and the light that were chosen, with the reasons.
    sight: Vec<String>,
    /// The note on coarse voxels, if there is one.
    #[serde(skip)]
    coarse: Option<String>,
    animations: Vec<AnimationReport>,
    /// Bytes of all vertices in main memory.
    vertex_bytes: u64,
    texture_bytes: u64,
    /// The resolution for which memory on the GPU is estimated.
    resolution: u32,
    /// Occupied voxels at that resolution, estimated.
    voxels: u64,
    /// Estimated memory on the GPU, without the picture.
    memory: Vec<MemoryReport>,
    memory_bytes: u64,
    /// Triangles without area, which were removed.
    degenerate_triangles: usize,
    warnings: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct MeshReport {
    name: String,
    triangles: usize,
    vertices: usize,
    /// Instances of the mesh, including hidden ones.
    instances: usize,
    texture_coordinates: u32,
    has_colors: bool,
}

#[derive(Clone, Debug, Serialize)]
struct AnimationReport {
    name: String,
    duration_s: f32,
}

impl Report {
    /// Examines a scene.
    ///
    /// # Errors
    /// When the voxels' settings do not fit the scene.
    pub fn new(scene: &Scene, settings: &RenderSettings) -> anyhow::Result<Self> {
        let estimate = MemoryEstimate::new(scene, settings)?;
        let parts = estimate.parts.iter().filter(|part| part.name != "picture").cloned();
        let memory: Vec<MemoryReport> = parts.map(Into::into).collect();
        let bounds = Some(scene.bounds()).filter(|bounds| bounds.min.is_finite());
        let materials = |which: fn(&Material) -> bool| {
            scene.materials.iter().filter(|material| which(material)).count()
        };
        let texels = scene.textures.iter().map(|t| u64::from(t.width) * u64::from(t.height));
        let aspect = settings.size.x as f32 / settings.size.y as f32;
        let fineness = settings.fineness(scene);
        let options = SightOptions { aspect, fineness, ..SightOptions::default() };
        let sight = Sight::of(scene, &options, &OnceCell::new());
        let animations = scene.animations().into_iter().map(|animation| AnimationReport {
            name: animation.name,
            duration_s: animation.duration_s,
        });
        let notes = &scene.notes;
        let [fixed, moving] = [true, false].map(|is_static| {
            let instances = scene.shown().filter(|i| i.is_static == is_static);
            instances.fold((0, 0), |(triangles, instances), instance| {
                (triangles + scene.meshes[instance.mesh].triangle_count(), instances + 1)
            })
        });
        Ok(Self {
            counts: SceneCounts::new(scene),
            static_triangles: fixed.0,
            static_instances: fixed.1,
            dynamic_triangles: moving.0,
            dynamic_instances: moving.1,
            hidden_instances: scene.instances.len() - scene.shown().count(),
            unvoxelized_instances: scene.shown().filter(|i| !i.is_voxelized).count(),
            vertices: scene.meshes.iter().map(|mesh| mesh.positions.len()).sum(),
            bounds_min: bounds.map(|bounds| scene.to_file(bounds.min).to_array()),
            bounds_max: bounds.map(|bounds| scene.to_file(bounds.max).to_array()),
            generator: notes.generator.clone(),
            extensions_used: notes.extensions_used.clone(),
            extensions_required: notes.extensions_required.clone(),
            scenes: notes.scenes.clone(),
            mesh_list: meshes(scene),
            material_list: scene.materials.iter().map(MaterialReport::new).collect(),
            emissive_materials: materials(|m| m.emissive.max_element() > 0.0),
            masked_materials: materials(|m| matches!(m.alpha, AlphaMode::Mask { .. })),
            blended_materials: materials(|m| m.alpha == AlphaMode::Blend),
            texture_list: TextureReport::all(scene),
            texels: texels.sum(),
            environment: scene.environment.radiance.to_array(),
            panorama: PanoramaReport::new(&scene.environment),
            lights: scene.lights.iter().map(|light| LightReport::new(scene, light)).collect(),
            cameras: scene.cameras.iter().map(|camera| CameraReport::new(scene, camera)).collect(),
            default_camera: CameraReport::new(scene, &sight.camera),
            default_light: sight.light.map(|light| light.to_string()),
            coarse: sight.notes.iter().find(|note| note.about == "grid").map(ToString::to_string),
            sight: sight.notes.iter().map(ToString::to_string).collect(),
            animations: animations.collect(),
            vertex_bytes: scene.meshes.iter().map(bytes_of).sum(),
            texture_bytes: scene.textures.iter().map(|t| t.rgba8.len() as u64).sum(),
            resolution: settings.resolution,
            voxels: estimate.voxels,
            memory_bytes: total_bytes(&memory),
            memory,
            degenerate_triangles: notes.degenerate_triangles,
            warnings: notes.warnings.clone(),
        })
    }

    /// The report for people.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n", shown::line(&self.counts.name));
        for (name, value) in self.summary() {
            text += &format!("  {name:<12} {}\n", shown::line(&value));
        }
        let mut animations = Table::left(&["#", "animation", "seconds"]);
        for (index, animation) in self.animations.iter().enumerate() {
            let seconds = format!("{:.3}", animation.duration_s);
            animations.row([index.to_string(), animation.name.clone(), seconds]);
        }
        for table in [
            material_table(&self.material_list),
            texture_table(&self.texture_list),
            light_table(&self.lights),
            camera_table(&self.cameras),
            animations,
        ] {
            if table.row_count() > 0 {
                text.push('\n');
                text += &table.text_of(MOST_ROWS);
            }
        }
        text.push('\n');
        text += &memory_table(&self.memory);
        let voxels = counted(self.voxels as usize, "voxel", "voxels");
        text += &format!(
            "  (estimated at --resolution {}, with about {voxels}; a picture comes on top)\n",
            self.resolution
        );
        if self.degenerate_triangles > 0 {
            let removed = counted(self.degenerate_triangles, "triangle", "triangles");
            text += &format!("\nnote: {removed} of no area left out\n");
        }
        for warning in &self.warnings {
            text += &format!("\nwarning: {}\n", shown::line(warning));
        }
        text
    }

    fn bounds(&self) -> String {
        let (Some(min), Some(max)) = (self.bounds_min, self.bounds_max) else {
            return "none: nothing is shown".to_owned();
        };
        format!("{} to {} m", point(min), point(max))
    }

    fn size(&self) -> String {
        let (Some(min), Some(max)) = (self.bounds_min, self.bounds_max) else {
            return "none".to_owned();
        };
        let size = DVec3::from(max) - DVec3::from(min);
        format!("{:.3} x {:.3} x {:.3} m", size.x, size.y, size.z)
    }

    fn summary(&self) -> Vec<(&'static str, String)> {
        let counts = &self.counts;
        let names = |names: &[String]| names.join(", ");
        let mut lines = vec![
            (
                "triangles",
                format!(
                    "{} in {} of {}",
                    count(counts.triangles as u64),
                    counted(counts.instances, "instance", "instances"),
                    counted(counts.meshes, "mesh", "meshes")
                ),
            ),
            (
                "that move",
                format!(
                    "{} in {}; static: {} in {}",
                    count(self.dynamic_triangles as u64),
                    counted(self.dynamic_instances, "instance", "instances"),
                    count(self.static_triangles as u64),
                    counted(self.static_instances, "instance", "instances"),
                ),
            ),
            (
                "marked",
                format!(
                    "{} hidden, {} not voxelized",
                    counted(self.hidden_instances, "instance", "instances"),
                    self.unvoxelized_instances
                ),
            ),
            ("vertices", format!("{}, {}", count(self.vertices as u64), bytes(self.vertex_bytes))),
            ("bounds", self.bounds()),
            ("size", self.size()),
            (
                "materials",
                format!(
                    "{}: {} emissive, {} masked, {} blended",
                    count(counts.materials as u64),
                    self.emissive_materials,
                    self.masked_materials,
                    self.blended_materials
                ),
            ),
            (
                "textures",
                format!(
                    "{} with {} texels, {}",
                    count(counts.textures as u64),
                    count(self.texels),
                    bytes(self.texture_bytes)
                ),
            ),
            ("environment", format!("{} cd/m2", point(self.environment.map(f64::from)))),
            ("lights", self.lights_used()),
            ("cameras", format!("{}; used: {}", counts.cameras, self.camera_used())),
            ("animations", count(self.animations.len() as u64)),
        ];
        if let Some(note) = &self.coarse {
            lines.push(("grid", note.clone()));
        }
        if let Some(panorama) = &self.panorama {
            lines.push(("panorama", panorama.text()));
        }
        if let Some(generator) = &self.generator {
            lines.push(("written by", generator.clone()));
        }
        if self.scenes.len() > 1 {
            let scenes = self.scenes.iter().enumerate().map(|(i, name)| format!("{i} \"{name}\""));
            lines.push(("scenes", names(&scenes.take(MOST_ROWS).collect::<Vec<_>>())));
        }
        if !self.extensions_used.is_empty() {
            let is_required = |name: &&String| self.extensions_required.contains(name);
            let (required, optional): (Vec<_>, Vec<_>) =
                self.extensions_used.iter().partition(is_required);
            let words =
                |list: &[&String]| names(&list.iter().map(|n| (*n).clone()).collect::<Vec<_>>());
            if !optional.is_empty() {
                lines.push(("extensions", words(&optional)));
            }
            if !required.is_empty() {
                lines.push(("required", words(&required)));
            }
        }
        lines
    }

    fn lights_used(&self) -> String {
        let lights = count(self.counts.lights as u64);
        match &self.default_light {
            Some(light) => format!("{lights}; too little light, added: {light}"),
            None => lights,
        }
    }

    fn camera_used(&self) -> String {
        let camera = &self.default_camera;
        if self.cameras.is_empty() {
            format!("{} (the scene has none)", camera.name)
        } else {
            format!("0 \"{}\"", camera.name)
        }
    }
}

fn meshes(scene: &Scene) -> Vec<MeshReport> {
    let mut reports: Vec<MeshReport> = scene
        .meshes
        .iter()
        .map(|mesh| MeshReport {
            name: mesh.name.clone(),
            triangles: mesh.triangle_count(),
            vertices: mesh.positions.len(),
            instances: 0,
            texture_coordinates: u32::from(!mesh.uvs.is_empty()) + u32::from(!mesh.uvs1.is_empty()),
            has_colors: !mesh.colors.is_empty(),
        })
        .collect();
    for instance in &scene.instances {
        if let Some(report) = reports.get_mut(instance.mesh) {
            report.instances += 1;
        }
    }
    reports
}

/// Bytes of a mesh in main memory.
fn bytes_of(mesh: &Mesh) -> u64 {
    let bytes = size_of_val(mesh.positions.as_slice())
        + size_of_val(mesh.normals.as_slice())
        + size_of_val(mesh.tangents.as_slice())
        + size_of_val(mesh.uvs.as_slice())
        + size_of_val(mesh.uvs1.as_slice())
        + size_of_val(mesh.colors.as_slice())
        + size_of_val(mesh.indices.as_slice());
    bytes as u64
}
