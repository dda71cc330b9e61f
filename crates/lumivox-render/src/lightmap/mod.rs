//! Lightmaps: the light on surfaces as one image, placed by a mesh's own texture coordinates, for
//! renderers without global illumination of their own.
//!
//! ```no_run
//! # async fn bake() -> Result<(), Box<dyn std::error::Error>> {
//! use lumivox_render::lightmap::{LightmapPlan, Resolution};
//! # let (scene, renderer): (lumivox_scene::Scene, lumivox_render::Renderer) = unimplemented!();
//!
//! let plan = LightmapPlan::new(&scene, 1, Resolution::Texels(1024))?;
//! let (points, normals): (Vec<_>, Vec<_>) = plan.places().iter().copied().unzip();
//! let light = renderer.irradiance(&points, &normals, 256).await?;
//! let light: Vec<_> = light.iter().map(|light| light.indirect).collect();
//! std::fs::write("hall.exr", plan.map(&light).to_exr()?)?;
//! # Ok(())
//! # }
//! ```
//!
//! | file | does |
//! | --- | --- |
//! | `error.rs` | errors |
//! | `charts.rs` | reads the triangles and their texture coordinates |
//! | `layout.rs` | gives each node its part of the map, if nodes share coordinates |
//! | `cover.rs` | finds the texels of each triangle |
//! | `places.rs` | places samples on surfaces, outside solids |
//! | `fill.rs` | spreads light to texels without samples |
//! | `seams.rs` | makes both sides of a seam agree |
//! | `file.rs` | the map as OpenEXR or KTX2 |

mod charts;
mod cover;
mod error;
mod file;
mod fill;
mod layout;
mod places;
mod seams;
#[cfg(test)]
mod tests;

use glam::Vec3;
use lumivox_scene::Scene;

use charts::Triangle;
use cover::Texel;
pub use error::LightmapError;
use places::Sample;
pub use seams::Seams;

/// The longest edge of a map, in texels.
pub const LARGEST: u32 = 4096;
/// The shortest edge of a map, in texels.
pub const SMALLEST: u32 = 16;

/// The resolution of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// The map's edge in texels, [`SMALLEST`] to [`LARGEST`].
    Texels(u32),
    /// Texels per metre of surface, above 0; the mean over each node.
    Density(f32),
}

/// A node of the scene with its part of the map.
#[derive(Clone, Debug, PartialEq)]
pub struct LightmapNode {
    /// The node's name.
    pub name: String,
    /// Its instances, as indices into [`Scene::instances`]: one for each primitive.
    pub instances: Vec<usize>,
    /// Its part of the map: least u, least v, greatest u, greatest v. Coordinates (u, v) of the
    /// mesh are at `(rect[0] + u * (rect[2] - rect[0]), rect[1] + v * (rect[3] - rect[1]))`.
    pub rect: [f32; 4],
    /// Mean number of texels along a metre of its surface.
    pub texels_per_metre: f32,
    /// The edge of its part in texels, and the least corner.
    edge: u32,
    corner: [u32; 2],
    /// Area of its surface, m², and in texture coordinates.
    area_m2: f64,
    area_uv: f64,
}

/// The texels of a map, and the places of their samples.
#[derive(Clone, Debug)]
pub struct LightmapPlan {
    edge: u32,
    nodes: Vec<LightmapNode>,
    triangles: Vec<Triangle>,
    texels: Vec<Texel>,
    samples: Vec<Sample>,
    places: Vec<(Vec3, Vec3)>,
    left_out: usize,
    is_packed: bool,
}

impl LightmapPlan {
    /// Plans the map of a valid scene, by the texture coordinates `uv_set` (0 or 1) of its meshes.
    ///
    /// Everything static and visible is baked, except backdrops. The coordinates of each node must
    /// be within the unit square, and its triangles may not overlap there. If those of different
    /// nodes do, each node gets a part of the map ([`LightmapNode::rect`]); otherwise
    /// meshes use the map without changes.
    ///
    /// # Errors
    /// [`LightmapError`] if a mesh has no such coordinates, or unsuitable ones, or if the map would
    /// be too large.
    pub fn new(scene: &Scene, uv_set: u32, resolution: Resolution) -> Result<Self, LightmapError> {
        let charts::Charts { mut nodes, mut triangles, left_out } = charts::of(scene, uv_set)?;
        let (edge, is_packed) = layout::place(&mut nodes, &mut triangles, resolution)?;
        let texels = cover::cover(&nodes, &triangles, edge)?;
        let samples = places::samples(scene, &triangles, &texels);
        let visible = samples.iter().filter(|sample| !sample.is_buried);
        let places = visible.map(|sample| (sample.at, sample.normal)).collect();
        Ok(Self { edge, nodes, triangles, texels, samples, places, left_out, is_packed })
    }

    /// Points on surfaces, m, and their normals, at which light is needed.
    pub fn places(&self) -> &[(Vec3, Vec3)] {
        &self.places
    }

    /// The map's edge in texels.
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// The nodes and their parts of the map.
    pub fn nodes(&self) -> &[LightmapNode] {
        &self.nodes
    }

    /// Whether each node has its own part of the map, because their coordinates overlap.
    pub fn is_packed(&self) -> bool {
        self.is_packed
    }

    /// The number of texels on surfaces, with those beside their edges.
    pub fn covered(&self) -> usize {
        self.samples.len()
    }

    /// The number of these texels that are hidden inside solids.
    pub fn buried(&self) -> usize {
        self.samples.len() - self.places.len()
    }

    /// The number of visible instances that are not baked, because an animation moves or deforms
    /// them.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// The map with this irradiance at [`Self::places`], lux in linear RGB.
    ///
    /// # Panics
    /// If the number of values differs from the number of places.
    pub fn map(&self, irradiance: &[Vec3]) -> Lightmap {
        assert_eq!(irradiance.len(), self.places.len(), "one value for each place");
        let mut light = vec![Vec3::ZERO; self.texels.len()];
        let mut is_known = vec![false; self.texels.len()];
        let visible = self.samples.iter().filter(|sample| !sample.is_buried);
        for (sample, lux) in visible.zip(irradiance) {
            // The luminance of a white Lambertian surface in this light, cd/m².
            light[sample.texel] = *lux / std::f32::consts::PI;
            is_known[sample.texel] = true;
        }
        let is_measured = is_known.clone();
        // Hidden texels first, from their own node; then all others, from the nearest.
        let node = |texel: usize| self.texels[texel].node(&self.triangles);
        fill::spread(&mut light, &mut is_known, self.edge, |from, to| {
            node(to).is_some() && node(from) == node(to)
        });
        fill::spread(&mut light, &mut is_known, self.edge, |_, _| true);
        let seams = seams::join(&mut light, &is_measured, self);
        Lightmap { edge: self.edge, light, seams }
    }
}

/// The light on surfaces as an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Lightmap {
    edge: u32,
    light: Vec<Vec3>,
    seams: Seams,
}

impl Lightmap {
    /// The map's edge in texels.
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// The rows of texels from the top, at v = 0: irradiance divided by pi, cd/m² in linear RGB.
    pub fn light(&self) -> &[Vec3] {
        &self.light
    }

    /// The seams, and how well their sides agree.
    pub fn seams(&self) -> Seams {
        self.seams
    }
}
