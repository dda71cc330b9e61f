//! Random scenes with all features of the model.

use std::sync::Arc;

use glam::{Affine2, EulerRot, Mat4, Quat, Vec2, Vec3, Vec4};
use lumivox_scene::{
    AlphaMode, Attenuation, Bounds, Camera, Clearcoat, Environment, EnvironmentMap, Filter,
    Instance, Light, LightKind, LoadNotes, Material, Mesh, MetallicRoughness, Phong, Sampler,
    Scene, Shading, Sheen, Strengths, Texture, TextureRef, Transmission, Unlit, Wrap,
};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

/// Valid scenes, with a few of each thing.
pub fn scene() -> impl Strategy<Value = Scene> {
    let things = (
        vec(mesh(), 1..4),
        vec(texture(), 0..4),
        vec(light(), 0..4),
        vec(camera(), 0..3),
        (environment(), option::of(grid())),
    );
    things
        .prop_flat_map(|(meshes, textures, lights, cameras, environment)| {
            let materials = vec(material(textures.len()), 1..5);
            (Just((meshes, textures, lights, cameras, environment)), materials)
        })
        .prop_flat_map(|(things, materials)| {
            let instances = vec(instance(things.0.len(), materials.len()), 1..6);
            (Just(things), Just(materials), instances)
        })
        .prop_map(|((meshes, textures, lights, cameras, environment), materials, instances)| {
            Scene {
                name: "random".to_owned(),
                meshes,
                instances,
                materials,
                textures,
                lights,
                cameras,
                environment: environment.0,
                grid_bounds: environment.1,
                ..Scene::default()
            }
        })
        .prop_filter_map("a scene of no extent", |mut scene| {
            scene.validate().ok()?;
            scene.notes = LoadNotes::default();
            Some(scene)
        })
}

/// Names of any characters, at most the 80 that loaders keep.
fn name() -> impl Strategy<Value = String> {
    prop_oneof!["[a-z]{1,8}", any::<String>().prop_map(|name| name.chars().take(80).collect()),]
}

/// 0 to 1, with both ends, and with quarters, which may be defaults that files omit.
fn unit() -> impl Strategy<Value = f32> {
    let quarter = (0..=4_u8).prop_map(|quarters| f32::from(quarters) / 4.0);
    prop_oneof![quarter, 0.0..=1.0_f32, 0.0..1e-30_f32]
}

/// At least 0, over many orders of magnitude.
fn amount() -> impl Strategy<Value = f32> {
    prop_oneof![
        Just(0.0),
        Just(1.0),
        0.0..10.0_f32,
        (0.1..1.0_f32, -30..30_i32).prop_map(|(m, e)| m * 10.0_f32.powi(e)),
    ]
}

fn signed() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0), Just(-0.0), -10.0..10.0_f32, -1e-6..1e-6_f32]
}

fn rgb(channel: impl Strategy<Value = f32> + Clone) -> impl Strategy<Value = Vec3> {
    prop_oneof![
        Just(Vec3::ONE),
        Just(Vec3::ZERO),
        [channel.clone(), channel.clone(), channel].prop_map(Vec3::from_array)
    ]
}

fn rgba() -> impl Strategy<Value = Vec4> {
    prop_oneof![Just(Vec4::ONE), (rgb(UNIT), unit()).prop_map(|(rgb, a)| rgb.extend(a))]
}

/// A strategy that can be copied.
const UNIT: std::ops::RangeInclusive<f32> = 0.0..=1.0;

fn point() -> impl Strategy<Value = Vec3> {
    [signed(), signed(), signed()].prop_map(Vec3::from_array)
}

fn direction() -> impl Strategy<Value = Vec3> {
    prop_oneof![
        Just(Vec3::NEG_Y),
        [-1.0..1.0_f32, -1.0..1.0_f32, -1.0..1.0_f32]
            .prop_map(|v| Vec3::from_array(v).try_normalize().unwrap_or(Vec3::Z)),
    ]
}

