//! What static surface was made of: whether it is what it was, and else where it has changed.

use std::collections::{BTreeSet, HashMap};

use glam::Vec3;

use super::emission_scale;
use crate::geometry::{Draw, GeometryBatch};
use crate::{Geometry, Grid, SurfaceMaterial};

/// All that the static share was made of but what stands in its buffers: equal keys give equal shares, if those are as they
/// were. It holds what the caller gave, and not what is made of it, so that what has not changed is only compared.
#[derive(Clone, Debug)]
pub(crate) struct ShareKey {
    /// The name of the voxelization.
    method: &'static str,
    grid: Grid,
    /// With the static draws that have triangles.
    batches: Vec<GeometryBatch>,
    /// Those that the draws have, with their numbers.
    materials: Vec<(u32, SurfaceMaterial)>,
    emission_scale: f32,
}

/// The static draws of a batch that have triangles.
fn static_draws(batch: &GeometryBatch) -> impl Iterator<Item = &Draw> {
    batch.draws.iter().filter(|draw| draw.is_static && draw.index_count > 0)
}

/// Adds the draws that are in one of two lists alone.
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
    /// Whether there are static draws at all.
    pub(crate) fn is_needed(geometry: &Geometry) -> bool {
        geometry.batches.iter().any(|batch| static_draws(batch).next().is_some())
    }

    /// Of the static draws.
    pub(crate) fn new(method: &'static str, geometry: &Geometry, grid: &Grid) -> Self {
        let key = |batch: &GeometryBatch| {
            let draws = static_draws(batch).copied().collect();
            // Not a copy of all draws, which may be many.
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
            method,
            grid: *grid,
            batches,
            materials: materials.collect(),
            emission_scale: emission_scale(geometry),
        }
    }

    /// Whether it is of that voxelization.
    pub(crate) fn is_by(&self, method: &str) -> bool {
        self.method == method
    }

    /// Whether surface that was made of other draws can stand for these until theirs is there: of the same voxelization, in the
    /// same place and unit of emission.
    pub(crate) fn suits(&self, method: &str, geometry: &Geometry, grid: &Grid) -> bool {
        self.is_by(method)
            && self.grid == *grid
            && self.emission_scale.to_bits() == emission_scale(geometry).to_bits()
    }

    /// Boxes in the world, m, around the static draws that have come or gone since: outside of them surface is what it was. `None`
    /// where all has to be looked at again: other materials, another unit of emission, or draws without bounds.
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

    /// Whether it is that of these static draws.
    pub(crate) fn is_of(&self, method: &str, geometry: &Geometry, grid: &Grid) -> bool {
        let mut known = self.batches.iter();
        let is_same_batch = |batch: &GeometryBatch| {
            let mut draws = static_draws(batch).peekable();
            draws.peek().is_none()
                || known
                    .next()
                    .is_some_and(|key| key.is_same_but_draws(batch) && draws.eq(&key.draws))
        };
        self.suits(method, geometry, grid)
            && geometry.batches.iter().all(is_same_batch)
            && known.next().is_none()
            && self.materials.iter().all(|(number, material)| {
                geometry.materials.get(*number as usize) == Some(material)
            })
    }
}
