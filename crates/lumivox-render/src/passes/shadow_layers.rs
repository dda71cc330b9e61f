//! Assigns layers of shadow maps, with their projections, to lights, as far as they fit.
//!
//! A directional light has one layer, a parallel projection fitted to the scene's bounds, and finer
//! layers within it around every second cascade of the voxels. A spot light has one, a perspective
//! projection as wide as its cone; a point light has six, the faces of a cube. Depth is reversed (1
//! near, 0 far) and, in perspective, has no far plane: a float's precision then falls off like that
//! of perspective (Reed 2015, "Depth precision visualized").

use glam::camera::rh::proj::directx::{orthographic, perspective_infinite_reverse};
use glam::camera::rh::view::look_to_mat4;
use glam::{Mat4, Vec2, Vec3};
use lumivox::{Grid, Light, LightSource, Shadow, ShadowLayer};
use lumivox_scene::Bounds;

use crate::scene::corners;

/// The memory limit of all layers together.
pub(crate) const MAX_BYTES: u64 = 256 << 20;
/// The most layers: enough for ten point lights.
const MAX_LAYERS: u32 = 64;
/// The edge in texels below which a map's resolution is not reduced to make space for finer maps.
const ENOUGH: u32 = 1024;
/// Every cascade whose number is a multiple of this has a layer.
const EACH_CASCADE: usize = 2;
/// The edge of a cascade's layer divided by that of the next smaller one.
pub(crate) const STEP: f32 = (1 << EACH_CASCADE) as f32;
/// The margin of layers on each side, in texels: the filter reaches 1.5 texels around a receiver
/// that was offset by 2, and both must stay within the layer that contains the receiver.
const BORDER_TEXELS: f32 = 4.0;
/// The widest half angle of a spot light for one perspective layer: at this angle its centre has a
/// quarter of the resolution of a 90-degree map.
const MAX_SPOT_ANGLE_RAD: f32 = 1.32;
/// The near plane of a light without radius, as a share of the scene's radius: sixteen times the
/// resolution of f32 there. The path tracer's rays end before a lamp by the same distance. A lamp
/// may lie in the plane of a surface.
const NEAR_SHARE: f32 = 1.0 / (1 << 18) as f32;

/// Two steps of f32, relative to the distance from the origin: positions there are rounded.
const COARSENESS: f32 = 1.0 / (1 << 22) as f32;

/// Assigns layers to the lights; returns them and the edge of their maps in texels, which is less
/// than `resolution` if finer layers need the memory.
pub(super) fn assign(
    lights: &mut [Light],
    bounds: Bounds,
    grid: &Grid,
    resolution: u32,
) -> (Vec<ShadowLayer>, u32) {
    let boxes = fine_boxes(grid);
    let sources: Vec<_> = lights.iter().map(|light| light.source).collect();
    let resolution = resolution_with_finer(&sources, bounds, &boxes, resolution);
    (assign_layers(lights, bounds, &boxes, resolution), resolution)
}

/// The boxes whose voxels need finer maps than that of the whole scene, the largest first: every
/// second cascade, so that a texel is at most a quarter of a voxel with 1024 texels and cascades of
/// 64 voxels.
pub(crate) fn fine_boxes(grid: &Grid) -> Vec<Bounds> {
    if grid.cascades.is_none() {
        return Vec::new();
    }
    let boxes = grid.boxes_in_world().into_iter().step_by(EACH_CASCADE);
    boxes.map(|(min, max)| Bounds { min, max }).rev().collect()
}

/// The most layers at a resolution.
fn most_layers(resolution: u32) -> usize {
    let layer_bytes = 4 * u64::from(resolution).pow(2);
    (MAX_BYTES / layer_bytes).min(u64::from(MAX_LAYERS)) as usize
}

