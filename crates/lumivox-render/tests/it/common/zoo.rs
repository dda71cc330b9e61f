//! A scene with one of every material, on a checkered floor under sun and sky.

use glam::{Affine2, Mat4, Vec2, Vec3, Vec4};
use lumivox_scene::{
    AlphaMode, Camera, Clearcoat, Filter, Instance, Light, LightKind, Material, Mesh,
    MetallicRoughness, Sampler, Scene, Shading, Sheen, Texture, TextureRef, Transmission, Unlit,
    Wrap,
};

/// Radius of [`sphere`].
pub const RADIUS_M: f32 = 0.3;

/// The scene.
///
/// # Panics
/// Never: all parts of the scene exist.
pub fn scene() -> Scene {
    let mut scene = Scene { name: "materials".to_owned(), ..Scene::default() };
    scene.environment.radiance = Vec3::new(1.2, 1.6, 2.2);
    scene.lights.push(Light {
        name: "sun".to_owned(),
        intensity: 14.0,
        color: Vec3::new(1.0, 0.93, 0.8),
        direction: Vec3::new(-0.55, -1.0, -0.5).normalize(),
        ..Light::typical(LightKind::Directional)
    });
    let checker = add_texture(&mut scene, 2, 2, Filter::Nearest, |x, y| {
        if x == y { [222, 218, 208, 255] } else { [60, 66, 84, 255] }
    });
    let leaf = add_texture(&mut scene, 64, 64, Filter::Linear, |x, y| {
        // Rows of leaves: ellipses, turned from row to row.
        let (u, v) = (f64::from(x % 16) / 8.0 - 1.0, f64::from(y % 16) / 8.0 - 1.0);
        let turn = if (x / 16 + y / 16) % 2 == 0 { 1.0 } else { -1.0 };
        let (a, b) = (u + turn * v, u - turn * v);
        [70, 150, 50, if a * a / 2.6 + b * b / 0.6 < 1.0 { 255 } else { 0 }]
    });
    let arrow = add_texture(&mut scene, 16, 16, Filter::Nearest, |x, y| {
        let is_shaft = (7..9).contains(&x) && y > 3;
        let is_head = y < 8 && x.abs_diff(8) <= y;
        if is_shaft || is_head { [240, 240, 230, 255] } else { [40, 70, 150, 255] }
    });

    let ground = quad(Vec3::NEG_Z * 0.2, Vec3::X * 3.4, Vec3::NEG_Z * 2.2);
    let ground =
        Mesh { uvs: ground.uvs.iter().map(|uv| *uv * Vec2::new(9.0, 6.0)).collect(), ..ground };
    let floor = textured(Material::diffuse("floor", Vec3::ONE), TextureRef::new(checker));
    place(&mut scene, ground, floor, Mat4::IDENTITY);
    let wall = quad(Vec3::new(0.0, 0.9, -2.3), Vec3::X * 3.4, Vec3::Y * 0.9);
    place(&mut scene, wall, Material::diffuse("wall", Vec3::new(0.72, 0.66, 0.58)), Mat4::IDENTITY);

    for (i, (name, material)) in spheres().into_iter().enumerate() {
        let (row, column) = (i / 5, i % 5);
        let at = Vec3::new(
            (column as f32 - 2.0 + 0.42 * row as f32) * 0.85 - 0.18,
            RADIUS_M,
            1.1 - 1.1 * row as f32,
        );
        let mut ball = sphere();
        if name == "vertex colours" {
            ball.colors = ball
                .normals
                .iter()
                .map(|n| (0.5 + 0.5 * *n).clamp(Vec3::ZERO, Vec3::ONE).extend(1.0))
                .collect();
        }
        place(
            &mut scene,
            ball,
            Material { name: name.to_owned(), ..material },
            Mat4::from_translation(at),
        );
    }

    // Behind: leaves, panes of coloured glass in front of each other, arrows turned by texture
    // transforms.
    let upright = |x: f32, z: f32| quad(Vec3::new(x, 0.75, z), Vec3::X * 0.45, Vec3::Y * 0.75);
    let mut leaves = textured(Material::diffuse("leaves", Vec3::ONE), TextureRef::new(leaf));
    leaves.alpha = AlphaMode::Mask { cutoff: 0.5 };
    leaves.double_sided = true;
    place(&mut scene, upright(-2.2, -1.3), leaves.clone(), Mat4::IDENTITY);
    place(&mut scene, upright(-1.9, -1.6), leaves, Mat4::IDENTITY);
    for (x, z, color) in [
        (-0.75, -1.2, Vec3::new(0.9, 0.15, 0.1)),
        (-0.3, -1.5, Vec3::new(0.1, 0.35, 0.95)),
        (0.1, -1.3, Vec3::new(1.0, 0.8, 0.1)),
    ] {
        let pane = Material { double_sided: true, ..glass("pane", color, 0.0) };
        place(&mut scene, upright(x, z), pane, Mat4::IDENTITY);
    }
    for (i, degrees) in [0.0_f32, 45.0, 90.0].into_iter().enumerate() {
        let middle = Affine2::from_translation(Vec2::splat(0.5));
        let turn = Affine2::from_angle(degrees.to_radians());
        let transform = middle * turn * Affine2::from_translation(Vec2::splat(-0.5));
        let reference = TextureRef { transform, ..TextureRef::new(arrow) };
        let sign = textured(Material::diffuse("sign", Vec3::ONE), reference);
        let sign = Material { double_sided: true, ..sign };
        let at = Vec3::new(1.35 + 0.65 * i as f32, 0.5, -1.35);
        place(&mut scene, quad(at, Vec3::X * 0.28, Vec3::Y * 0.28), sign, Mat4::IDENTITY);
    }
    scene.cameras.push(Camera {
        name: "front".to_owned(),
        ..Camera::look_at(Vec3::new(0.0, 2.3, 4.6), Vec3::new(0.0, 0.5, -0.1), 0.6)
    });
    scene.validate().expect("a valid scene");
    scene
}

