//! The transforms of a scene's draws in the last frame.

use std::collections::BTreeMap;

use glam::Mat4;
use lumivox::gpu::Buffer;

use super::{SceneDraw, VertexBuffers};

/// The draws that have moved since the last frame.
#[derive(Debug, Default)]
pub(crate) struct Motion {
    /// The former transforms of draws, keyed by record.
    transforms: BTreeMap<u32, Mat4>,
    /// The former positions of vertices, keyed by batch.
    positions: BTreeMap<usize, Buffer>,
    /// The former positions that the last frame used; its submission may be pending.
    drawn: BTreeMap<usize, Buffer>,
    /// Whether the next frame needs motion.
    is_wanted: bool,
}

impl Motion {
    /// The draws that have moved, and their former transforms.
    pub(crate) fn moved(&self) -> impl Iterator<Item = (u32, Mat4)> {
        self.transforms.iter().map(|(record, transform)| (*record, *transform))
    }

    /// The former positions of a batch; `None` if they have not changed.
    pub(crate) fn positions(&self, batch: usize) -> Option<&Buffer> {
        self.positions.get(&batch)
    }

    /// Records the transform of a draw before it moves.
    pub(super) fn leave(&mut self, record: u32, world_from_local: Mat4) {
        if !self.is_wanted {
            return;
        }
        self.transforms.entry(record).or_insert(world_from_local);
    }

    /// The position buffers to compare with after the next upload; empty unless motion is needed.
    pub(super) fn keep(&self, batches: &[VertexBuffers]) -> Vec<Buffer> {
        let wanted = batches.iter().filter(|_| self.is_wanted);
        wanted.map(|batch| batch.positions.clone()).collect()
    }

    /// Records the differences between two uploads of a scene. If their draws or batches differ,
    /// nothing counts as moved.
    pub(super) fn compare(
        &mut self,
        before: (&[SceneDraw], &[Buffer]),
        now: (&[SceneDraw], &[VertexBuffers]),
    ) {
        let is_same = before.0.len() == now.0.len()
            && before.1.len() == now.1.len()
            && before.0.iter().zip(now.0).all(|(a, b)| a.is_same(b));
        if !is_same {
            self.clear();
            return;
        }
        for (batch, (positions, buffers)) in before.1.iter().zip(now.1).enumerate() {
            let is_as_long = positions.size() == buffers.positions.size();
            if is_as_long && *positions != buffers.positions {
                self.positions.entry(batch).or_insert_with(|| positions.clone());
            }
        }
        for (before, now) in before.0.iter().zip(now.0) {
            let has_moved = before.world_from_local != now.world_from_local;
            if has_moved || self.positions.contains_key(&now.batch) {
                self.leave(now.record, before.world_from_local);
            }
        }
    }

    /// Clears the moves after a frame is drawn; `is_wanted` if the next frame needs motion.
    pub(crate) fn settle(&mut self, is_wanted: bool) {
        self.is_wanted = is_wanted;
        self.drawn = std::mem::take(&mut self.positions);
        self.clear();
    }

    fn clear(&mut self) {
        self.transforms.clear();
        self.positions.clear();
    }
}
