//! The nodes of octrees: the expected ones, the existing ones, and scenes that are difficult for
//! their builder.

use std::collections::{BTreeMap, BTreeSet};

use glam::{IVec3, Mat4, UVec3, Vec3};

use lumivox::voxels::NodeRecord;
use lumivox::{Geometry, Gi, Grid};

use super::{SceneBuilder, busy_room, lambert, morton_decode, read};

/// The level and the coordinates of a node.
pub(crate) type NodeAt = (u32, [u32; 3]);

/// The nodes that the definition requires (`tree.wgsl`): those with an occupied cell among their
/// 27, and their ancestors.
pub(crate) fn expected_nodes(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    gi: &Gi,
) -> BTreeSet<NodeAt> {
    let voxels = gi.voxels().expect("there are voxels");
    let grid = gi.grid();
    let count = voxels.level_starts[grid.levels as usize] as usize;
    let nodes: Vec<NodeRecord> = read(device, queue, &voxels.nodes, count);
    let mut expected = BTreeSet::new();
    let root_level = grid.morton_edge(0).ilog2();
    for level in 0..grid.levels {
        for index in voxels.level_nodes(level) {
            let cell = morton_decode(nodes[index as usize].morton).as_ivec3();
            for x in 0..=1 {
                for y in 0..=1 {
                    for z in 0..=1 {
                        let holder = cell.div_euclid(IVec3::splat(2)) - IVec3::new(x, y, z);
                        let last = 2 * holder + 2;
                        if holder.min_element() < 0 || cell.cmpgt(last).any() {
                            continue;
                        }
                        let mut at = holder.as_uvec3();
                        for level in level + 1..=root_level {
                            expected.insert((level, at.to_array()));
                            at /= 2;
                        }
                    }
                }
            }
        }
    }
    expected
}

/// The words of a node.
pub(crate) const NODE_WORDS: u32 = 6;

/// The places of all nodes, found from the root in the words of the octree (the first `table_words`
/// are the table) and the sites. Panics if a node is in a wrong place.
pub(crate) fn walk_nodes(
    (words, table_words): (&[u32], u32),
    sites: &[[u32; 2]],
    root_level: u32,
) -> BTreeMap<NodeAt, u32> {
    let mut places = BTreeMap::new();
    let mut open = vec![(0_u32, (root_level, UVec3::ZERO))];
    let mut groups = 1;
    while let Some((place, (level, cell))) = open.pop() {
        let [morton, site_level] = sites[place as usize];
        assert_eq!((site_level, morton_decode(morton)), (level, cell), "the site of node {place}");
        places.insert((level, cell.to_array()), place);
        let children = words[(table_words + place * NODE_WORDS) as usize];
        if children == 0 {
            continue;
        }
        groups = groups.max(children as usize + 1);
        for octant in 0..8 {
            let child = 8 * children + octant;
            if sites[child as usize][1] != 0 {
                let corner = UVec3::new(octant & 1, (octant >> 1) & 1, octant >> 2);
                open.push((child, (level - 1, 2 * cell + corner)));
            }
        }
    }
    let sited = sites[..8 * groups].iter().filter(|[_, level]| *level > 0).count();
    assert_eq!(places.len(), sited, "every node is reached from the root, once");
    places
}

/// A grid that is not a cube, and whose levels do not halve to powers of two.
pub(crate) fn odd_grid() -> Grid {
    Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), 48, Vec3::new(0.3, 0.6, 0.1)).expect("fits")
}

/// The busy room, turned, so that every lobe is tilted somewhere.
pub(crate) fn turned_room(device: &wgpu::Device) -> Geometry {
    let turn = Mat4::from_rotation_y(0.3) * Mat4::from_scale(Vec3::splat(0.8));
    busy_room().transformed(turn).build(device)
}

/// A quad of a thousandth of a voxel, in the very corner of the grid.
pub(crate) fn speck(device: &wgpu::Device) -> (Grid, Geometry) {
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 64, Vec3::ZERO).expect("fits");
    let corner = grid.world_from_grid(Vec3::splat(0.25));
    let (u, v) = (Vec3::X * 1e-5, Vec3::Y * 1e-5);
    (grid, SceneBuilder::default().quad(corner, u, v, lambert(0.5, 1.0)).build(device))
}

/// Two hundred triangles in a voxel with even coordinates, so that eight nodes per level contain
/// it.
pub(crate) fn crowded_voxel(device: &wgpu::Device) -> (Grid, Geometry) {
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 64, Vec3::ZERO).expect("fits");
    let voxel = Vec3::splat(32.2);
    let geometry = (0..200)
        .fold(SceneBuilder::default(), |scene, i| {
            let offset = Vec3::new((i % 7) as f32, (i % 11) as f32, (i % 13) as f32) * 0.03;
            let corner = grid.world_from_grid(voxel + offset);
            let edge = grid.voxel_size_m * 0.2;
            let u = if i % 2 == 0 { Vec3::X } else { Vec3::Z };
            scene.quad(corner, u * edge, Vec3::Y * edge, lambert(0.5, 1.0))
        })
        .build(device);
    (grid, geometry)
}

/// Sheets in every layer of voxels, larger than the grid: every voxel is occupied.
pub(crate) fn full_grid(device: &wgpu::Device) -> (Grid, Geometry) {
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 32, Vec3::ZERO).expect("fits");
    let far = 10.0;
    let geometry = (0..grid.dimensions.z)
        .fold(SceneBuilder::default(), |scene, layer| {
            let z = grid.world_from_grid(Vec3::splat(layer as f32 + 0.5)).z;
            let corner = Vec3::new(-far, -far, z);
            let (u, v) = (Vec3::X * 2.0 * far, Vec3::Y * 2.0 * far);
            scene.quad(corner, u, v, lambert(0.5, layer as f32))
        })
        .build(device);
    (grid, geometry)
}
