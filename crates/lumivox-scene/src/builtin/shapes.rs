//! Simple solids and surfaces. Triangles are counter-clockwise seen from their front; unit normals
//! agree with them, and tangents point along growing u.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use crate::Mesh;

/// Which faces of a [`cuboid`] exist, by the direction that they face.
#[derive(Clone, Copy)]
pub(crate) struct Faces {
    /// Left (-x) and right (+x), bottom and top, back (-z) and front (+z).
    pub(crate) x: [bool; 2],
    pub(crate) y: [bool; 2],
    pub(crate) z: [bool; 2],
}

impl Faces {
    pub(crate) const ALL: Self = Self { x: [true; 2], y: [true; 2], z: [true; 2] };
    /// For boxes on a floor: the hidden face would only be voxelized into the floor.
    pub(crate) const NO_BOTTOM: Self = Self { y: [false, true], ..Self::ALL };
    /// For boxes that hang flush from a ceiling.
    pub(crate) const NO_TOP: Self = Self { y: [true, false], ..Self::ALL };
    /// For boxes that reach from floor to ceiling.
    pub(crate) const SIDES: Self = Self { y: [false; 2], ..Self::ALL };
}

/// A rectangle with half edges `u` and `v` that faces `u` cross `v`; `u` points to the right of its
/// image, `v` to the top.
pub fn quad(center: Vec3, u: Vec3, v: Vec3) -> Mesh {
    let normal = u.cross(v).normalize();
    Mesh {
        name: String::new(),
        positions: vec![center - u - v, center + u - v, center + u + v, center - u + v],
        normals: vec![normal; 4],
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO],
        tangents: vec![u.normalize().extend(1.0); 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    }
}

/// An axis-aligned box seen from outside, from one corner to the opposite one.
pub(crate) fn cuboid(min: Vec3, max: Vec3, faces: Faces) -> Mesh {
    let center = (min + max) * 0.5;
    let half = (max - min) * 0.5;
    let x = Vec3::X * half.x;
    let y = Vec3::Y * half.y;
    let z = Vec3::Z * half.z;
    let candidates = [
        (faces.x[0], -x, z, y),
        (faces.x[1], x, -z, y),
        (faces.y[0], -y, x, z),
        (faces.y[1], y, x, -z),
        (faces.z[0], -z, -x, y),
        (faces.z[1], z, x, y),
    ];
    let mut mesh = Mesh::default();
    for (_, offset, u, v) in candidates.into_iter().filter(|c| c.0) {
        append(&mut mesh, quad(center + offset, u, v));
    }
    mesh
}

/// The inside of an axis-aligned box: a cuboid seen from within.
pub fn interior(min: Vec3, max: Vec3) -> Mesh {
    let mut mesh = cuboid(min, max, Faces::ALL);
    mesh.flip_winding();
    for normal in &mut mesh.normals {
        *normal = -*normal;
    }
    // Normals and winding are both reversed. The bitangent n x t * w must still point to the
    // image's top; `flip_winding` negates w for that.
    mesh
}

/// Which surfaces of a [`frame`] exist.
#[derive(Clone, Copy)]
pub(crate) struct FrameFaces {
    pub(crate) top: bool,
    pub(crate) bottom: bool,
    pub(crate) outer: bool,
}

/// A rectangular ring around the y axis, such as four walls or a roof with an opening. `outer` and
/// `inner` are half its edges along x and z; it reaches from `y[0]` to `y[1]`. Its inner faces
/// always exist.
pub(crate) fn frame(outer: Vec2, inner: Vec2, y: [f32; 2], faces: FrameFaces) -> Mesh {
    let mut mesh = Mesh::default();
    let middle = (y[0] + y[1]) * 0.5;
    let up = Vec3::Y * ((y[1] - y[0]) * 0.5);

    // Two bars along x over the whole length, two along z between them.
    let bar = (outer.y - inner.y) * 0.5;
    let side = (outer.x - inner.x) * 0.5;
    let strips = [
        (Vec3::new(0.0, 0.0, inner.y + bar), Vec2::new(outer.x, bar)),
        (Vec3::new(0.0, 0.0, -inner.y - bar), Vec2::new(outer.x, bar)),
        (Vec3::new(inner.x + side, 0.0, 0.0), Vec2::new(side, inner.y)),
        (Vec3::new(-inner.x - side, 0.0, 0.0), Vec2::new(side, inner.y)),
    ];
    for (center, half) in strips {
        let (x, z) = (Vec3::X * half.x, Vec3::Z * half.y);
        if faces.top {
            append(&mut mesh, quad(center + Vec3::Y * y[1], x, -z));
        }
        if faces.bottom {
            append(&mut mesh, quad(center + Vec3::Y * y[0], x, z));
        }
    }

    let ring = |mesh: &mut Mesh, half: Vec2, outward: f32| {
        let (x, z) = (Vec3::X * half.x, Vec3::Z * half.y);
        let level = Vec3::Y * middle;
        append(mesh, quad(level + x, -z * outward, up));
        append(mesh, quad(level - x, z * outward, up));
        append(mesh, quad(level + z, x * outward, up));
        append(mesh, quad(level - z, -x * outward, up));
    };
    ring(&mut mesh, inner, -1.0);
    if faces.outer {
        ring(&mut mesh, outer, 1.0);
    }
    mesh
}

