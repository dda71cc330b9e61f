//! Equality of scenes, independent of the order of their lists.

use glam::{Vec3, Vec4};
use lumivox_scene::{Camera, Material, Mesh, Scene, Shading, Texture, TextureRef};

/// An instance with everything that it refers to.
#[derive(Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "as the instances that it is made of")]
struct Resolved {
    name: String,
    mesh: Mesh,
    /// The material; its texture indices refer to `textures`.
    material: Material,
    textures: Vec<Texture>,
    world_from_local: [f32; 16],
    is_static: bool,
    is_voxelized: bool,
    is_hidden: bool,
    is_backdrop: bool,
}

fn resolve(scene: &Scene) -> Vec<Resolved> {
    let resolved = |instance: &lumivox_scene::Instance| {
        let mut material = scene.materials[instance.material].clone();
        if let Shading::Unlit(_) = material.shading {
            // Only lit materials use the other fields.
            let Material { name, shading, alpha, double_sided, .. } = material;
            material = Material { name, shading, alpha, double_sided, ..Material::default() };
        }
        let mut textures = Vec::new();
        for reference in references(&mut material).into_iter().flatten() {
            textures.push(scene.textures[reference.texture].clone());
            reference.texture = textures.len() - 1;
        }
        Resolved {
            name: instance.name.clone(),
            mesh: scene.meshes[instance.mesh].clone(),
            material,
            textures,
            world_from_local: instance.world_from_local.to_cols_array(),
            is_static: instance.is_static,
            is_voxelized: instance.is_voxelized,
            is_hidden: instance.is_hidden,
            is_backdrop: instance.is_backdrop,
        }
    };
    scene.instances.iter().map(resolved).collect()
}

fn references(material: &mut Material) -> Vec<Option<&mut TextureRef>> {
    let mut all = vec![
        material.emissive_texture.as_mut(),
        material.normal_texture.as_mut(),
        material.clearcoat.texture.as_mut(),
        material.sheen.texture.as_mut(),
        material.transmission.texture.as_mut(),
    ];
    match &mut material.shading {
        Shading::MetallicRoughness(m) => all.extend([
            m.base_color_texture.as_mut(),
            m.metallic_roughness_texture.as_mut(),
            m.specular_texture.as_mut(),
        ]),
        Shading::Phong(p) => all.extend([p.diffuse_texture.as_mut(), p.specular_texture.as_mut()]),
        Shading::Unlit(u) => all.push(u.color_texture.as_mut()),
    }
    all
}

/// Panics unless `loaded` equals `saved`, except for data that the normal form of `save` leaves
/// out.
pub fn assert_same(saved: &Scene, loaded: &Scene) {
    let mut expected = resolve(saved);
    for instance in &mut expected {
        if instance.mesh.colors.iter().all(|&color| color == Vec4::ONE) {
            instance.mesh.colors.clear();
        }
        let second =
            references(&mut instance.material).into_iter().flatten().any(|r| r.uv_set == 1);
        if !second {
            instance.mesh.uvs1.clear();
        } else if instance.mesh.uvs1.is_empty() {
            instance.mesh.uvs1.clone_from(&instance.mesh.uvs);
        }
    }
    let found = resolve(loaded);
    assert_eq!(expected.len(), found.len());
    for (expected, found) in expected.iter().zip(&found) {
        assert_eq!(expected, found);
    }
    assert_eq!(saved.lights, loaded.lights);
    assert_eq!(saved.environment, loaded.environment);
    assert_eq!(saved.grid_bounds, loaded.grid_bounds);
    assert_eq!(saved.cameras.len(), loaded.cameras.len());
    for (saved, loaded) in saved.cameras.iter().zip(&loaded.cameras) {
        assert_same_camera(saved, loaded);
    }
    // Instances still share data, and nothing was duplicated.
    assert!(meshes(loaded) <= meshes(saved), "{} > {}", meshes(loaded), meshes(saved));
    assert!(loaded.materials.len() <= saved.materials.len());
    assert!(loaded.textures.len() <= saved.textures.len());
}

/// The number of meshes that instances use. Mirrored meshes, and meshes whose material needs other
/// vertex data (texture coordinates, a second set, tangents), count separately.
fn meshes(scene: &Scene) -> usize {
    let used = scene.instances.iter().map(|instance| {
        let material = &scene.materials[instance.material];
        let unlit = matches!(material.shading, Shading::Unlit(_));
        let textures = resolve_textures(material);
        let second = textures.iter().any(|reference| reference.uv_set == 1);
        let bumpy = material.normal_texture.is_some() && !unlit;
        let mirrored = instance.world_from_local.as_dmat4().determinant() < 0.0;
        (instance.mesh, mirrored, second, bumpy, textures.is_empty())
    });
    used.collect::<std::collections::HashSet<_>>().len()
}

/// The textures that have an effect.
fn resolve_textures(material: &Material) -> Vec<TextureRef> {
    match &material.shading {
        Shading::Unlit(unlit) => unlit.color_texture.into_iter().collect(),
        _ => material.textures().collect(),
    }
}

fn assert_same_camera(saved: &Camera, loaded: &Camera) {
    let up = loaded.up;
    assert_eq!(*saved, Camera { up: saved.up, ..loaded.clone() });
    // The writer does not change an up vector whose part along the line of sight is below 1e-6;
    // each product here adds a rounding error of about 1e-7.
    assert!(up.dot(loaded.forward).abs() < 2e-6, "{loaded:?}");
    assert!((up.length() - 1.0).abs() < 2e-6);
    let turned = saved.up.as_dvec3() - up.as_dvec3() * saved.up.as_dvec3().dot(up.as_dvec3());
    // The difference to the saved up vector is along the line of sight, so the roll is unchanged.
    let sideways = saved.forward.as_dvec3().cross(turned).length();
    if saved.up.cross(saved.forward).length() > 0.1 {
        assert!(sideways < 2e-6, "{sideways}");
    }
    if saved.up.dot(saved.forward).abs() < 1e-7 && saved.up != Vec3::ZERO {
        assert_eq!(saved.up, up);
    }
}