fn spheres() -> [(&'static str, Material); 10] {
    let shaded = |color: Vec3, metallic, roughness| Material {
        shading: Shading::MetallicRoughness(MetallicRoughness {
            base_color: color.extend(1.0),
            metallic,
            roughness,
            ..MetallicRoughness::default()
        }),
        ..Material::default()
    };
    let coat = Clearcoat { strength: 1.0, roughness: 0.03, texture: None };
    let red = Vec3::new(0.6, 0.02, 0.02);
    let velvet = |color| Sheen { color, roughness: 0.35, texture: None };
    let blend = |alpha| {
        let mut material = shaded(Vec3::new(0.9, 0.5, 0.1), 0.0, 0.6);
        material.alpha = AlphaMode::Blend;
        if let Shading::MetallicRoughness(shading) = &mut material.shading {
            shading.base_color.w = alpha;
        }
        material
    };
    let gloss = Shading::MetallicRoughness(MetallicRoughness {
        base_color: Vec4::new(0.02, 0.02, 0.02, 1.0),
        roughness: 0.25,
        ior: 0.0,
        specular_color: Vec3::new(0.2, 0.5, 0.3),
        ..MetallicRoughness::default()
    });
    [
        ("paint", shaded(red, 0.0, 0.6)),
        ("varnished paint", Material { clearcoat: coat, ..shaded(red, 0.0, 0.6) }),
        (
            "varnished metal",
            Material { clearcoat: coat, ..shaded(Vec3::new(0.9, 0.6, 0.3), 1.0, 0.5) },
        ),
        (
            "velvet",
            Material {
                sheen: velvet(Vec3::new(0.9, 0.8, 1.0)),
                ..shaded(Vec3::new(0.12, 0.03, 0.25), 0.0, 1.0)
            },
        ),
        ("vertex colours", shaded(Vec3::ONE, 0.0, 0.7)),
        ("clear glass", glass("clear glass", Vec3::ONE, 0.0)),
        ("green glass", glass("green glass", Vec3::new(0.3, 0.9, 0.4), 0.05)),
        ("a blend of a quarter", blend(0.25)),
        ("coloured gloss", Material { shading: gloss, ..Material::default() }),
        (
            "unlit",
            Material {
                shading: Shading::Unlit(Unlit {
                    color: Vec4::new(0.9, 0.2, 0.6, 1.0),
                    color_texture: None,
                }),
                ..Material::default()
            },
        ),
    ]
}

fn glass(name: &str, color: Vec3, roughness: f32) -> Material {
    Material {
        name: name.to_owned(),
        shading: Shading::MetallicRoughness(MetallicRoughness {
            base_color: color.extend(1.0),
            roughness,
            ..MetallicRoughness::default()
        }),
        transmission: Transmission { factor: 1.0, texture: None },
        ..Material::default()
    }
}

fn textured(mut material: Material, reference: TextureRef) -> Material {
    if let Shading::MetallicRoughness(shading) = &mut material.shading {
        shading.base_color_texture = Some(reference);
    }
    material
}

fn add_texture(
    scene: &mut Scene,
    width: u32,
    height: u32,
    magnify: Filter,
    texel: impl Fn(u32, u32) -> [u8; 4],
) -> usize {
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    scene.textures.push(Texture {
        name: "made".to_owned(),
        width,
        height,
        rgba8: texels.flat_map(|(x, y)| texel(x, y)).collect(),
        sampler: Sampler {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            magnify,
            minify: Filter::Linear,
        },
    });
    scene.textures.len() - 1
}

/// Adds a mesh with one material to the scene.
pub fn place(scene: &mut Scene, mesh: Mesh, material: Material, world_from_local: Mat4) {
    let name = material.name.clone();
    scene.meshes.push(Mesh { name: name.clone(), ..mesh });
    scene.materials.push(material);
    scene.instances.push(Instance {
        name,
        mesh: scene.meshes.len() - 1,
        material: scene.materials.len() - 1,
        world_from_local,
        ..Instance::default()
    });
}

/// A rectangle with half edges `u` and `v` that faces `u` cross `v`. The right of an image is along
/// `u`, its top along `v`.
pub fn quad(center: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        positions: vec![center - u - v, center + u - v, center + u + v, center - u + v],
        normals: vec![u.cross(v).normalize(); 4],
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO],
        tangents: vec![u.normalize().extend(1.0); 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    }
}

/// A sphere around the origin.
pub fn sphere() -> Mesh {
    let (rings, segments) = (24_u32, 48_u32);
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let polar = f64::from(ring) / f64::from(rings) * std::f64::consts::PI;
        for segment in 0..=segments {
            let azimuth = f64::from(segment) / f64::from(segments) * std::f64::consts::TAU;
            let normal = glam::DVec3::new(
                polar.sin() * azimuth.cos(),
                polar.cos(),
                -polar.sin() * azimuth.sin(),
            );
            let normal = normal.as_vec3().normalize();
            mesh.positions.push(normal * RADIUS_M);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(segment as f32 / segments as f32, ring as f32 / rings as f32));
            mesh.tangents.push(normal.any_orthonormal_vector().extend(1.0));
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let upper = ring * (segments + 1) + segment;
            let lower = upper + segments + 1;
            mesh.indices.extend([upper, lower, upper + 1, upper + 1, lower, lower + 1]);
        }
    }
    mesh
}
