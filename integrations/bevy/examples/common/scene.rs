//! Lumivox's built-in scenes as Bevy's entities, in Bevy's units.

use std::f32::consts::PI;

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageSampler, ImageSamplerDescriptor};
use bevy::mesh::{Indices, PrimitiveTopology, UvChannel};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use lumivox_scene::{self as lumivox, Scene, Shading};

pub struct Spawned {
    /// An entity for each instance, in the scene's order.
    pub instances: Vec<Entity>,
    pub lights: Vec<Entity>,
}

/// A built-in scene.
///
/// # Panics
/// If no scene has this name.
pub fn builtin(name: &str) -> Scene {
    lumivox::builtin::scene(name).expect("a built-in scene")
}

/// Spawns meshes and lights.
pub fn spawn(world: &mut World, scene: &Scene) -> Spawned {
    let textures: Vec<Handle<Image>> = (0..scene.textures.len())
        .map(|index| {
            let image = image(&scene.textures[index]);
            world.resource_mut::<Assets<Image>>().add(image)
        })
        .collect();
    let materials: Vec<Handle<StandardMaterial>> = scene
        .materials
        .iter()
        .map(|given| {
            let material = material(given, &textures);
            world.resource_mut::<Assets<StandardMaterial>>().add(material)
        })
        .collect();
    let meshes: Vec<Handle<Mesh>> = scene
        .meshes
        .iter()
        .map(|given| world.resource_mut::<Assets<Mesh>>().add(mesh(given)))
        .collect();
    let instances = scene
        .instances
        .iter()
        .map(|instance| {
            let transform = Transform::from_matrix(instance.world_from_local);
            let parts = (
                Mesh3d(meshes[instance.mesh].clone()),
                MeshMaterial3d(materials[instance.material].clone()),
                transform,
            );
            world.spawn(parts).id()
        })
        .collect();
    let lights = scene.lights.iter().map(|given| light(world, given)).collect();
    Spawned { instances, lights }
}

/// The transform and projection of the scene's first camera.
pub fn camera(scene: &Scene) -> (Transform, Projection) {
    let given = &scene.cameras[0];
    let perspective = PerspectiveProjection {
        fov: given.vertical_fov_rad,
        near: given.near_m,
        ..PerspectiveProjection::default()
    };
    (Transform::from_matrix(given.world_from_camera()), Projection::Perspective(perspective))
}

/// A matt material of a linear colour.
pub fn matt(materials: &mut Assets<StandardMaterial>, rgb: [f32; 3]) -> Handle<StandardMaterial> {
    let base_color = Color::linear_rgb(rgb[0], rgb[1], rgb[2]);
    materials.add(StandardMaterial { base_color, perceptual_roughness: 0.9, ..default() })
}

pub fn mesh(given: &lumivox::Mesh) -> Mesh {
    let list = |vectors: &[Vec3]| vectors.iter().map(Vec3::to_array).collect::<Vec<_>>();
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::all())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, list(&given.positions))
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, list(&given.normals))
        .with_inserted_indices(Indices::U32(given.indices.clone()));
    if !given.uvs.is_empty() {
        let uvs: Vec<[f32; 2]> = given.uvs.iter().map(Vec2::to_array).collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    }
    mesh
}

fn material(given: &lumivox::Material, textures: &[Handle<Image>]) -> StandardMaterial {
    let texture = |given: &Option<lumivox::TextureRef>| {
        given.as_ref().map(|given| textures[given.texture].clone())
    };
    let mut material = StandardMaterial {
        // In cd/m².
        emissive: LinearRgba::from_vec3(given.emissive),
        emissive_exposure_weight: 1.0,
        emissive_texture: texture(&given.emissive_texture),
        normal_map_texture: None,
        double_sided: given.double_sided,
        cull_mode: None,
        alpha_mode: match given.alpha {
            lumivox::AlphaMode::Opaque => AlphaMode::Opaque,
            lumivox::AlphaMode::Mask { cutoff } => AlphaMode::Mask(cutoff),
            lumivox::AlphaMode::Blend => AlphaMode::Blend,
        },
        base_color_channel: UvChannel::Uv0,
        ..StandardMaterial::default()
    };
    if let Shading::MetallicRoughness(shading) = &given.shading {
        let [red, green, blue, alpha] = shading.base_color.to_array();
        material.base_color = Color::linear_rgba(red, green, blue, alpha);
        material.base_color_texture = texture(&shading.base_color_texture);
        material.metallic_roughness_texture = texture(&shading.metallic_roughness_texture);
        material.metallic = shading.metallic;
        material.perceptual_roughness = shading.roughness;
        // 0.5 is glTF's dielectric of 4 %.
        material.reflectance = 0.5 * shading.specular.sqrt();
        if let Some(used) = &shading.base_color_texture {
            material.uv_transform = used.transform;
        }
    }
    material
}

fn image(given: &lumivox::Texture) -> Image {
    let size = Extent3d { width: given.width, height: given.height, depth_or_array_layers: 1 };
    let pixels = &given.rgba8;
    let mut image = Image::new(
        size,
        TextureDimension::D2,
        pixels.to_vec(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::all(),
    );
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        ..ImageSamplerDescriptor::linear()
    });
    image
}

fn light(world: &mut World, given: &lumivox::Light) -> Entity {
    let color = Color::linear_rgb(given.color.x, given.color.y, given.color.z);
    let transform = Transform::from_translation(given.position)
        .looking_to(given.direction, given.direction.any_orthonormal_vector());
    if given.kind.is_parallel() {
        let sun = DirectionalLight {
            color,
            illuminance: given.intensity,
            shadow_maps_enabled: true,
            ..DirectionalLight::default()
        };
        world.spawn((sun, transform)).id()
    } else if let Some([inner_angle, outer_angle]) = given.cone_rad() {
        let lamp = SpotLight {
            color,
            intensity: 4.0 * PI * given.intensity,
            range: given.range_m.unwrap_or(1e3),
            radius: given.radius_m,
            inner_angle,
            outer_angle,
            shadow_map_near_z: 0.01,
            shadow_maps_enabled: true,
            ..SpotLight::default()
        };
        world.spawn((lamp, transform)).id()
    } else {
        let lamp = PointLight {
            color,
            intensity: 4.0 * PI * given.intensity,
            range: given.range_m.unwrap_or(1e3),
            radius: given.radius_m,
            // Lamps hang closer to their bodies than Bevy's default of 0.1 m.
            shadow_map_near_z: 0.01,
            shadow_maps_enabled: true,
            ..PointLight::default()
        };
        world.spawn((lamp, transform)).id()
    }
}
