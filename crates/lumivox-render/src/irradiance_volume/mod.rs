//! Irradiance volumes: light at a grid of probes in the air, baked for renderers without global
//! illumination of their own.
//!
//! A probe stores the light from six directions, an ambient cube (Mitchell 2006, "Shading in
//! Valve's Source Engine", slides 27 and 28). The light on a surface is the sum of the three
//! directions that it faces, weighted by the squares of its normal's components. Bevy 0.20 reads
//! such volumes.
//!
//! | file | is |
//! | --- | --- |
//! | `buried.rs` | finds probes inside solid objects, where there is no light |
//! | `file.rs` | the volume as a KTX2 file |

mod buried;
mod file;
#[cfg(test)]
mod tests;

use glam::{UVec3, Vec3};

pub use buried::buried;

/// The directions of a probe's values, in their order.
pub const DIRECTIONS: [Vec3; 6] =
    [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

/// A grid of probes at the centres of equal cells of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeGrid {
    /// The box's minimum corner, m.
    pub min: Vec3,
    /// The box's size, m, above 0.
    pub size: Vec3,
    /// Cells along each axis, at least 1.
    pub cells: UVec3,
}

impl ProbeGrid {
    /// A grid over a box, with cells whose edges are about `spacing` long, m.
    pub fn over(min: Vec3, max: Vec3, spacing: f32) -> Self {
        let size = max - min;
        Self { min, size, cells: (size / spacing).round().max(Vec3::ONE).as_uvec3() }
    }

    /// The centre of the box, m.
    pub fn center(&self) -> Vec3 {
        self.min + self.size / 2.0
    }

    /// The number of probes.
    pub fn count(&self) -> usize {
        self.cells.to_array().map(|cells| cells as usize).iter().product()
    }

    /// The positions of the probes, m: x varies fastest, then y, then z.
    pub fn probes(&self) -> Vec<Vec3> {
        let cell = self.size / self.cells.as_vec3();
        self.numbers().map(|number| self.min + (number.as_vec3() + 0.5) * cell).collect()
    }

    /// The grid coordinates of each probe, in the order of [`Self::probes`].
    fn numbers(&self) -> impl Iterator<Item = UVec3> + use<> {
        let UVec3 { x, y, z } = self.cells;
        (0..z).flat_map(move |z| (0..y).flat_map(move |y| (0..x).map(move |x| UVec3::new(x, y, z))))
    }

    fn index(&self, UVec3 { x, y, z }: UVec3) -> usize {
        let UVec3 { x: width, y: height, .. } = self.cells;
        (z as usize * height as usize + y as usize) * width as usize + x as usize
    }

    /// The indices of the probes next to one.
    fn beside(&self, at: UVec3) -> impl Iterator<Item = usize> + use<'_> {
        DIRECTIONS.into_iter().filter_map(move |direction| {
            let next = (at.as_ivec3() + direction.as_ivec3()).as_uvec3();
            (next.cmplt(self.cells).all()).then(|| self.index(next))
        })
    }
}

/// A grid of probes and their light.
#[derive(Clone, Debug, PartialEq)]
pub struct IrradianceVolume {
    grid: ProbeGrid,
    light: Vec<[Vec3; 6]>,
}

impl IrradianceVolume {
    /// A volume from the irradiance at a grid's probes, lux in linear RGB, towards [`DIRECTIONS`].
    /// A probe that is [`buried`] gets the light of its neighbours, so that it does not darken
    /// surfaces nearby. If all probes are buried, all are black.
    ///
    /// # Panics
    /// If the number of values differs from the number of probes.
    pub fn new(grid: ProbeGrid, irradiance: &[[Vec3; 6]], buried: &[bool]) -> Self {
        assert!(
            irradiance.len() == grid.count() && buried.len() == grid.count(),
            "one value for each probe"
        );
        // The luminance of a white Lambertian surface in this light, cd/m².
        let mut light: Vec<[Vec3; 6]> =
            irradiance.iter().map(|sides| sides.map(|lux| lux / std::f32::consts::PI)).collect();
        let mut known: Vec<bool> = buried.iter().map(|is_buried| !is_buried).collect();
        // Each pass fills one more layer of probes, from the air into the solid.
        while known.contains(&true) && known.contains(&false) {
            let before = known.clone();
            for (index, at) in grid.numbers().enumerate() {
                let near: Vec<usize> = grid.beside(at).filter(|&near| before[near]).collect();
                if before[index] || near.is_empty() {
                    continue;
                }
                let mean = |side: usize| {
                    near.iter().map(|&near| light[near][side]).sum::<Vec3>() / near.len() as f32
                };
                light[index] = std::array::from_fn(mean);
                known[index] = true;
            }
        }
        if !known.contains(&true) {
            light.fill([Vec3::ZERO; 6]);
        }
        Self { grid, light }
    }

    /// Grid of the probes.
    pub fn grid(&self) -> ProbeGrid {
        self.grid
    }

    /// The light of each probe towards [`DIRECTIONS`], in the order of [`ProbeGrid::probes`]:
    /// irradiance divided by pi, cd/m² in linear RGB.
    pub fn light(&self) -> &[[Vec3; 6]] {
        &self.light
    }
}
