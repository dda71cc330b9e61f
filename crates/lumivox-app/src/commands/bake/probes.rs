//! A volume of ambient cubes (Mitchell 2006, "Shading in Valve's Source Engine"), as Bevy samples it.
//!
//! A probe holds six colours: what a white matt surface shows that faces +x, -x, +y, -y, +z and -z, in cd/m² (irradiance
//! over pi). A surface with the normal *n* takes the three that it faces, weighted by the squares of *n*. The texture is
//! *(Rx, 2 Ry, 3 Rz)* texels: along z follow the axes x, y and z; along y the positive side, and behind it the negative one
//! (`irradiance_volume_light` of Bevy's `irradiance_volume.wesl`).

use glam::{UVec3, Vec3};
use lumivox::Irradiance;
use lumivox_render::{RenderError, Renderer};

/// The most texels along an edge of a 3D texture that every device has.
const MOST_TEXELS: u32 = 2048;
/// The least open share of the sphere, as the sum over six hemispheres, of a probe in the open.
const LEAST_OPENNESS: f32 = 0.05;
/// The directions of a cube's sides, and their places in the texture: which third along z, which half along y.
const SIDES: [(Vec3, [u32; 2]); 6] = [
    (Vec3::X, [0, 0]),
    (Vec3::NEG_X, [0, 1]),
    (Vec3::Y, [1, 0]),
    (Vec3::NEG_Y, [1, 1]),
    (Vec3::Z, [2, 0]),
    (Vec3::NEG_Z, [2, 1]),
];

/// The light at a probe, by side; `None` in walls, where there is none.
pub type Cube = Option<[Vec3; 6]>;

/// A regular volume of probes, in the middles of its cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probes {
    pub min: Vec3,
    pub max: Vec3,
    pub count: UVec3,
}

impl Probes {
    /// Probes in a box, at most this far from each other.
    ///
    /// # Errors
    /// A sentence, when a texture of so many is too large.
    pub fn fit(min: Vec3, max: Vec3, spacing_m: f32) -> Result<Self, String> {
        let count = ((max - min) / spacing_m).ceil().max(Vec3::ONE);
        let texels = count * Vec3::new(1.0, 2.0, 3.0);
        if texels.max_element() > MOST_TEXELS as f32 {
            let needed = ((max - min) * Vec3::new(1.0, 2.0, 3.0)).max_element() / MOST_TEXELS as f32;
            return Err(format!(
                "--spacing {spacing_m}: the volume would be {} x {} x {} texels, more than {MOST_TEXELS} along an edge; \
                 give at least {needed:.3}",
                texels.x, texels.y, texels.z
            ));
        }
        Ok(Self { min, max, count: count.as_uvec3() })
    }

    /// Width, height and depth of the texture.
    pub fn texture_size(&self) -> UVec3 {
        self.count * UVec3::new(1, 2, 3)
    }

    /// The probes' places, x fastest.
    fn positions(&self) -> impl Iterator<Item = Vec3> {
        let Self { min, max, count } = *self;
        let cell = (max - min) / count.as_vec3();
        (0..count.element_product()).map(move |index| {
            let place = UVec3::new(
                index % count.x,
                index / count.x % count.y,
                index / (count.x * count.y),
            );
            min + (place.as_vec3() + 0.5) * cell
        })
    }

    /// Gathers the light at all probes.
    ///
    /// # Errors
    /// As [`Renderer::irradiance`].
    pub async fn gather(&self, renderer: &Renderer, frames: u32) -> Result<Vec<Cube>, RenderError> {
        let count = self.count.element_product() as usize;
        let points: Vec<Vec3> = self.positions().flat_map(|place| [place; 6]).collect();
        let normals = SIDES.map(|(normal, _)| normal).repeat(count);
        let lux = renderer.irradiance(&points, &normals, frames).await?;
        Ok(lux.chunks_exact(6).map(cube).collect())
    }

    /// The texels of the texture, x fastest; probes in walls get the light of those around them, so that filtering does not
    /// darken surfaces. Their number is returned as well.
    pub fn texels(&self, cubes: &[Cube]) -> (Vec<Vec3>, usize) {
        let filled = self.fill(cubes.to_vec());
        let size = self.texture_size();
        let mut texels = vec![Vec3::ZERO; size.element_product() as usize];
        for (index, cube) in filled.iter().enumerate() {
            let (x, rest) = (index as u32 % self.count.x, index as u32 / self.count.x);
            let (y, z) = (rest % self.count.y, rest / self.count.y);
            for (side, (_, [third, half])) in SIDES.iter().enumerate() {
                let [t, p] = [y + half * self.count.y, z + third * self.count.z];
                texels[(x + size.x * (t + size.y * p)) as usize] = cube[side];
            }
        }
        (texels, cubes.iter().filter(|cube| cube.is_none()).count())
    }

