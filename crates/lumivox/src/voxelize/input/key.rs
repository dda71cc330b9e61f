//! Detects whether static surface has changed since it was voxelized, and where.

use std::collections::{BTreeSet, HashMap};

use glam::Vec3;

use super::emission_scale;
use crate::geometry::{Draw, GeometryBatch};
use crate::{Geometry, Grid, SurfaceMaterial};

/// All input of the static share except the contents of buffers: equal keys give equal shares if
/// these contents have not changed. It stores the caller's input rather than values computed from
/// it, so that unchanged input only has to be compared.
#[derive(Clone, Debug)]
pub(crate) struct ShareKey {
    grid: Grid,
    /// The batches, with only the static draws that have triangles.
    batches: Vec<GeometryBatch>,
    /// The materials of these draws, with their numbers.
    materials: Vec<(u32, SurfaceMaterial)>,
    emission_scale: f32,
}

/// The static draws of a batch that have triangles.
fn static_draws(batch: &GeometryBatch) -> impl Iterator<Item = &Draw> {
    batch.draws.iter().filter(|draw| draw.is_static && draw.index_count > 0)
}

/// Adds the draws that are in only one of two lists.
fn differences<'a>(
    before: &[Draw],
    after: impl IntoIterator<Item = &'a Draw>,
    into: &mut Vec<Draw>,
) {
    let mut known: HashMap<_, Vec<&Draw>> = HashMap::new();
    for draw in before {
        known.entry(draw.bits()).or_default().push(draw);
    }
    for draw in after {
        if known.get_mut(&draw.bits()).and_then(Vec::pop).is_none() {
            into.push(*draw);
        }
    }
    into.extend(known.into_values().flatten());
}

impl ShareKey {
    /// `true` if there are static draws.
    pub(crate) fn is_needed(geometry: &Geometry) -> bool {
        geometry.batches.iter().any(|batch| static_draws(batch).next().is_some())
    }

    /// The key of the static draws.
    pub(crate) fn new(geometry: &Geometry, grid: &Grid) -> Self {
        let key = |batch: &GeometryBatch| {
            let draws = static_draws(batch).copied().collect();
            // Cloning the batch would copy all draws, which may be many.
            let (positions, indices) = (batch.positions.clone(), batch.indices.clone());
            GeometryBatch { positions, attributes: batch.attributes.clone(), indices, draws }
        };
        let mut batches: Vec<GeometryBatch> = geometry.batches.iter().map(key).collect();
        batches.retain(|batch| !batch.draws.is_empty());
        let used: BTreeSet<u32> =
            batches.iter().flat_map(|batch| &batch.draws).map(|draw| draw.material).collect();
        let materials = used
            .into_iter()
            .filter_map(|number| Some((number, geometry.materials.get(number as usize)?.clone())));
        Self {
            grid: *grid,
            batches,
            materials: materials.collect(),
            emission_scale: emission_scale(geometry),
        }
    }

    /// Whether surface with this key can be shown until the surface of `geometry` is ready: both
    /// must have the same grid and scale of emission.
    pub(crate) fn suits(&self, geometry: &Geometry, grid: &Grid) -> bool {
        self.grid == *grid && self.emission_scale.to_bits() == emission_scale(geometry).to_bits()
    }

    /// Boxes in the world, m, around the static draws that were added or removed since: surface
    /// outside of them has not changed. `None` if everything has to be voxelized again, because
    /// materials or the scale of emission have changed, or draws have no bounds.
    pub(crate) fn changes(&self, geometry: &Geometry) -> Option<Vec<[Vec3; 2]>> {
        let is_known = |(number, material): &(u32, SurfaceMaterial)| {
            geometry.materials.get(*number as usize) == Some(material)
        };
        if self.emission_scale.to_bits() != emission_scale(geometry).to_bits()
            || !self.materials.iter().all(is_known)
        {
            return None;
        }
        let mut changed = Vec::new();
        let mut left: Vec<&GeometryBatch> = self.batches.iter().collect();
        for batch in &geometry.batches {
            let own = left.iter().position(|own| own.is_same_but_draws(batch));
            let before = own.map(|own| left.swap_remove(own).draws.as_slice()).unwrap_or_default();
            differences(before, static_draws(batch), &mut changed);
        }
        for batch in left {
            differences(&batch.draws, [], &mut changed);
        }
        changed.iter().map(Draw::bounds_in_world).collect()
    }

    /// `true` if it is the key of the static draws of `geometry`.
    pub(crate) fn is_of(&self, geometry: &Geometry, grid: &Grid) -> bool {
        let mut known = self.batches.iter();
        let is_same_batch = |batch: &GeometryBatch| {
            let mut draws = static_draws(batch).peekable();
            draws.peek().is_none()
                || known
                    .next()
                    .is_some_and(|key| key.is_same_but_draws(batch) && draws.eq(&key.draws))
        };
        self.suits(geometry, grid)
            && geometry.batches.iter().all(is_same_batch)
            && known.next().is_none()
            && self.materials.iter().all(|(number, material)| {
                geometry.materials.get(*number as usize) == Some(material)
            })
    }
}
