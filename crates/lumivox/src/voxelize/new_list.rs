//! Allocates lists of voxels.

use super::share::Work;
use crate::GiError;
use crate::gpu::{Buffer, Remedy, counted_buffer};
use crate::volume::Surface;
use crate::voxels::{FaceRecord, NodeRecord, VoxelList, count_bytes, level_first_word};

/// An empty list with the given capacity.
pub(super) fn new_list(
    work: &mut Work<'_, '_>,
    nodes: u64,
    faces: u64,
) -> Result<VoxelList, GiError> {
    let grid = work.grid;
    let words = level_first_word(grid, grid.levels);
    let volume = Remedy::Volume(grid.dimensions.max_element());
    let occupancy = work.memory.buffer("occupancy", words, 4, volume)?;
    let ranks = work.memory.buffer("ranks", words + 1, 4, volume)?;
    list_with_room(work, (occupancy, ranks), nodes, faces)
}

/// The list reallocated with other capacities; its contents are kept.
pub(super) fn resized_list(
    work: &mut Work<'_, '_>,
    list: &VoxelList,
    nodes: u64,
    faces: u64,
) -> Result<VoxelList, GiError> {
    let bits = (list.occupancy.clone(), list.ranks.clone());
    let resized = list_with_room(work, bits, nodes, faces)?;
    let both = |buffer: fn(&VoxelList) -> &Buffer| (buffer(list), buffer(&resized));
    for (from, to) in [
        both(|list| &list.nodes),
        both(|list| &list.first_faces),
        both(|list| &list.faces),
        both(|list| &list.counts),
    ] {
        work.recorder.copy((from, 0), (to, 0), from.size().min(to.size()));
    }
    let (level_starts, face_count) = (list.level_starts.clone(), list.face_count);
    Ok(VoxelList { level_starts, face_count, ..resized })
}

fn list_with_room(
    work: &mut Work<'_, '_>,
    (occupancy, ranks): (Buffer, Buffer),
    nodes: u64,
    faces: u64,
) -> Result<VoxelList, GiError> {
    let (remedy, levels) = (work.remedy(), work.grid.levels);
    let memory = &mut work.memory;
    let nodes = nodes.max(1);
    Surface::check(*memory, work.grid, (nodes, faces), remedy)?;
    Ok(VoxelList {
        level_starts: vec![0; levels as usize + 1],
        face_count: 0,
        occupancy,
        ranks,
        nodes: memory.buffer("nodes", nodes, size_of::<NodeRecord>() as u64, remedy)?,
        // There are fewer voxels than nodes.
        first_faces: memory.buffer("first faces", nodes, 4, remedy)?,
        faces: memory.buffer("faces", faces.max(1), size_of::<FaceRecord>() as u64, remedy)?,
        counts: counted_buffer(memory.device(), "counts of voxels", count_bytes(levels)),
    })
}