/// The resolution if there are finer maps around cascades: the requested one, halved while the
/// layers do not all fit and the maps have more than [`ENOUGH`] texels. Small objects need finer
/// maps, not a larger one.
fn resolution_with_finer(
    lights: &[LightSource],
    bounds: Bounds,
    boxes: &[Bounds],
    mut resolution: u32,
) -> u32 {
    let finer: usize =
        lights.iter().map(|l| finer_layers(l, bounds, boxes, resolution).len()).sum();
    let needed: usize = lights.iter().map(|l| layers_of(l, bounds, resolution).len()).sum();
    while finer > 0 && resolution >= 2 * ENOUGH && needed + finer > most_layers(resolution) {
        resolution /= 2;
    }
    resolution
}

/// Assigns layers to the lights in order, as far as they fit: first the needed ones of each light,
/// then finer ones, the smallest first.
fn assign_layers(
    lights: &mut [Light],
    bounds: Bounds,
    fine_boxes: &[Bounds],
    resolution: u32,
) -> Vec<ShadowLayer> {
    let most = most_layers(resolution);
    let needed = |light: &Light| layers_of(&light.source, bounds, resolution);
    let mut room = most.saturating_sub(lights.iter().map(|light| needed(light).len()).sum());
    let mut suns_left =
        lights.iter().filter(|light| light.source.parallel_direction().is_some()).count();
    let mut layers: Vec<ShadowLayer> = Vec::new();
    let mut left_out = 0;
    for light in lights {
        let own = needed(light);
        if own.is_empty() || layers.len() + own.len() > most {
            light.shadow = Shadow::Cone;
            left_out += 1;
            continue;
        }
        light.shadow = Shadow::Map { first_layer: layers.len() as u32 };
        layers.extend(own);
        let finer = finer_layers(&light.source, bounds, fine_boxes, resolution);
        // The remaining suns share the remaining layers.
        let fits = finer.len().min(room / suns_left.max(1));
        suns_left -= usize::from(light.source.parallel_direction().is_some());
        room -= fits;
        for layer in &finer[finer.len() - fits..] {
            if let Some(wider) = layers.last_mut() {
                wider.has_finer = true;
            }
            layers.push(*layer);
        }
    }
    if left_out > 0 {
        tracing::warn!(
            "{left_out} lights cast soft shadows by cones through the voxels, since there are no \
             shadow maps for them (spot lights above {:.0} degrees have none, and {most} layers are \
             the most at a resolution of {resolution}; a point light needs 6)",
            2.0 * MAX_SPOT_ANGLE_RAD.to_degrees()
        );
    }
    layers
}

/// The layers of one light; empty if a spot light is too wide for a projection.
fn layers_of(source: &LightSource, bounds: Bounds, resolution: u32) -> Vec<ShadowLayer> {
    let far_m = bounds.center().abs().max_element();
    let least_near_m = bounds.radius_m() * NEAR_SHARE + far_m * COARSENESS;
    match *source {
        LightSource::Directional { direction, .. } | LightSource::Environment { direction, .. } => {
            vec![parallel_layer(direction, bounds, resolution)]
        }
        LightSource::Spot { position, direction, outer_angle_rad, radius_m, .. } => {
            if outer_angle_rad > MAX_SPOT_ANGLE_RAD {
                return Vec::new();
            }
            let near_m = radius_m.max(least_near_m);
            vec![perspective_layer(position, direction, outer_angle_rad, near_m, resolution)]
        }
        LightSource::Point { position, radius_m, .. } => {
            let near_m = radius_m.max(least_near_m);
            let faces = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
            faces
                .map(|face| {
                    let half_angle_rad = std::f32::consts::FRAC_PI_4;
                    perspective_layer(position, face, half_angle_rad, near_m, resolution)
                })
                .to_vec()
        }
    }
}

/// The finer layers of a parallel light within that of the whole scene: squares around boxes, each
/// within the one before.
fn finer_layers(
    source: &LightSource,
    bounds: Bounds,
    boxes: &[Bounds],
    resolution: u32,
) -> Vec<ShadowLayer> {
    let Some(direction) = source.parallel_direction() else { return Vec::new() };
    let sight = ParallelSight::new(direction, bounds);
    let layer = |own: &Bounds| {
        let middle = sight.view.transform_point3(own.center()).truncate();
        let square = |middle| sight.layer(middle, own.radius_m(), resolution);
        // Snapped to whole texels, so that shadow edges do not crawl.
        let texel_m = square(middle).texel_size;
        square(texel_m * (middle / texel_m).round())
    };
    sight.smaller(boxes).map(layer).collect()
}

