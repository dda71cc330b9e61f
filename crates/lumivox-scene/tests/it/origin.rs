//! Files in map coordinates, millions of metres from zero.

use glam::{DVec3, Vec3};
use lumivox_scene::{AnimationChoice, LoadOptions, Scene, UpAxis};
use serde_json::json;

use crate::common::{File, load, world_triangles};

/// UTM coordinates of a place, with height and "north" as y and z.
const PLACE: [f64; 3] = [500_123.457, 412.25, 4_649_776.891];

fn at(offset: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| PLACE[axis] + offset[axis])
}

/// Fails unless the triangle of [`File::triangle`] is at [`PLACE`], to a tenth of a millimetre,
/// with a warning.
#[track_caller]
fn is_in_place(scene: &Scene) {
    let corners = world_triangles(scene)[0].0;
    for (corner, expected) in corners.into_iter().zip([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    {
        let off = corner.as_dvec3() + scene.origin - DVec3::from(at(expected));
        assert!(off.length() < 1e-4, "{corner} at {} is off by {off}", scene.origin);
    }
    assert!(corners[0].length() < 2000.0, "{}", corners[0]);
    let told = scene.notes.warnings.join("; ");
    assert!(told.contains("far from zero"), "{told}");
}

#[test]
fn text_formats_keep_large_coordinates() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(at);
    let lines = |word: &str| corners.map(|[x, y, z]| format!("{word} {x} {y} {z}\n")).concat();
    // The first vertex is unused.
    let obj = format!("v 0 0 0\n{}f 2 3 4\n", lines("v"));
    let stl = format!(
        "solid a\nfacet normal 0 0 1\nouter loop\n{}endloop\nendfacet\nendsolid\n",
        lines("vertex")
    );
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n{}3 0 1 2\n",
        lines("").replace("\n ", "\n")
    );
    for (name, text) in [("a.obj", obj), ("a.stl", stl), ("a.ply", ply)] {
        let scene = load(name, text.as_bytes()).unwrap();
        is_in_place(&scene);
        assert!(!scene.notes.warnings.iter().any(|told| told.contains("thousandths")), "{name}");
    }
}

#[test]
fn nodes_keep_large_coordinates_at_rest_and_in_motion() {
    let mut by_node = File::triangle();
    by_node.json["nodes"][0]["translation"] = json!(PLACE);
    is_in_place(&by_node.load().unwrap());

    let mut by_matrix = File::triangle();
    let [x, y, z] = PLACE;
    by_matrix.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1]);
    is_in_place(&by_matrix.load().unwrap());

    // As in files in millimetres with z up: a root that rotates and scales, and a child with the
    // position.
    let mut below = File::triangle();
    let turn = json!([-0.707_106_781_186_547_5, 0, 0, 0.707_106_781_186_547_5]);
    below.json["nodes"][0]["translation"] = json!([1e3 * x, -1e3 * z, 1e3 * y]);
    below.json["nodes"][0]["scale"] = json!([1000, 1000, 1000]);
    below.json["nodes"][0]["rotation"] =
        json!([0.707_106_781_186_547_5, 0, 0, 0.707_106_781_186_547_5]);
    below.node(json!({ "children": [0], "scale": [0.001, 0.001, 0.001], "rotation": turn }), false);
    below.json["scenes"][0]["nodes"] = json!([1]);
    is_in_place(&below.load().unwrap());

    let mut moving = by_node.clone();
    let keys = moving
        .vectors(&[PLACE.map(|place| place as f32), at([0.0, 2.0, 0.0]).map(|place| place as f32)]);
    moving.animation("lift", &[0.0, 1.0], &[(0, "translation", "LINEAR", keys)]);
    let mut scene = moving.load().unwrap();
    is_in_place(&scene);
    scene.pose(AnimationChoice::One(0), 1.0).unwrap();
    let corner = world_triangles(&scene)[0].0[0].as_dvec3() + scene.origin;
    // The file stores keys as 32-bit floats.
    assert!((corner - DVec3::from(at([0.0, 2.0, 0.0]))).length() < 0.3, "{corner}");
}

/// A concave pentagon of 20 cm; rounding to f32 would move its corners farther.
#[test]
fn polygons_far_from_zero_are_cut_correctly() {
    let corners = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.2], [0.1, 0.05], [0.0, 0.2]];
    let line = |[x, z]: [f64; 2]| {
        let [x, y, z] = at([x, 0.0, z]);
        format!("v {x:.3} {y:.3} {z:.3}\n")
    };
    let text = corners.map(line).concat() + "f 1 2 3 4 5\n";
    let scene = load("a.obj", text.as_bytes()).unwrap();
    let area: f32 = world_triangles(&scene)
        .iter()
        .map(|([a, b, c], _)| 0.5 * (b - a).cross(c - a).length())
        .sum();
    assert!((area - 0.025).abs() < 1e-4, "{area}");
}