    /// Spreads light into walls, a probe further in each round.
    fn fill(&self, mut cubes: Vec<Cube>) -> Vec<[Vec3; 6]> {
        loop {
            let known = cubes.clone();
            let mut has_filled = false;
            for index in 0..cubes.len() {
                if known[index].is_some() {
                    continue;
                }
                let around: Vec<[Vec3; 6]> =
                    self.neighbours(index).filter_map(|other| known[other]).collect();
                if !around.is_empty() {
                    let mean = |side: usize| around.iter().map(|cube| cube[side]).sum::<Vec3>();
                    let mean = std::array::from_fn(|side| mean(side) / around.len() as f32);
                    cubes[index] = Some(mean);
                    has_filled = true;
                }
            }
            if !has_filled {
                // Nothing is open at all, or everything is known.
                return cubes.into_iter().map(|cube| cube.unwrap_or([Vec3::ZERO; 6])).collect();
            }
        }
    }

    /// The probes beside one, up to six.
    fn neighbours(&self, index: usize) -> impl Iterator<Item = usize> {
        let steps = [1, self.count.x, self.count.x * self.count.y].map(|step| step as usize);
        let place = [
            index as u32 % self.count.x,
            index as u32 / self.count.x % self.count.y,
            index as u32 / (self.count.x * self.count.y),
        ];
        let count = self.count.to_array();
        (0..3).flat_map(move |axis| {
            let before = (place[axis] > 0).then(|| index - steps[axis]);
            let behind = (place[axis] + 1 < count[axis]).then(|| index + steps[axis]);
            before.into_iter().chain(behind)
        })
    }
}

/// Six sides' light in cd/m², if the probe is in the open.
fn cube(sides: &[Irradiance]) -> Cube {
    let openness: f32 = sides.iter().map(|side| side.openness).sum();
    let is_dark = sides.iter().all(|side| side.indirect.max_element() <= 0.0);
    if openness < LEAST_OPENNESS && is_dark {
        return None;
    }
    Some(std::array::from_fn(|side| sides[side].indirect / std::f32::consts::PI))
}

/// Mean luminance (Rec. 709).
pub fn mean_luminance(texels: &[Vec3]) -> f32 {
    let sum: Vec3 = texels.iter().sum();
    sum.dot(Vec3::new(0.2126, 0.7152, 0.0722)) / texels.len().max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROBES: Probes = Probes { min: Vec3::ZERO, max: Vec3::new(4.0, 2.0, 3.0), count: UVec3::new(4, 2, 3) };

    #[test]
    fn a_box_is_filled_at_the_spacing() {
        let fitted = Probes::fit(Vec3::ZERO, Vec3::new(4.0, 2.0, 2.9), 1.0).unwrap();
        assert_eq!((fitted.count, fitted.texture_size()), (UVec3::new(4, 2, 3), UVec3::new(4, 4, 9)));
        let places: Vec<Vec3> = PROBES.positions().collect();
        assert_eq!((places[0], places[1]), (Vec3::splat(0.5), Vec3::new(1.5, 0.5, 0.5)));
        assert_eq!(places.last(), Some(&Vec3::new(3.5, 1.5, 2.5)));
        let error = Probes::fit(Vec3::ZERO, Vec3::splat(1000.0), 1.0).unwrap_err();
        assert!(error.contains("give at least 1.465"), "{error}");
    }

    #[test]
    fn sides_stand_where_bevy_looks_for_them() {
        // Each side of each probe is its own colour.
        let of = |probe: usize| std::array::from_fn(|side| Vec3::new(probe as f32, side as f32, 1.0));
        let cubes: Vec<Cube> = (0..24).map(|probe| Some(of(probe))).collect();
        let (texels, in_walls) = PROBES.texels(&cubes);
        assert_eq!(in_walls, 0);
        let size = PROBES.texture_size();
        // The shader's own way: a third of the depth for each axis, half of the height for negative normals.
        for (side, normal) in SIDES.iter().map(|(normal, _)| *normal).enumerate() {
            let axis = normal.abs().max_position() as u32;
            let half = u32::from(normal.min_element() < 0.0);
            let (x, y, z) = (3, 1, 2);
            let texel = UVec3::new(x, y + half * 2, z + axis * 3);
            let found = texels[(texel.x + size.x * (texel.y + size.y * texel.z)) as usize];
            assert_eq!(found, Vec3::new(23.0, side as f32, 1.0), "{normal}");
        }
    }

    #[test]
    fn walls_get_the_light_around_them() {
        let lit = Some([Vec3::splat(2.0); 6]);
        let mut cubes: Vec<Cube> = vec![None; 24];
        cubes[0] = lit;
        let (texels, in_walls) = PROBES.texels(&cubes);
        assert_eq!(in_walls, 23);
        assert!(texels.iter().all(|texel| *texel == Vec3::splat(2.0)));
        let (dark, _) = PROBES.texels(&[None; 24]);
        assert!(dark.iter().all(|texel| *texel == Vec3::ZERO));
    }
}
