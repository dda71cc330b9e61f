//! Files that follow the format, made in code.

use glam::{Vec2, Vec3};
use lumivox_scene::{AlphaMode, Filter, LightKind, Wrap};
use serde_json::json;

use crate::common::{File, load, shading, textured_cube, world_triangles};

#[test]
fn a_triangle_gets_all_attributes() {
    let scene = File::triangle().load().unwrap();
    assert_eq!(scene.name, "scene");
    assert_eq!(scene.triangle_count(), 1);
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.name, "thing");
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
    assert_eq!(mesh.uvs, [Vec2::ZERO; 3]);
    assert!(mesh.tangents.iter().all(|t| t.truncate().dot(Vec3::Z) == 0.0));
    assert_eq!(scene.instances[0].name, "stand");
    // Without a material: matte grey instead of glTF's white metal, with a warning.
    let matte = shading(&scene, 0);
    assert!((matte.metallic, matte.specular, matte.base_color.x) == (0.0, 0.0, 0.5));
    assert!(scene.notes.warnings[0].contains("matte grey"));
}

#[test]
fn a_textured_cube_is_loaded() {
    for bytes in [textured_cube().glb(), textured_cube().embedded()] {
        let scene = load("cube.gltf", &bytes).unwrap();
        assert_eq!(scene.triangle_count(), 12);
        assert_eq!(scene.bounds().min, Vec3::splat(-1.0));
        let (material, pbr) = (&scene.materials[0], shading(&scene, 0));
        assert_eq!(material.name, "paint");
        assert_eq!(material.alpha, AlphaMode::Mask { cutoff: 0.3 });
        assert!(material.double_sided && (material.normal_scale - 0.5).abs() < 1e-6);
        assert!((pbr.metallic, pbr.roughness, pbr.ior, pbr.specular) == (0.25, 0.5, 1.5, 1.0));
        assert_eq!(pbr.base_color_texture, material.normal_texture);
        let texture = &scene.textures[pbr.base_color_texture.unwrap().texture];
        assert_eq!((texture.width, texture.height, scene.textures.len()), (2, 2, 1));
        assert_eq!(texture.rgba8[12..], [9, 8, 7, 6]);
        assert_eq!(texture.sampler.wrap_u, Wrap::ClampToEdge);
        assert_eq!(texture.sampler.wrap_v, Wrap::MirroredRepeat);
        assert_eq!(texture.sampler.magnify, Filter::Nearest);
        assert_eq!(texture.sampler.minify, Filter::Linear);
        for ([a, b, c], normal) in world_triangles(&scene) {
            assert!((b - a).cross(c - a).normalize().dot(normal) > 0.999);
        }
        for (t, n) in scene.meshes[0].tangents.iter().zip(&scene.meshes[0].normals) {
            assert!(t.truncate().dot(*n).abs() < 1e-5 && t.w.abs() == 1.0);
        }
    }
}

