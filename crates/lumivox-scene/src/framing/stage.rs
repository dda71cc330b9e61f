//! Light for scenes that have too little, and the ground below them.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::light::{Emission, Standpoint};
use super::rays::Unit;
use super::sight::three_digits;
use super::{Framing, OPENING, lights, outside};
use crate::sky::{Sky, SkySettings, sky};
use crate::studio::Studio;
use crate::{Camera, Environment, EnvironmentMap, Instance, Light, Material, Mesh, Scene};

/// The radius of a ground, in sizes of the scene: its edge is within two degrees of the horizon for
/// a camera that shows all of the scene.
const REACH: f32 = 30.0;
/// The smallest factor of a studio's light, which then gives a tenth of a lux.
const DIMMEST: f32 = 1e-4;
/// The depth of a ground below the scene, as a share of the scene's size: flat parts of the scene
/// must not be coplanar with it.
const BELOW: f32 = 1e-3;
/// The margin around the scene, as a share of its size, within which the ground is voxelized, if
/// the grid reaches that far.
const AROUND: f32 = 0.1;
/// Corners of the ground's edge.
const EDGE: usize = 48;
/// Rays that search for a ground, along each side of the scene.
const PLUMBS: usize = 16;
/// The least share of its bounds that a landscape covers, seen from above.
const COVERED: f32 = 0.8;
/// The height of a landscape, as a share of its width.
const RELIEF: std::ops::RangeInclusive<f32> = 0.01..=0.6;

/// Light for a scene that has too little of its own, in physical units.
#[derive(Clone, Debug, PartialEq)]
pub enum DefaultLight {
    /// The sun and the [sky](crate::sky) of a clear day. In a place the sun is where it lights most
    /// of the inside, otherwise to the left of the camera, 50 degrees high.
    SunAndSky {
        /// The sun.
        sun: Light,
        /// The sky, in cd/m².
        sky: Arc<EnvironmentMap>,
        /// The ground below a thing; places have their own.
        ground: Option<Ground>,
    },
    /// A photographer's [studio](crate::studio).
    Studio {
        /// The surroundings, in cd/m².
        studio: Arc<Studio>,
        /// Factor on its luminances: 1, or less if the scene emits little, so that its glow is
        /// visible.
        dimmed: f32,
        /// Its rotation about the vertical, rad: the main light is to the left of the camera.
        rotation_rad: f32,
        /// The ground below the thing.
        ground: Ground,
    },
    /// A lamp below the ceiling of each closed room, at most eight: each gives the surfaces that it
    /// reaches 300 lux on average, whatever the room's size.
    Lamps(Vec<Light>),
}

/// A level, matt ground, a backdrop ([`Instance::is_backdrop`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Its middle, m.
    pub center: Vec3,
    /// Its radius, m.
    pub radius_m: f32,
    /// Half the edges (along x and z) of its part in the voxels, m.
    pub half_m: Vec2,
    /// Its surface.
    pub material: Material,
}

impl std::fmt::Display for DefaultLight {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::SunAndSky { .. } => write!(f, "the sun and the sky of a clear day"),
            Self::Studio { studio, dimmed, .. } => {
                write!(f, "a studio of {} lux", three_digits(studio.ground_lux * dimmed))?;
                if *dimmed < 1.0 { write!(f, ", so dim that it is seen to glow") } else { Ok(()) }
            }
            Self::Lamps(lamps) if lamps.len() == 1 => write!(f, "a lamp of 300 lux"),
            Self::Lamps(lamps) => write!(f, "{} lamps of 300 lux", lamps.len()),
        }
    }
}

impl DefaultLight {
    /// Adds the light to a scene. Existing lights stay; surroundings are replaced.
    pub fn light_up(&self, scene: &mut Scene) {
        scene.lights.extend_from_slice(self.lights());
        match self {
            Self::SunAndSky { sun: _, sky, ground } => {
                let map = Some(Arc::clone(sky));
                scene.environment = Environment { radiance: Vec3::ONE, map, rotation_rad: 0.0 };
                if let Some(ground) = ground {
                    ground.put_into(scene);
                }
            }
            Self::Studio { studio, dimmed, rotation_rad, ground } => {
                let (map, rotation_rad) = (Some(Arc::new(studio.map.clone())), *rotation_rad);
                let radiance = Vec3::splat(*dimmed);
                scene.environment = Environment { radiance, map, rotation_rad };
                ground.put_into(scene);
            }
            Self::Lamps(_) => {}
        }
    }

    /// The added lamps or sun. They follow the scene's own lights, to which a rig refers by index.
    pub(super) fn lights(&self) -> &[Light] {
        match self {
            Self::SunAndSky { sun, .. } => std::slice::from_ref(sun),
            Self::Studio { .. } => &[],
            Self::Lamps(lamps) => lamps,
        }
    }
}

impl Ground {
    fn of(unit: Unit, material: Material) -> Self {
        let half = unit.half;
        let center = unit.world_from_unit(Vec3::new(0.0, -half.y - BELOW, 0.0));
        let half_m = (Vec2::new(half.x, half.z) + AROUND) * unit.scale_m;
        Self { center, radius_m: REACH * unit.scale_m, half_m, material }
    }

