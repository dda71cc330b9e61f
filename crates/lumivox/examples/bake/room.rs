//! The room that is baked: flat quads, each of one colour.

use glam::Vec3;
use lumivox::gpu::{Buffer, upload};
use lumivox::{Draw, Geometry, GeometryBatch, SurfaceMaterial, wgpu};

/// A parallelogram whose front is where `u` x `v` points.
pub struct Quad {
    pub corner: Vec3,
    pub u: Vec3,
    pub v: Vec3,
    pub albedo: Vec3,
}

impl Quad {
    pub fn normal(&self) -> Vec3 {
        self.u.cross(self.v).normalize()
    }

    /// Texels along both sides, of at most the given edge, m.
    pub fn texels(&self, edge_m: f32) -> [u32; 2] {
        [self.u, self.v].map(|side| (side.length() / edge_m).ceil() as u32)
    }
}

/// Opposite corners of the room.
pub const BOUNDS: (Vec3, Vec3) = (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));

/// A closed room with a red and a blue wall, and a screen that keeps the lamp's light off its right
/// half.
pub fn quads() -> Vec<Quad> {
    let white = Vec3::splat(0.75);
    let (red, blue) = (Vec3::new(0.7, 0.1, 0.08), Vec3::new(0.1, 0.2, 0.7));
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let low = BOUNDS.0;
    let quad = |corner, u, v, albedo| Quad { corner, u, v, albedo };
    let screen = Vec3::new(0.15, 0.0, -0.5);
    let (up, along) = (Vec3::Y * 1.3, Vec3::Z * 1.2);
    vec![
        quad(low, z, x, white),
        quad(low + y, x, z, white),
        quad(low, x, y, white),
        quad(low + z, y, x, white),
        quad(low, y, z, red),
        quad(low + x, z, y, blue),
        quad(screen, along, up, white),
        quad(screen + Vec3::X * 0.04, up, along, white),
    ]
}

/// The quads as triangles on the GPU. The buffers must stay until they are voxelized.
pub fn geometry(device: &wgpu::Device, quads: &[Quad]) -> (Geometry, [Buffer; 2]) {
    let corners = |quad: &Quad| {
        let Quad { corner, u, v, .. } = *quad;
        [corner, corner + u, corner + u + v, corner + v].map(|corner| corner.to_array())
    };
    let positions: Vec<[f32; 3]> = quads.iter().flat_map(corners).collect();
    let indices: Vec<u32> = (0..quads.len() as u32)
        .flat_map(|quad| [0, 1, 2, 0, 2, 3].map(|corner| 4 * quad + corner))
        .collect();
    let positions = upload(device, "positions", &positions);
    let indices = upload(device, "indices", &indices);
    let draws = (0..quads.len() as u32).map(|quad| Draw::new(6 * quad, 6, quad)).collect();
    let [own_positions, own_indices] = [&positions, &indices].map(|own| wgpu::Buffer::clone(own));
    let batch = GeometryBatch::new(own_positions, own_indices, draws);
    let materials = quads.iter().map(|quad| SurfaceMaterial {
        reflectance: quad.albedo.extend(1.0),
        ..SurfaceMaterial::default()
    });
    (Geometry::new(vec![batch], materials.collect()), [positions, indices])
}