/// A sphere around the origin with smooth normals: `segments` around the y axis, half as many
/// rings.
pub fn sphere(radius_m: f32, segments: u32) -> Mesh {
    let rings = segments / 2;
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let polar = PI * ring as f32 / rings as f32;
        for segment in 0..=segments {
            let azimuth = TAU * segment as f32 / segments as f32;
            // Exact at the poles: f32's sin(pi) would leave sliver triangles there.
            let sin = if ring == 0 || ring == rings { 0.0 } else { polar.sin() };
            let normal = Vec3::new(sin * azimuth.cos(), polar.cos(), -sin * azimuth.sin());
            let normal = normal.normalize();
            let tangent = Vec3::new(-azimuth.sin(), 0.0, -azimuth.cos());
            mesh.positions.push(normal * radius_m);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(segment as f32 / segments as f32, ring as f32 / rings as f32));
            mesh.tangents.push(tangent.extend(1.0));
        }
    }
    let row = segments + 1;
    for ring in 0..rings {
        for segment in 0..segments {
            let upper = ring * row + segment;
            let lower = upper + row;
            // At a pole one of the two triangles has no area.
            if ring > 0 {
                mesh.indices.extend([upper, lower, upper + 1]);
            }
            if ring + 1 < rings {
                mesh.indices.extend([upper + 1, lower, lower + 1]);
            }
        }
    }
    mesh
}

/// The curved side of an upright cylinder with smooth normals, standing on `base`; it has no caps,
/// since it reaches from one floor to the next.
pub(crate) fn cylinder(base: Vec3, radius_m: f32, height_m: f32, segments: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for segment in 0..=segments {
        // The last column has the first one's angle exactly, so that the seam is closed.
        let azimuth = TAU * (segment % segments) as f32 / segments as f32;
        let normal = Vec3::new(azimuth.cos(), 0.0, -azimuth.sin());
        let tangent = Vec3::new(-azimuth.sin(), 0.0, -azimuth.cos());
        for (v, y) in [(1.0, 0.0), (0.0, height_m)] {
            mesh.positions.push(base + normal * radius_m + Vec3::Y * y);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(segment as f32 / segments as f32, v));
            mesh.tangents.push(tangent.extend(1.0));
        }
    }
    for segment in 0..segments {
        let low = segment * 2;
        mesh.indices.extend([low, low + 2, low + 1, low + 1, low + 2, low + 3]);
    }
    mesh
}

/// Adds the triangles of `other`.
pub fn append(mesh: &mut Mesh, other: Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(other.positions);
    mesh.normals.extend(other.normals);
    mesh.uvs.extend(other.uvs);
    mesh.tangents.extend(other.tangents);
    mesh.indices.extend(other.indices.iter().map(|i| i + first));
}

/// Merges several meshes into one.
pub(crate) fn merge(parts: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut mesh = Mesh::default();
    for part in parts {
        append(&mut mesh, part);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the enclosed volume, signed: positive where the surface faces outwards.
    fn signed_volume(mesh: &Mesh) -> f32 {
        let sum: f32 = mesh
            .triangles()
            .map(|t| t.map(|i| mesh.positions[i]))
            .map(|[a, b, c]| a.dot(b.cross(c)))
            .sum();
        sum / 6.0
    }

    fn assert_normals_agree(mesh: &Mesh) {
        for t in mesh.triangles() {
            let [a, b, c] = t.map(|i| mesh.positions[i]);
            let face = (b - a).cross(c - a);
            assert!(face.length() > 0.0);
            for i in t {
                assert!(face.dot(mesh.normals[i]) > 0.0);
                assert!((mesh.normals[i].length() - 1.0).abs() < 1e-5);
                assert!(mesh.tangents[i].truncate().dot(mesh.normals[i]).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn a_cuboid_encloses_its_volume() {
        let mesh = cuboid(Vec3::new(-1.0, 2.0, 0.0), Vec3::new(1.0, 5.0, 4.0), Faces::ALL);
        assert_normals_agree(&mesh);
        assert!((signed_volume(&mesh) - 24.0).abs() < 1e-4);
    }

    #[test]
    fn an_interior_faces_inwards() {
        let mesh = interior(Vec3::ZERO, Vec3::splat(2.0));
        assert_normals_agree(&mesh);
        assert!((signed_volume(&mesh) + 8.0).abs() < 1e-4);
    }

    #[test]
    fn a_sphere_approaches_its_volume() {
        let mesh = sphere(0.5, 64);
        assert_normals_agree(&mesh);
        let exact = 4.0 / 3.0 * PI * 0.125;
        assert!((signed_volume(&mesh) / exact - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_cylinder_faces_outwards() {
        let mesh = cylinder(Vec3::new(3.0, -1.0, 2.0), 0.5, 2.0, 24);
        assert_normals_agree(&mesh);
    }

    #[test]
    fn a_frame_encloses_its_volume() {
        let faces = FrameFaces { top: true, bottom: true, outer: true };
        let mesh = frame(Vec2::new(3.0, 2.0), Vec2::new(1.0, 0.5), [1.0, 2.0], faces);
        assert_normals_agree(&mesh);
        assert!((signed_volume(&mesh) - (24.0 - 2.0)).abs() < 1e-4);
    }

    #[test]
    fn textures_are_upright_on_shapes() {
        // The bitangent points to the image's top, where v is smaller.
        let mesh = cuboid(Vec3::splat(-1.0), Vec3::ONE, Faces::ALL);
        for t in mesh.triangles() {
            let [a, b, c] = t.map(|i| (mesh.positions[i], mesh.uvs[i]));
            let (p1, p2) = (b.0 - a.0, c.0 - a.0);
            let (t1, t2) = (b.1 - a.1, c.1 - a.1);
            let det = t1.perp_dot(t2);
            let along_u = (p1 * t2.y - p2 * t1.y) / det;
            let along_v = (p2 * t1.x - p1 * t2.x) / det;
            let tangent = mesh.tangents[t[0]];
            let bitangent = mesh.normals[t[0]].cross(tangent.truncate()) * tangent.w;
            assert!(along_u.dot(tangent.truncate()) > 0.0);
            assert!(along_v.dot(bitangent) < 0.0);
        }
    }
}