fn mesh() -> impl Strategy<Value = Mesh> {
    let vertex = (point(), direction(), point(), direction(), rgba(), any::<bool>());
    let lists = (any::<[bool; 4]>(), -12..12_i32);
    (name(), vec(vertex, 3..10), vec(any::<[prop::sample::Index; 3]>(), 1..8), lists).prop_map(
        |(name, vertices, triangles, ([textured, second, colored, tangents], exponent))| {
            let scale = 10.0_f32.powi(exponent);
            let count = vertices.len();
            let mut mesh = Mesh { name, ..Mesh::default() };
            for (position, normal, uvs, tangent, color, turned) in vertices {
                mesh.positions.push(position * scale);
                mesh.normals.push(normal);
                mesh.uvs.push(if textured { uvs.truncate() } else { Vec2::ZERO });
                if second {
                    mesh.uvs1.push(Vec2::new(uvs.z, uvs.x));
                }
                if colored {
                    mesh.colors.push(color);
                }
                mesh.tangents.push(if tangents {
                    tangent.extend(if turned { -1.0 } else { 1.0 })
                } else {
                    // The loader's default tangents, if none are needed.
                    normal.any_orthonormal_vector().extend(1.0)
                });
            }
            mesh.indices = triangles.iter().flatten().map(|i| i.index(count) as u32).collect();
            mesh
        },
    )
}

fn texture() -> impl Strategy<Value = Texture> {
    let wrap = prop_oneof![Just(Wrap::Repeat), Just(Wrap::MirroredRepeat), Just(Wrap::ClampToEdge)];
    let filter = prop_oneof![Just(Filter::Nearest), Just(Filter::Linear)];
    let sampler = (wrap.clone(), wrap, filter.clone(), filter)
        .prop_map(|(wrap_u, wrap_v, magnify, minify)| Sampler { wrap_u, wrap_v, magnify, minify });
    // Opaque, nearly opaque, and any alpha.
    let least_alpha = prop_oneof![Just(255), Just(254), Just(0)];
    (name(), 1..6_u32, 1..6_u32, sampler, least_alpha).prop_flat_map(
        |(name, width, height, sampler, least_alpha)| {
            let texels = vec(any::<[u8; 4]>(), (width * height) as usize);
            texels.prop_map(move |mut texels| {
                for texel in &mut texels {
                    texel[3] = texel[3].max(least_alpha);
                }
                let rgba8 = texels.concat();
                Texture { name: name.clone(), width, height, rgba8, sampler }
            })
        },
    )
}

/// A reference to one of `count` textures, or none.
fn reference(count: usize) -> BoxedStrategy<Option<TextureRef>> {
    if count == 0 {
        return Just(None).boxed();
    }
    let scaled =
        (-3.0..3.0_f32, -3.0..3.0_f32, -1.0..1.0_f32, 0.0..1.0_f32).prop_map(|(sx, sy, x, y)| {
            Affine2::from_scale_angle_translation(Vec2::new(sx, sy), 0.0, Vec2::new(x, y))
        });
    let turned = (-7.0..7.0_f32, 0.1..3.0_f32).prop_map(|(angle, s)| {
        Affine2::from_scale_angle_translation(Vec2::new(s, 1.0), angle, Vec2::ZERO)
    });
    let any =
        [-3.0..3.0_f32, -3.0..3.0_f32, -3.0..3.0_f32, -3.0..3.0_f32, -3.0..3.0_f32, -3.0..3.0_f32]
            .prop_map(|columns| Affine2::from_cols_array(&columns));
    let transform = prop_oneof![3 => Just(Affine2::IDENTITY), 1 => scaled, 1 => turned, 1 => any];
    option::of((0..count, 0..2_u32, transform))
        .prop_map(|reference| {
            reference.map(|(texture, uv_set, transform)| TextureRef { texture, uv_set, transform })
        })
        .boxed()
}

