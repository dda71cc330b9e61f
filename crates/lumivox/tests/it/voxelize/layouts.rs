//! Vertices and indices in the layouts of engines' buffers give the same bits as tightly packed
//! ones.

use glam::Mat4;
use lumivox::{Geometry, GeometryBatch, GiError, Indices, SurfaceMaterial, VertexPositions};
use wgpu::IndexFormat::{Uint16, Uint32};

use crate::voxelize::promises::error_of;
use crate::voxelize::read::Lab;
use crate::voxelize::scenes::{Mesh, triangle_soup, unit_grid, upload};

/// The positions of a mesh with a stride and an offset, in bytes; the words between them are noise.
fn positions(lab: &Lab, mesh: &Mesh, stride: u32, offset: u64) -> VertexPositions {
    let (words, first) = (stride as usize / 4, offset as usize / 4);
    let mut content = vec![0xdead_beef_u32; first + words * mesh.positions.len()];
    for (vertex, position) in mesh.positions.iter().enumerate() {
        let place = first + words * vertex;
        content[place..place + 3].copy_from_slice(&position.to_array().map(f32::to_bits));
    }
    VertexPositions { buffer: upload(&lab.device, "vertices", &content), stride, offset }
}

/// The indices of a mesh behind `before` others.
fn indices(lab: &Lab, mesh: &Mesh, format: wgpu::IndexFormat, before: usize) -> Indices {
    let all = vec![7; before].into_iter().chain(mesh.indices.iter().copied());
    let buffer = match format {
        Uint16 => {
            let mut short: Vec<u16> = all.map(|index| index as u16).collect();
            if !short.len().is_multiple_of(2) {
                short.push(9);
            }
            upload(&lab.device, "short indices", &short)
        }
        Uint32 => upload(&lab.device, "indices", &all.collect::<Vec<u32>>()),
    };
    Indices { buffer, format, offset: before as u64 * u64::from(format.byte_size()) }
}

#[test]
fn every_vertex_layout_voxelizes_to_equal_bits() {
    let lab = Lab::new();
    let grid = unit_grid(32);
    let mesh = Mesh::from_triangles(&triangle_soup()[..1000]);
    let packed = mesh.geometry(&lab.device, SurfaceMaterial::default());
    let expected = lab.voxelize(&grid, &packed);
    for (stride, offset, format, before) in
        [(12, 0, Uint16, 0), (32, 0, Uint32, 3), (48, 4096, Uint16, 5), (20, 12, Uint32, 0)]
    {
        let mut geometry = packed.clone();
        let draws = packed.batches[0].draws.clone();
        geometry.batches[0] = GeometryBatch::new(
            positions(&lab, &mesh, stride, offset),
            indices(&lab, &mesh, format, before),
            draws,
        );
        let found = lab.voxelize(&grid, &geometry);
        let layout = format!("stride {stride}, offset {offset}, {format:?} after {before}");
        assert!(found.bits() == expected.bits(), "{layout}");

        // A draw of only the second half, by first index.
        let half = |geometry: &Geometry| {
            let mut geometry = geometry.clone();
            let draw = &mut geometry.batches[0].draws[0];
            (draw.first_index, draw.index_count) = (1503, 1497);
            draw.world_from_local = Mat4::from_scale(glam::Vec3::splat(0.5));
            lab.voxelize(&grid, &geometry)
        };
        assert!(half(&geometry).bits() == half(&packed).bits(), "half of {layout}");
    }
}

type Change = fn(&mut GeometryBatch);

#[test]
fn invalid_vertex_layouts_are_refused() {
    let lab = Lab::new();
    let mesh = Mesh::from_triangles(&triangle_soup()[..10]);
    let good = mesh.geometry(&lab.device, SurfaceMaterial::default());
    let grid = unit_grid(16);
    let wrong: [(Change, &str); 8] = [
        (|batch| batch.positions.stride = 8, "the stride of its positions, 8 bytes"),
        (|batch| batch.positions.stride = 14, "the stride of its positions, 14 bytes"),
        (|batch| batch.positions.offset = 6, "its positions start at byte 6"),
        (|batch| batch.positions.offset = 1 << 40, "but their buffer ends at"),
        (
            |batch| batch.indices.offset = 2,
            "its indices start at byte 2, which is no multiple of 4",
        ),
        (|batch| batch.indices.offset = 4, "its indices end at 30, but the batch has 29"),
        (|batch| batch.indices.offset = 4000, "its indices start at byte 4000"),
        (
            |batch| {
                let mut attributes =
                    lumivox::VertexAttributes::new(batch.indices.buffer.clone(), 8);
                attributes.offset = 3;
                batch.attributes = Some(attributes);
            },
            "its attributes start at byte 3",
        ),
    ];
    for (change, message) in wrong {
        let mut geometry = good.clone();
        change(&mut geometry.batches[0]);
        let error = error_of(&lab, &grid, &geometry);
        assert!(matches!(error, GiError::Geometry { .. }), "{error}");
        assert!(error.to_string().contains(message), "{error}");
    }
}
