//! The memory of vertices and indices, counted before it is allocated.

use std::path::Path;

use glam::{Vec2, Vec3, Vec4};

use crate::{Mesh, SceneError};

/// The most vertices that 32-bit indices can address; the largest index means "none".
const MOST_VERTICES: usize = u32::MAX as usize;

/// The unused part of [`MemoryBudget::geometry_bytes`](super::MemoryBudget::geometry_bytes).
pub(super) struct GeometryBudget<'f> {
    file: &'f Path,
    all: u64,
    spent: u64,
}

impl<'f> GeometryBudget<'f> {
    pub(super) fn new(file: &'f Path, bytes: u64) -> Self {
        Self { file, all: bytes, spent: 0 }
    }

    /// Charges vertices and indices to the budget; `part` names them in the error.
    pub(super) fn spend(
        &mut self,
        part: impl FnOnce() -> String,
        vertices: usize,
        indices: usize,
        colors: bool,
    ) -> Result<(), SceneError> {
        // 32-bit indices cannot address more vertices.
        let more =
            if vertices <= MOST_VERTICES { bytes(vertices, indices, colors) } else { u64::MAX };
        self.take(part, more)
    }

    /// Charges bytes to the budget.
    pub(super) fn take(
        &mut self,
        part: impl FnOnce() -> String,
        bytes: u64,
    ) -> Result<(), SceneError> {
        self.spent = self.spent.saturating_add(bytes);
        self.check(part, 0)
    }

    /// The unspent bytes.
    pub(super) fn left(&self) -> u64 {
        self.all.saturating_sub(self.spent)
    }

    /// Checks that `more` bytes would fit, such as temporary ones.
    pub(super) fn check(&self, part: impl FnOnce() -> String, more: u64) -> Result<(), SceneError> {
        let needed = self.spent.saturating_add(more);
        if needed <= self.all {
            return Ok(());
        }
        Err(SceneError::TooLarge {
            file: self.file.to_owned(),
            part: part(),
            needed: format!("{} or more", size_text(needed)),
            budget: size_text(self.all),
        })
    }
}

impl GeometryBudget<'_> {
    /// Charges the copies of vertices for different normals at their corners: at most one per
    /// corner.
    pub(super) fn spend_split(&mut self, mesh: &Mesh) -> Result<(), SceneError> {
        let more = mesh.indices.len().saturating_sub(mesh.positions.len());
        let part = || format!("mesh \"{}\", its vertices split at edges,", mesh.name);
        self.spend(part, more, 0, !mesh.colors.is_empty())
    }
}

/// Bytes of a [`Mesh`] with one set of texture coordinates.
fn bytes(vertices: usize, indices: usize, colors: bool) -> u64 {
    let vertex = 2 * size_of::<Vec3>()
        + size_of::<Vec2>()
        + size_of::<Vec4>()
        + if colors { size_of::<Vec4>() } else { 0 };
    (vertices as u64)
        .saturating_mul(vertex as u64)
        .saturating_add((indices as u64).saturating_mul(4))
}

/// Formats an amount of memory with a suitable unit.
pub(super) fn size_text(bytes: u64) -> String {
    let bytes = bytes as f64;
    let (value, unit) = match bytes {
        b if b < 1024.0 * 1024.0 => (b / 1024.0, "KiB"),
        b if b < 1024.0 * 1024.0 * 1024.0 => (b / 1024.0 / 1024.0, "MiB"),
        b => (b / 1024.0 / 1024.0 / 1024.0, "GiB"),
    };
    format!("{value:.1} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn geometry_beyond_the_budget_is_refused_with_numbers() {
        let mut budget = GeometryBudget::new(Path::new("scan.ply"), 3 << 20);
        let part = || "the scan".to_owned();
        budget.spend(part, 20_000, 60_000, false).unwrap();
        assert_eq!(budget.spent, 20_000 * 48 + 60_000 * 4);
        budget.check(part, 1 << 20).unwrap();
        let error = budget.spend(part, 30_000, 60_000, true).unwrap_err().to_string();
        assert!(error.contains("scan.ply: with the scan"), "{error}");
        assert!(
            error.contains("3.2 MiB or more") && error.contains("budget is 3.0 MiB"),
            "{error}"
        );
        let mut budget = GeometryBudget::new(Path::new("scan.ply"), u64::MAX - 1);
        assert!(budget.spend(part, MOST_VERTICES + 1, 0, false).is_err());
    }
}