fn shading(textures: usize) -> impl Strategy<Value = Shading> {
    let map = || reference(textures);
    let ior = prop_oneof![Just(1.5), Just(0.0), 1.0..3.0_f32];
    let core = ((rgba(), map(), unit(), unit(), map()), (unit(), rgb(0.0..4.0_f32), map(), ior))
        .prop_map(|((base_color, base_color_texture, metallic, roughness, rough), more)| {
            let (specular, specular_color, specular_texture, ior) = more;
            Shading::MetallicRoughness(MetallicRoughness {
                base_color,
                base_color_texture,
                metallic,
                roughness,
                metallic_roughness_texture: rough,
                specular,
                specular_color,
                specular_texture,
                ior,
            })
        });
    let phong = (rgb(UNIT), map(), unit(), rgb(UNIT), map(), amount()).prop_map(
        |(diffuse, diffuse_texture, opacity, specular, specular_texture, shininess)| {
            Shading::Phong(Phong {
                diffuse,
                diffuse_texture,
                opacity,
                specular,
                specular_texture,
                shininess,
            })
        },
    );
    let unlit = (rgba(), map())
        .prop_map(|(color, color_texture)| Shading::Unlit(Unlit { color, color_texture }));
    prop_oneof![3 => core, 1 => phong, 1 => unlit]
}

fn material(textures: usize) -> impl Strategy<Value = Material> {
    let map = || reference(textures);
    let alpha = prop_oneof![
        Just(AlphaMode::Opaque),
        unit().prop_map(|cutoff| AlphaMode::Mask { cutoff }),
        Just(AlphaMode::Blend)
    ];
    let clearcoat = (unit(), unit(), map()).prop_map(|(strength, roughness, texture)| Clearcoat {
        strength,
        roughness,
        texture,
    });
    let sheen = (rgb(UNIT), unit(), map()).prop_map(|(color, roughness, texture)| Sheen {
        color,
        roughness,
        texture,
    });
    let transmission =
        (unit(), map()).prop_map(|(factor, texture)| Transmission { factor, texture });
    let layers = (
        option::of(clearcoat).prop_map(Option::unwrap_or_default),
        option::of(sheen).prop_map(Option::unwrap_or_default),
        option::of(transmission).prop_map(Option::unwrap_or_default),
    );
    let strengths = (rgb(UNIT), [signed(), signed(), signed(), signed()], any::<bool>()).prop_map(
        |(color, [ambient, diffuse, specular, shininess], is_rounded)| Strengths {
            color,
            ambient,
            diffuse,
            specular,
            shininess,
            is_rounded,
        },
    );
    let old = option::of(strengths);
    let emission = (rgb(prop_oneof![0.0..2.0_f32, 0.0..1e6_f32].boxed()), map());
    let sides = any::<bool>();
    (name(), shading(textures), emission, (map(), signed()), alpha, sides, layers, old).prop_map(
        |(name, shading, emission, normal, alpha, double_sided, layers, strengths)| Material {
            name,
            shading,
            emissive: emission.0,
            emissive_texture: emission.1,
            normal_texture: normal.0,
            normal_scale: if normal.0.is_some() { normal.1 } else { 1.0 },
            alpha,
            double_sided,
            open_behind: false,
            clearcoat: layers.0,
            sheen: layers.1,
            transmission: layers.2,
            strengths,
        },
    )
}