    /// Adds two instances: the voxelized part near the scene, and, slightly lower, the whole
    /// ground, which is not voxelized.
    fn put_into(&self, scene: &mut Scene) {
        let name = &self.material.name;
        let far =
            Self { center: self.center - Vec3::Y * (self.radius_m * BELOW * 1e-2), ..self.clone() };
        scene.materials.push(self.material.clone());
        for (mesh, is_voxelized) in [(self.near_piece(), true), (far.whole(), false)] {
            scene.meshes.push(Mesh { name: name.clone(), ..mesh });
            scene.instances.push(Instance {
                name: name.clone(),
                mesh: scene.meshes.len() - 1,
                material: scene.materials.len() - 1,
                is_voxelized,
                is_backdrop: true,
                ..Instance::default()
            });
        }
    }

    fn near_piece(&self) -> Mesh {
        let Vec2 { x, y: z } = self.half_m;
        self.fan([(x, z), (x, -z), (-x, -z), (-x, z)].map(Vec2::from).into_iter())
    }

    fn whole(&self) -> Mesh {
        let corner = |number: usize| {
            let (sin, cos) = (number as f32 / EDGE as f32 * TAU).sin_cos();
            Vec2::new(cos, -sin) * self.radius_m
        };
        self.fan((0..EDGE).map(corner))
    }

    /// A fan of corners around the middle, counter-clockwise seen from above.
    fn fan(&self, corners: impl ExactSizeIterator<Item = Vec2>) -> Mesh {
        let count = corners.len() as u32;
        let mut mesh = Mesh::default();
        mesh.positions.push(self.center);
        mesh.positions.extend(corners.map(|at| self.center + Vec3::new(at.x, 0.0, at.y)));
        for number in 0..count {
            mesh.indices.extend([0, 1 + number, 1 + (number + 1) % count]);
        }
        let vertices = mesh.positions.len();
        mesh.normals = vec![Vec3::Y; vertices];
        mesh.uvs = vec![Vec2::ZERO; vertices];
        mesh.tangents = vec![Vec3::X.extend(1.0); vertices];
        mesh
    }
}

/// Texels of the sky around the horizon. Tests use a coarse sky, since they only check the sun.
fn sky_width() -> u32 {
    if cfg!(test) { 32 } else { SkySettings::default().width }
}

impl Framing {
    /// Light for the view of `camera`, as if the scene had none: lamps in a closed room, sun and
    /// sky in other places and over landscapes, otherwise a studio.
    pub(super) fn light(&self, camera: &Camera, emission: &Emission) -> DefaultLight {
        if self.standpoint(camera) == Standpoint::ClosedRoom {
            let lamps = lights::lamps(&self.rays, &self.survey.interior);
            if !lamps.is_empty() {
                return DefaultLight::Lamps(lamps);
            }
        }
        let eye = self.rays.unit.unit_from_world(camera.position);
        let is_day = if self.is_place() {
            outside::share(&self.rays, &self.survey.patches, eye) < OPENING
                || self.surrounds(camera)
        } else {
            self.is_landscape()
        };
        if is_day { self.day(camera) } else { self.studio(camera, emission) }
    }

    /// Sun and sky, with a ground below a thing.
    pub(super) fn day(&self, camera: &Camera) -> DefaultLight {
        let eye = self.rays.unit.unit_from_world(camera.position);
        let patches = &self.survey.patches;
        let sun_direction = lights::towards_sun(&self.rays, patches, eye, camera.forward);
        let settings = SkySettings { sun_direction, width: sky_width(), ..SkySettings::default() };
        let Ok(Sky { map, sun: Some(sun) }) = sky(&settings) else {
            unreachable!("a sun above the horizon has a sky")
        };
        let sun = Light { name: "default sun".to_owned(), ..sun };
        let ground = Material::diffuse("ground", Vec3::splat(settings.ground_albedo));
        let ground = (!self.is_place()).then(|| Ground::of(self.rays.unit, ground));
        DefaultLight::SunAndSky { sun, sky: Arc::new(map), ground }
    }

    /// A studio. If something emits, a white surface on the ground is at most as bright: most files
    /// give lamps 1 cd/m², which would not visibly glow beside bright walls.
    pub(super) fn studio(&self, camera: &Camera, emission: &Emission) -> DefaultLight {
        let studio = Studio::new();
        let white = studio.ground_lux / std::f32::consts::PI;
        let is_dimmed = emission.luminance > 0.0;
        let dimmed = if is_dimmed { (emission.luminance / white).clamp(DIMMEST, 1.0) } else { 1.0 };
        let ground = Ground::of(self.rays.unit, studio.ground());
        let rotation_rad = f32::atan2(-camera.forward.x, -camera.forward.z);
        DefaultLight::Studio { studio: Arc::new(studio), dimmed, rotation_rad, ground }
    }

    /// Whether the scene is a landscape: a sheet that covers its bounds seen from above, not quite
    /// flat, whose back is visible from below.
    fn is_landscape(&self) -> bool {
        let half = self.rays.unit.half;
        if !RELIEF.contains(&(half.y / half.x.max(half.z))) {
            return false;
        }
        let (mut covered, mut backs) = (0, 0);
        for number in 0..PLUMBS * PLUMBS {
            let at = |step: usize| (step as f32 + 0.5) / PLUMBS as f32 * 2.0 - 1.0;
            let (x, z) = (at(number % PLUMBS) * half.x, at(number / PLUMBS) * half.z);
            let from = |height: f32, way: Vec3| self.rays.cast(Vec3::new(x, height, z), way);
            covered += usize::from(from(1.0, Vec3::NEG_Y).is_some());
            backs += usize::from(from(-1.0, Vec3::Y).is_some_and(|hit| !hit.is_front));
        }
        let least = COVERED * (PLUMBS * PLUMBS) as f32;
        covered as f32 >= least && backs as f32 >= least
    }
}