fn parallel_layer(direction: Vec3, bounds: Bounds, resolution: u32) -> ShadowLayer {
    let sight = ParallelSight::new(direction, bounds);
    sight.layer(sight.seen.center().truncate(), sight.half_m, resolution)
}

/// A scene as parallel light sees it, along -z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ParallelSight {
    pub(super) view: Mat4,
    /// The scene's box in view space.
    seen: Bounds,
    /// Half the edge of the square around `seen`.
    pub(super) half_m: f32,
    depth_margin_m: f32,
}

impl ParallelSight {
    pub(crate) fn new(direction: Vec3, bounds: Bounds) -> Self {
        let view = look_to_mat4(bounds.center(), direction, direction.any_orthonormal_vector());
        let seen = Bounds::from_points(corners(bounds).map(|corner| view.transform_point3(corner)));
        // Square, so that one number is the size of a texel; never flat.
        let extent_m = seen.size().truncate().max_element().max(bounds.radius_m() * 1e-3);
        Self { view, seen, half_m: 0.5 * extent_m, depth_margin_m: bounds.radius_m() * 1e-3 }
    }

    /// The boxes small enough for a separate square: at most half as wide as the scene's.
    pub(crate) fn smaller(self, boxes: &[Bounds]) -> impl Iterator<Item = &Bounds> {
        boxes.iter().filter(move |own| 2.0 * own.radius_m() <= self.half_m)
    }

    /// The layer of a square in view space, as deep as the whole scene.
    pub(super) fn layer(&self, middle: Vec2, half_m: f32, resolution: u32) -> ShadowLayer {
        let half_m = half_m * border(resolution);
        // Near and far are swapped to reverse the depth.
        let projection = orthographic(
            middle.x - half_m,
            middle.x + half_m,
            middle.y - half_m,
            middle.y + half_m,
            -self.seen.min.z + self.depth_margin_m,
            -self.seen.max.z - self.depth_margin_m,
        );
        ShadowLayer {
            clip_from_world: projection * self.view,
            is_perspective: false,
            texel_size: 2.0 * half_m / resolution as f32,
            has_finer: false,
        }
    }
}

pub(super) fn perspective_layer(
    position: Vec3,
    direction: Vec3,
    half_angle_rad: f32,
    near_m: f32,
    resolution: u32,
) -> ShadowLayer {
    let slope = half_angle_rad.tan() * border(resolution);
    let view = look_to_mat4(position, direction, direction.any_orthonormal_vector());
    let projection = perspective_infinite_reverse(2.0 * slope.atan(), 1.0, near_m);
    ShadowLayer {
        clip_from_world: projection * view,
        is_perspective: true,
        texel_size: 2.0 * slope / resolution as f32,
        has_finer: false,
    }
}