/// LV95 in millimetres, with z up: f32 cannot represent the decimal unit.
#[test]
fn decimal_units_keep_large_coordinates_exact() {
    let text = "v 2600000250 1200000750 0\nv 2600001250 1200000750 0\nv 2600000250 1200001750 0\nf 1 2 3\n";
    let mut options = LoadOptions { up: UpAxis::Z, unit_m: 0.001, ..LoadOptions::default() };
    let scene = Scene::from_memory("a.obj", text.as_bytes(), &mut options).unwrap();
    let corner = world_triangles(&scene)[0].0[0].as_dvec3() + scene.origin;
    let expected = DVec3::new(2_600_000.25, 0.0, -1_200_000.75);
    assert!((corner - expected).length() < 1e-3, "{corner}");
    let [x, y, z] = scene.origin.to_array();
    let told = scene.notes.warnings.join("; ");
    assert!(told.contains(&format!("counts from ({x}, {y}, {z})")), "{told}");
}

#[test]
fn children_of_turning_nodes_keep_large_coordinates() {
    let mut file = File::triangle();
    file.json["nodes"][0]["translation"] = json!(PLACE);
    file.node(json!({ "name": "turntable", "children": [0] }), false);
    file.json["scenes"][0]["nodes"] = json!([1]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let keys = file.vectors(&[[0.0, 0.0, 0.0, 1.0], [0.0, half, 0.0, half]]);
    file.animation("turn", &[0.0, 1.0], &[(1, "rotation", "LINEAR", keys)]);
    let mut scene = file.load().unwrap();
    scene.pose(AnimationChoice::One(0), 1.0).unwrap();
    let corner = world_triangles(&scene)[0].0[0].as_dvec3() + scene.origin;
    let [x, y, z] = PLACE;
    // Rotated by 90 degrees about y.
    assert!((corner - DVec3::new(z, y, -x)).length() < 1.0, "{corner}");
}

#[test]
fn gpu_instances_are_recentred_too() {
    let place = PLACE.map(|place| place as f32);
    let mut copies = File::triangle();
    let translations = copies.vectors(&[place, place]);
    copies.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": translations } } });
    copies.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = copies.load().unwrap();
    let corner = world_triangles(&scene)[0].0[0].as_dvec3() + scene.origin;
    assert_eq!(corner.as_vec3(), Vec3::from_array(place));
    assert!(world_triangles(&scene)[0].0[0].length() < 2000.0, "{}", scene.origin);
}

#[test]
fn precision_lost_in_the_file_is_reported() {
    let mut baked = File::triangle();
    let place = PLACE.map(|place| place as f32);
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
        .map(at)
        .map(|corner| corner.map(|place| place as f32));
    let positions = baked.vectors(&corners);
    baked.json["accessors"][positions]["min"] = json!(place);
    baked.json["accessors"][positions]["max"] =
        json!([corners[1][0], corners[2][1], corners[0][2]]);
    baked.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
    let scene = baked.load().unwrap();
    let corner = world_triangles(&scene)[0].0[1].as_dvec3() + scene.origin;
    assert_eq!(corner.as_vec3(), Vec3::from_array(corners[1]), "as the file has it");
    let told = scene.notes.warnings.join("; ");
    assert!(told.contains("off by up to 250 thousandths"), "{told}");
}

#[cfg(feature = "save")]
#[test]
fn saving_keeps_the_scenes_origin() {
    let mut file = File::triangle();
    file.json["nodes"][0]["translation"] = json!(PLACE);
    file.push(
        "cameras",
        json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }),
    );
    file.node(json!({ "camera": 0, "translation": at([0.0, 0.0, 3.0]) }), true);
    let scene = file.load().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("again.glb");
    scene.save_glb(&path).unwrap();
    let again = Scene::load(&path).unwrap();
    is_in_place(&again);
    let seen_from = |scene: &Scene| scene.cameras[0].position.as_dvec3() + scene.origin;
    assert!((seen_from(&again) - seen_from(&scene)).length() < 1e-4);
    assert!((seen_from(&scene) - DVec3::from(at([0.0, 0.0, 3.0]))).length() < 1e-4);
}

#[test]
fn scenes_near_zero_are_not_recentred() {
    let mut file = File::triangle();
    file.json["nodes"][0]["translation"] = json!([100, 0, -900]);
    let scene = file.load().unwrap();
    assert_eq!(scene.origin, DVec3::ZERO);
    assert_eq!(scene.bounds().min, Vec3::new(100.0, 0.0, -900.0));
    assert!(!scene.notes.warnings.iter().any(|told| told.contains("far from zero")));
}