/// Rotations, scales from a thousandth to a thousand, mirrors and shears.
fn transform() -> impl Strategy<Value = Mat4> {
    let size = || {
        (0.1..1.0_f32, -3..4_i32, any::<bool>())
            .prop_map(|(m, e, mirrored)| m * 10.0_f32.powi(e) * if mirrored { -1.0 } else { 1.0 })
    };
    let angle = || -3.2..3.2_f32;
    let placed = ([size(), size(), size()], [angle(), angle(), angle()], point()).prop_map(
        |(scale, [a, b, c], translation)| {
            let rotation = Quat::from_euler(EulerRot::XYZ, a, b, c);
            Mat4::from_scale_rotation_translation(Vec3::from_array(scale), rotation, translation)
        },
    );
    let sheared = (point(), point(), point(), point()).prop_map(|(x, y, z, translation)| {
        Mat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), translation.extend(1.0))
    });
    prop_oneof![Just(Mat4::IDENTITY), placed, sheared]
        // Rounding may change the sign of small determinants.
        .prop_filter("flattened", |m| m.determinant().abs() > 1e-9)
}

fn instance(meshes: usize, materials: usize) -> impl Strategy<Value = Instance> {
    (name(), 0..meshes, 0..materials, transform(), any::<[bool; 6]>()).prop_map(
        |(name, mesh, material, world_from_local, [is_static, is_voxelized, a, b, c, d])| {
            Instance {
                name,
                mesh,
                material,
                world_from_local,
                is_static,
                is_voxelized,
                is_hidden: a && b,
                is_backdrop: c && d,
            }
        },
    )
}

fn light() -> impl Strategy<Value = Light> {
    let kind = prop_oneof![
        (amount(), unit()).prop_map(|(intensity, angular_radius_rad)| Light {
            kind: LightKind::Directional,
            intensity,
            angular_radius_rad,
            ..Light::default()
        }),
        amount().prop_map(|intensity| Light { intensity, ..Light::default() }),
        (amount(), unit(), 0.001..=std::f32::consts::FRAC_PI_2).prop_map(
            |(intensity, part, outer_angle_rad)| Light {
                kind: LightKind::Spot,
                intensity,
                inner_angle_rad: outer_angle_rad * part,
                outer_angle_rad,
                ..Light::default()
            }
        ),
    ];
    let attenuation = (amount(), amount(), 0.1..1.0_f32);
    let attenuation = attenuation.prop_map(|(constant, linear, quadratic)| Attenuation {
        constant,
        linear,
        quadratic,
    });
    let range = option::of(1e-3..1e4_f32);
    let place = (point(), direction(), unit(), range);
    (name(), kind, rgb(0.0..20.0_f32), place, option::of(attenuation)).prop_map(
        |(name, light, color, (position, direction, radius_m, range_m), attenuation)| Light {
            name,
            color,
            position,
            direction,
            radius_m,
            range_m: range_m.filter(|_| !light.kind.is_parallel()),
            attenuation,
            ..light
        },
    )
}

fn camera() -> impl Strategy<Value = Camera> {
    (name(), point(), direction(), direction(), 0.01..3.0_f32, 1e-4..1.0_f32, any::<bool>())
        .prop_map(|(name, position, forward, towards, vertical_fov_rad, near_m, upright)| {
            let level = towards.as_dvec3()
                - forward.as_dvec3() * forward.as_dvec3().dot(towards.as_dvec3());
            let up = if upright { towards } else { level.as_vec3().normalize_or(Vec3::Y) };
            Camera { name, position, forward, up, vertical_fov_rad, near_m }
        })
}

fn grid() -> impl Strategy<Value = Bounds> {
    (point(), amount(), amount(), 0.1..9.0_f32)
        .prop_map(|(min, x, y, z)| Bounds { min, max: min + Vec3::new(x, y, z) })
}

fn environment() -> impl Strategy<Value = Environment> {
    let map = (name(), 1..5_u32, 1..4_u32).prop_flat_map(|(name, width, height)| {
        let texel = [amount(), amount(), amount()];
        vec(texel, (width * height) as usize).prop_map(move |rgb| {
            Arc::new(EnvironmentMap {
                name: name.clone(),
                width,
                height,
                rgb,
                ..EnvironmentMap::default()
            })
        })
    });
    (rgb(0.0..1e5_f32), option::of(map), signed())
        .prop_map(|(radiance, map, rotation_rad)| Environment { radiance, map, rotation_rad })
}