/// The factor by which a layer is enlarged for its border.
fn border(resolution: u32) -> f32 {
    let resolution = resolution as f32;
    resolution / (resolution - 2.0 * BORDER_TEXELS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumivox::CascadeOptions;

    const BOUNDS: Bounds =
        Bounds { min: Vec3::new(-3.0, 0.0, -2.0), max: Vec3::new(5.0, 4.0, 1.0) };

    fn point(position: Vec3) -> Light {
        let source =
            LightSource::Point { position, intensity: Vec3::ONE, radius_m: 0.0, range_m: None };
        Light { source, shadow: Shadow::Cone }
    }

    fn project(layer: &ShadowLayer, position: Vec3) -> Vec3 {
        layer.clip_from_world.project_point3(position)
    }

    #[test]
    fn the_suns_layer_covers_the_scene_with_reversed_depth() {
        let direction = Vec3::new(0.3, -1.0, 0.2).normalize();
        let layer = parallel_layer(direction, BOUNDS, 256);
        for corner in corners(BOUNDS) {
            let ndc = project(&layer, corner);
            assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0, "{corner}: {ndc}");
            assert!(ndc.z > 0.0 && ndc.z < 1.0, "{corner}: {ndc}");
            assert!(project(&layer, corner + direction).z < ndc.z);
        }
    }

    #[test]
    fn each_point_light_face_covers_its_own_direction() {
        let position = Vec3::new(1.0, 2.0, -0.5);
        let layers = layers_of(&point(position).source, BOUNDS, 256);
        assert_eq!(layers.len(), 6);
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        for (layer, axis) in layers.iter().zip(axes) {
            let side = axis.any_orthonormal_vector();
            // At the seam of two faces the position is still within the border.
            for at in [axis, axis + 0.99 * side, axis - side] {
                let ndc = project(layer, position + 3.0 * at);
                assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0, "{axis}: {ndc}");
                assert!(ndc.z > 0.0 && ndc.z < 1.0);
            }
            let behind = layer.clip_from_world * (position - axis).extend(1.0);
            assert!(behind.w < 0.0);
        }
    }

    #[test]
    fn lights_beyond_the_layer_budget_use_cone_shadows() {
        let mut lights: Vec<Light> = (0..12).map(|i| point(Vec3::splat(i as f32))).collect();
        let layers = assign_layers(&mut lights, BOUNDS, &[], 1024);
        assert_eq!(layers.len(), 60);
        assert_eq!(lights[9].shadow, Shadow::Map { first_layer: 54 });
        assert_eq!(lights[10].shadow, Shadow::Cone);
        // 256 MiB are four layers of 4096², too few for a point light.
        assert!(assign_layers(&mut lights, BOUNDS, &[], 4096).is_empty());
    }

    #[test]
    fn suns_get_finer_layers_around_small_cascades() {
        let ground = Bounds { min: Vec3::new(-5e3, 0.0, -5e3), max: Vec3::new(5e3, 10.0, 5e3) };
        let grid =
            Grid::cascades(Vec3::new(40.0, 2.0, -7.0), &CascadeOptions::default(), Vec3::ZERO);
        let boxes = fine_boxes(&grid.expect("cascades"));
        let source = LightSource::Directional {
            direction: Vec3::new(0.4, -0.5, 0.3).normalize(),
            irradiance: Vec3::ONE,
            angular_radius_rad: 0.0,
        };
        let sun = Light { source, shadow: Shadow::Cone };
        let mut lights = vec![sun, point(Vec3::Y)];
        let layers = assign_layers(&mut lights, ground, &boxes, 1024);
        assert_eq!(layers.len(), 5 + 6);
        assert_eq!(lights[1].shadow, Shadow::Map { first_layer: 5 });
        let finer: Vec<bool> = layers.iter().map(|layer| layer.has_finer).collect();
        assert_eq!(finer, [[true; 4].as_slice(), &[false; 7]].concat());
        for (layer, own) in layers[1..5].iter().zip(&boxes) {
            // Less than a quarter of a voxel of the box's cascade.
            assert!(layer.texel_size < 0.25 * own.size().x / 64.0, "{}", layer.texel_size);
            for corner in corners(*own) {
                let ndc = project(layer, corner);
                assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0, "{corner}: {ndc}");
            }
        }
        // In a room the scene's map is fine enough.
        assert_eq!(assign_layers(&mut [sun], BOUNDS, &boxes, 1024).len(), 1);
        // Each light gets its needed layers before any light gets finer ones.
        let mut many = vec![sun; 62];
        assert_eq!(assign_layers(&mut many, ground, &boxes, 1024).len(), 64);
        assert!(many.iter().all(|light| light.shadow != Shadow::Cone));
        // If not all finer layers fit, the smallest are kept.
        let few = assign_layers(&mut [sun; 24], ground, &boxes, 1024);
        assert_eq!(few.len(), 64);
        assert!((few[1].texel_size - layers[4].texel_size).abs() < 1e-6);
        let resolution =
            |lights: &[LightSource]| resolution_with_finer(lights, ground, &boxes, 4096);
        assert_eq!([resolution(&[source]), resolution(&[source; 20])], [2048, 1024]);
        assert_eq!(resolution_with_finer(&[source], BOUNDS, &boxes, 4096), 4096);
    }
}
