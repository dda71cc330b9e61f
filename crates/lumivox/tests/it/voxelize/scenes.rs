//! Geometry for tests: triangles in plain vectors, uploaded on request.

use glam::{Mat4, Vec2, Vec3};
use lumivox::{Draw, Geometry, GeometryBatch, Grid, SurfaceMaterial, VertexAttributes};
use wgpu::util::DeviceExt as _;

/// A buffer as an engine would create it.
pub fn upload<T: bytemuck::Pod>(device: &wgpu::Device, label: &str, content: &[T]) -> wgpu::Buffer {
    // No binding may be empty.
    let contents = if content.is_empty() { &[0; 16] } else { bytemuck::cast_slice(content) };
    let (label, usage) = (Some(label), wgpu::BufferUsages::STORAGE);
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label, contents, usage })
}

/// A small random generator, so that tests need no crate for it (PCG, as in gpu/random.wgsl).
pub struct Random(pub u32);

impl Random {
    pub fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    }

    /// A random number from 0 to 1.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / (1 << 24) as f32
    }

    pub fn vector(&mut self, low: f32, high: f32) -> Vec3 {
        let mut component = || low + (high - low) * self.unit();
        Vec3::new(component(), component(), component())
    }
}

/// Triangles of one batch.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub texcoords: Vec<Vec2>,
    pub indices: Vec<u32>,
}

impl Mesh {
    pub fn from_triangles(triangles: &[[Vec3; 3]]) -> Self {
        let positions: Vec<Vec3> = triangles.iter().flatten().copied().collect();
        let indices = (0..positions.len() as u32).collect();
        Self { positions, texcoords: Vec::new(), indices }
    }

    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        let corner = |index: &u32| self.positions[*index as usize];
        self.indices
            .chunks_exact(3)
            .map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])])
            .collect()
    }

    pub fn quad(&mut self, corners: [Vec3; 4]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }

    /// A closed box, faces outwards.
    pub fn cuboid(&mut self, from_unit: Mat4) {
        for axis in 0..3 {
            for side in [0.0, 1.0] {
                let corner = |u: f32, v: f32| {
                    let mut p = [0.0; 3];
                    p[axis] = side;
                    p[(axis + 1) % 3] = u;
                    p[(axis + 2) % 3] = v;
                    from_unit.transform_point3(Vec3::from(p))
                };
                let mut corners =
                    [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
                if side == 0.0 {
                    corners.reverse();
                }
                self.quad(corners);
            }
        }
    }

    /// A sphere of `2 * segments * segments` triangles or a little fewer, faces outwards.
    pub fn sphere(centre: Vec3, radius: f32, segments: u32) -> Self {
        let mut mesh = Self::default();
        for row in 0..=segments {
            for column in 0..=segments {
                let theta = std::f64::consts::PI * f64::from(row) / f64::from(segments);
                let phi =
                    std::f64::consts::TAU * f64::from(column % segments) / f64::from(segments);
                let direction =
                    glam::DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
                // Exact poles.
                let direction = if row == 0 || row == segments {
                    direction.y.signum() * glam::DVec3::Y
                } else {
                    direction
                };
                mesh.positions.push(centre + radius * direction.as_vec3());
            }
        }
        for row in 0..segments {
            for column in 0..segments {
                let a = row * (segments + 1) + column;
                let b = a + segments + 1;
                if row > 0 {
                    mesh.indices.extend([a, a + 1, b]);
                }
                if row + 1 < segments {
                    mesh.indices.extend([a + 1, b + 1, b]);
                }
            }
        }
        mesh
    }

    /// A batch with one draw of the mesh.
    pub fn batch(&self, device: &wgpu::Device, material: u32) -> GeometryBatch {
        let positions: Vec<[f32; 3]> = self.positions.iter().map(Vec3::to_array).collect();
        let texcoords: Vec<[f32; 2]> = self.texcoords.iter().map(Vec2::to_array).collect();
        let mut batch = GeometryBatch::new(
            upload(device, "positions", &positions),
            upload(device, "indices", &self.indices),
            vec![Draw::new(0, self.indices.len() as u32, material)],
        );
        batch.attributes = (!texcoords.is_empty())
            .then(|| VertexAttributes::texcoords(upload(device, "texcoords", &texcoords)));
        batch
    }

    /// The mesh with one material.
    pub fn geometry(&self, device: &wgpu::Device, material: SurfaceMaterial) -> Geometry {
        Geometry::new(vec![self.batch(device, 0)], vec![material])
    }
}

/// The Cornell box's triangles: five walls and two blocks, 34 large triangles, in a room of 2 m.
pub fn cornell_box() -> Mesh {
    let mut mesh = Mesh::default();
    let p = Vec3::new;
    mesh.quad([p(0., 0., 0.), p(0., 0., 2.), p(2., 0., 2.), p(2., 0., 0.)]);
    mesh.quad([p(0., 2., 0.), p(2., 2., 0.), p(2., 2., 2.), p(0., 2., 2.)]);
    mesh.quad([p(0., 0., 0.), p(2., 0., 0.), p(2., 2., 0.), p(0., 2., 0.)]);
    mesh.quad([p(0., 0., 0.), p(0., 2., 0.), p(0., 2., 2.), p(0., 0., 2.)]);
    mesh.quad([p(2., 0., 0.), p(2., 0., 2.), p(2., 2., 2.), p(2., 2., 0.)]);
    let block = |x: f32, z: f32, turn: f32, height: f32| {
        Mat4::from_translation(p(x, 0.0, z))
            * Mat4::from_rotation_y(turn)
            * Mat4::from_scale(p(0.6, height, 0.6))
    };
    mesh.cuboid(block(0.3, 0.5, 0.3, 1.2));
    mesh.cuboid(block(1.1, 1.2, -0.3, 0.6));
    mesh
}

/// A grid with a voxel of 1 m, its corner at the origin: coordinates are exact in f32.
pub fn unit_grid(edge: u32) -> Grid {
    Grid {
        origin_in_world: Vec3::ZERO,
        voxel_size_m: 1.0,
        dimensions: glam::UVec3::splat(edge),
        levels: (edge / 4).ilog2() + 1,
        cascades: None,
    }
}

pub fn triangle_soup() -> Vec<[Vec3; 3]> {
    let mut random = Random(21);
    let mut triangles: Vec<_> = (0..3000)
        .map(|i| {
            let size = [0.01, 0.5, 3.0][i % 3];
            let centre = random.vector(0.0, 32.0);
            [(); 3].map(|()| centre + random.vector(-size, size))
        })
        .collect();
    triangles.extend(cornell_box().triangles().iter().map(|t| t.map(|p| p * 12.0 + 3.0)));
    triangles
}