#[test]
fn lights_take_their_place_from_nodes() {
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    file.json["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "name": "sun", "intensity": 1000, "color": [1, 0.5, 0.25] },
        { "type": "point", "intensity": 40, "range": 7 },
        { "type": "spot", "intensity": 5, "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.6 } },
    ] } });
    // A rotation by 90 degrees about x turns -z to -y.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    for light in 0..3 {
        file.node(
            json!({
                "translation": [1, 2, 3], "rotation": [-half, 0, 0, half], "scale": [3, 3, 3],
                "extensions": { "KHR_lights_punctual": { "light": light } },
            }),
            true,
        );
    }
    let scene = file.load().unwrap();
    assert_eq!(scene.lights.len(), 3);
    let sun = &scene.lights[0];
    assert_eq!(sun.name, "sun");
    assert_eq!(sun.color, Vec3::new(1.0, 0.5, 0.25));
    assert!((sun.direction - Vec3::NEG_Y).length() < 1e-6, "{}", sun.direction);
    assert_eq!((sun.kind, sun.intensity), (LightKind::Directional, 1000.0));
    let lamp = &scene.lights[1];
    assert_eq!((lamp.kind, lamp.intensity), (LightKind::Point, 40.0));
    assert_eq!((lamp.range_m, lamp.position), (Some(7.0), Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(scene.lights[2].cone_rad(), Some([0.2, 0.6]));
    // An inner angle that exceeds the outer one by rounding means a hard edge.
    let spot = &mut file.json["extensions"]["KHR_lights_punctual"]["lights"][2]["spot"];
    spot["innerConeAngle"] = json!(0.600_001);
    let scene = file.load().unwrap();
    assert_eq!(scene.lights[2].cone_rad(), Some([0.6, 0.6]));
}

#[test]
fn cameras_take_their_place_from_nodes() {
    let mut file = File::triangle();
    file.push(
        "cameras",
        json!({ "type": "perspective", "name": "eye", "perspective": { "yfov": 0.9, "znear": 0.2 } }),
    );
    let flat = json!({ "xmag": 1, "ymag": 1, "zfar": 9, "znear": 0.1 });
    file.push("cameras", json!({ "type": "orthographic", "orthographic": flat }));
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // A rotation by 90 degrees about y turns -z to -x.
    let node = json!({ "camera": 0, "translation": [5, 1, 0], "rotation": [0, half, 0, half] });
    file.node(node, true);
    file.node(json!({ "camera": 1 }), true);
    let scene = file.load().unwrap();
    assert_eq!(scene.cameras.len(), 1);
    let camera = &scene.cameras[0];
    assert!((camera.forward - Vec3::NEG_X).length() < 1e-6, "{}", camera.forward);
    assert!((camera.up - Vec3::Y).length() < 1e-6);
    assert_eq!(camera.position, Vec3::new(5.0, 1.0, 0.0));
    assert!((camera.vertical_fov_rad, camera.near_m) == (0.9, 0.2));
    assert!(scene.notes.warnings.join(" ").contains("perspective"), "{:?}", scene.notes.warnings);
}

#[test]
fn transforms_multiply_down_the_hierarchy() {
    let mut file = File::triangle();
    file.json["nodes"][0]["translation"] = json!([1, 0, 0]);
    file.node(json!({ "children": [0], "scale": [2, 3, 4], "translation": [10, 20, 30] }), false);
    file.json["scenes"][0]["nodes"] = json!([1]);
    let scene = file.load().unwrap();
    let bounds = scene.bounds();
    assert_eq!(bounds.min, Vec3::new(12.0, 20.0, 30.0));
    assert_eq!(bounds.max, Vec3::new(14.0, 23.0, 30.0));
}

#[test]
fn only_the_default_scene_is_loaded() {
    let mut file = File::triangle();
    file.node(json!({ "mesh": 0, "translation": [9, 0, 0] }), false);
    assert_eq!(file.load().unwrap().instances.len(), 1);
    file.json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [0, 1] }]);
    file.json["scene"] = json!(1);
    let scene = file.load().unwrap();
    assert_eq!((scene.instances.len(), scene.meshes.len()), (2, 1));
    // Without scenes, all root nodes are shown.
    file.json.as_object_mut().unwrap().remove("scene");
    file.json["scenes"] = json!([]);
    assert_eq!(file.load().unwrap().instances.len(), 2);
}

#[test]
fn mirrored_nodes_keep_front_faces() {
    let mut file = textured_cube();
    file.node(json!({ "mesh": 0, "scale": [-1, 2, 1], "translation": [5, 0, 0] }), true);
    let scene = file.load().unwrap();
    assert_eq!(scene.meshes.len(), 2, "one copy per winding");
    for ([a, b, c], normal) in world_triangles(&scene) {
        assert!((b - a).cross(c - a).normalize().dot(normal) > 0.999);
    }
    // The image's top must follow the texture coordinates, also if the transform mirrors.
    for instance in &scene.instances {
        let (mesh, m) = (&scene.meshes[instance.mesh], instance.world_from_local);
        for [i, j, k] in mesh.triangles() {
            let edge = |x: usize| {
                (
                    m.transform_vector3(mesh.positions[x] - mesh.positions[i]),
                    mesh.uvs[x] - mesh.uvs[i],
                )
            };
            let ((p1, t1), (p2, t2)) = (edge(j), edge(k));
            let along_v = (p2 * t1.x - p1 * t2.x) / t1.perp_dot(t2);
            let tangent = mesh.tangents[i];
            let normal = m.inverse().transpose().transform_vector3(mesh.normals[i]);
            let bitangent = normal.cross(m.transform_vector3(tangent.truncate())) * tangent.w;
            assert!(along_v.dot(bitangent) < 0.0);
        }
    }
}

#[test]
fn degenerate_triangles_are_counted() {
    let mut file = File::triangle();
    let indices = file.indices(&[0, 1, 2, 0, 0, 1, 2, 2, 2]);
    file.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    let scene = file.load().unwrap();
    assert_eq!((scene.triangle_count(), scene.notes.degenerate_triangles), (1, 2));
}
