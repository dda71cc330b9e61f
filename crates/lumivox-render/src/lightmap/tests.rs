use glam::{Mat4, Vec2};
use lumivox_scene::builtin::shapes::{quad, sphere};
use lumivox_scene::{Instance, Material, Mesh, builtin};

use super::*;

const UP: Vec3 = Vec3::Y;

/// A level square of two metres, whose texture is a unit square, as first and second set.
fn floor() -> Mesh {
    let mut mesh = quad(Vec3::ZERO, Vec3::X, Vec3::NEG_Z);
    "floor".clone_into(&mut mesh.name);
    mesh.uvs1.clone_from(&mesh.uvs);
    mesh
}

fn scene(meshes: impl IntoIterator<Item = Mesh>) -> Scene {
    let meshes: Vec<Mesh> = meshes.into_iter().collect();
    let instance = |(mesh, of): (usize, &Mesh)| Instance {
        name: of.name.clone(),
        mesh,
        ..Instance::default()
    };
    Scene {
        instances: meshes.iter().enumerate().map(instance).collect(),
        materials: vec![Material::diffuse("white", Vec3::ONE)],
        meshes,
        ..Scene::default()
    }
}

fn plan(scene: &Scene, edge: u32) -> LightmapPlan {
    LightmapPlan::new(scene, 1, Resolution::Texels(edge)).unwrap()
}

/// Light that depends on the place.
fn smooth(at: Vec3) -> Vec3 {
    Vec3::new(2.0 + at.x, 3.0 + at.y, 4.0 + at.z)
}

#[test]
fn each_texel_is_sampled_at_its_centre_on_the_surface() {
    let scene = scene([floor()]);
    let plan = plan(&scene, 16);
    assert_eq!((plan.places().len(), plan.buried(), plan.is_packed()), (256, 0, false));
    for (texel, &(at, normal)) in plan.places().iter().enumerate() {
        let (u, v) = ((texel % 16) as f32 + 0.5, (texel / 16) as f32 + 0.5);
        // u grows to the right, v to the viewer.
        let expected = Vec3::new(u / 8.0 - 1.0, 0.0, v / 8.0 - 1.0);
        assert!(at.abs_diff_eq(expected, 1e-5) && normal == UP, "{texel}: {at}, {normal}");
    }
    assert!((plan.nodes()[0].texels_per_metre - 8.0).abs() < 1e-4);
    let light: Vec<Vec3> = plan.places().iter().map(|place| smooth(place.0)).collect();
    let map = plan.map(&light);
    for (texel, lux) in map.light().iter().zip(&light) {
        assert!(texel.abs_diff_eq(*lux / std::f32::consts::PI, 1e-6), "{texel}");
    }
}

#[test]
fn texels_beside_a_triangle_are_sampled_on_it() {
    for mirrored in [false, true] {
        let mut mesh = floor();
        mesh.indices.truncate(3);
        for uv in &mut mesh.uvs1 {
            *uv = 0.1 + 0.77 * *uv;
            if mirrored {
                uv.x = 1.0 - uv.x;
            }
        }
        let corners = [0, 1, 2].map(|i| 16.0 * mesh.uvs1[i]);
        let scene = scene([mesh]);
        let plan = plan(&scene, 16);
        let is_covered = |x: usize, y: usize| plan.texels[16 * y + x].is_covered();
        // Fine points of the triangle: the texel of each must be covered.
        for (i, j) in (0..=100).flat_map(|i| (0..=100 - i).map(move |j| (i, j))) {
            let (s, t) = (i as f32 / 100.0, j as f32 / 100.0);
            let at = corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t;
            assert!(is_covered(at.x as usize, at.y as usize), "{at}");
        }
        assert!(plan.covered() < 140, "{}", plan.covered());
        for &(at, _) in plan.places() {
            let inside = at.x + at.z;
            assert!(at.abs().max_element() <= 1.0 && at.y == 0.0 && inside >= -1e-5, "{at}");
        }
    }
}

#[test]
fn nodes_with_common_coordinates_get_parts_of_the_map() {
    let mut scene = scene([floor()]);
    let far = |x: f32, scale: f32| {
        Mat4::from_translation(Vec3::X * x) * Mat4::from_scale(Vec3::splat(scale))
    };
    for (x, scale) in [(10.0, 2.0), (20.0, 1.0)] {
        let world_from_local = far(x, scale);
        scene.instances.push(Instance { world_from_local, ..scene.instances[0].clone() });
    }
    let plan = plan(&scene, 128);
    assert!(plan.is_packed());
    let rects: Vec<_> = plan.nodes().iter().map(|node| node.rect).collect();
    for (i, a) in rects.iter().enumerate() {
        assert!(a[0] > 0.0 && a[1] > 0.0 && a[2] < 1.0 && a[3] < 1.0, "{a:?}");
        for b in &rects[..i] {
            let is_apart = a[2] < b[0] || b[2] < a[0] || a[3] < b[1] || b[3] < a[1];
            assert!(is_apart, "{a:?} {b:?}");
        }
    }
    // They have the same density, and fill the map.
    let density = plan.nodes()[0].texels_per_metre;
    assert!(density > 18.0, "{density}");
    for node in plan.nodes() {
        assert!((node.texels_per_metre / density - 1.0).abs() < 0.05, "{node:?}");
    }
    // Light of each node is in its part, and not beside it.
    let light: Vec<Vec3> =
        plan.places().iter().map(|(at, _)| Vec3::splat((at.x / 10.0).round())).collect();
    let map = plan.map(&light);
    for (node, rect) in rects.iter().enumerate() {
        let [u0, v0, u1, v1] = rect.map(|share| (share * 128.0).round() as usize);
        for (x, y) in (v0 - 1..=v1).flat_map(|y| (u0 - 1..=u1).map(move |x| (x, y))) {
            let value = map.light()[y * 128 + x].x * std::f32::consts::PI;
            assert!((value - node as f32).abs() < 1e-4, "{node}: {value} at {x}, {y}");
        }
    }

    let by_density = LightmapPlan::new(&scene, 1, Resolution::Density(10.0)).unwrap();
    assert!((60..=72).contains(&by_density.edge()), "{}", by_density.edge());
    assert!((by_density.nodes()[1].texels_per_metre - 10.0).abs() < 0.3);
}

#[test]
fn nodes_with_separate_coordinates_share_the_map() {
    let (mut left, mut right) = (floor(), floor());
    left.uvs1.iter_mut().for_each(|uv| uv.x *= 0.5);
    right.uvs1.iter_mut().for_each(|uv| uv.x = 0.5 + 0.5 * uv.x);
    let scene = scene([left, right]);
    let plan = plan(&scene, 64);
    assert!(!plan.is_packed());
    assert!(plan.nodes().iter().all(|node| node.rect == [0.0, 0.0, 1.0, 1.0]));
    let by_density = LightmapPlan::new(&scene, 1, Resolution::Density(10.0)).unwrap();
    // Eight square metres fill the unit square.
    assert_eq!(by_density.edge(), 32);
}

#[test]
fn unsuitable_coordinates_are_refused_with_a_remedy() {
    let with = |change: fn(&mut Mesh)| {
        let mut mesh = floor();
        change(&mut mesh);
        scene([mesh])
    };
    for (scene, needles) in [
        (with(|mesh| mesh.uvs1.clear()), ["mesh \"floor\"", "TEXCOORD_1", "Lightmap Pack"]),
        (
            with(|mesh| mesh.uvs1.iter_mut().for_each(|uv| *uv *= 3.0)),
            ["mesh \"floor\"", "from [0.0, 0.0] to [3.0, 3.0]", "Lightmap Pack"],
        ),
        (
            with(|mesh| mesh.uvs1.fill(Vec2::splat(0.5))),
            ["mesh \"floor\"", "no area", "Lightmap Pack"],
        ),
        (
            // A second floor above, in the same part of the map.
            with(|mesh| {
                let above: Vec<Vec3> = mesh.positions.iter().map(|at| *at + UP).collect();
                mesh.positions.extend(above);
                mesh.normals.extend_from_within(..);
                mesh.uvs1.extend_from_within(..);
                mesh.indices.extend([4, 5, 6, 4, 6, 7]);
            }),
            ["node \"floor\"", "u = 0.0", "without overlaps"],
        ),
    ] {
        let error = LightmapPlan::new(&scene, 1, Resolution::Texels(64)).err().unwrap().to_string();
        assert!(needles.iter().all(|needle| error.contains(needle)), "{error}");
    }
    let mut moving = scene([floor()]);
    moving.instances[0].is_static = false;
    let nothing = LightmapPlan::new(&moving, 1, Resolution::Texels(64)).err();
    assert_eq!(nothing, Some(LightmapError::Nothing));
    let crowd = scene(vec![floor(); 100]);
    let error = LightmapPlan::new(&crowd, 1, Resolution::Texels(32)).err().unwrap().to_string();
    assert!(error.contains("100 nodes") && error.contains("32 texels"), "{error}");
}

#[test]
fn samples_under_a_box_move_beside_it_or_copy_their_neighbours() {
    let mut scene = scene([floor()]);
    let block = builtin::scene("cornell").unwrap();
    let block = block.meshes[3].clone();
    assert_eq!(block.name, "short block");
    scene.meshes.push(block);
    // It is not baked, but hides the floor: 0.6 m wide, from the middle of a texel to another.
    scene.instances.push(Instance { mesh: 1, is_static: false, ..Instance::default() });
    let plan = plan(&scene, 32);
    assert_eq!(plan.left_out(), 1);
    // Texels are 1/16 m wide. The box reaches to 0.3 m, which is in the fifth from the centre:
    // eight in a row are hidden entirely.
    assert_eq!(plan.buried(), 64);
    for &(at, _) in plan.places() {
        assert!(at.x.abs().max(at.z.abs()) > 0.3, "{at}");
    }
    // Light outside is 1; if a hidden texel were black, its neighbours would be darkened.
    let map = plan.map(&vec![Vec3::splat(std::f32::consts::PI); plan.places().len()]);
    assert!(map.light().iter().all(|light| light.abs_diff_eq(Vec3::ONE, 1e-5)));
}

#[test]
fn both_sides_of_a_seam_agree() {
    // A sphere of eight gores: neighbours in space, apart in the map. Light on it is noisy.
    let mut ball = sphere(1.0, 32);
    "ball".clone_into(&mut ball.name);
    let (mut positions, mut normals, mut uvs, mut indices) = (vec![], vec![], vec![], vec![]);
    for corners in ball.triangles() {
        let middle: Vec2 = corners.map(|i| ball.uvs[i]).iter().sum::<Vec2>() / 3.0;
        let gore = (middle.x * 8.0).floor();
        for corner in corners {
            let uv = ball.uvs[corner];
            let within = (uv.x * 8.0 - gore).clamp(0.0, 1.0);
            uvs.push(Vec2::new((gore + 0.1 + 0.8 * within) / 8.0, 0.05 + 0.9 * uv.y));
            positions.push(ball.positions[corner]);
            normals.push(ball.normals[corner]);
            indices.push(indices.len() as u32);
        }
    }
    let mesh = Mesh { positions, normals, uvs1: uvs, indices, ..ball };
    let scene = scene([mesh]);
    let plan = plan(&scene, 128);
    let noise = |i: usize| 1.0 + 0.1 * ((i as f32 * 12.9898).sin() * 43_758.547).fract();
    let places = plan.places().iter().enumerate();
    let light: Vec<Vec3> = places.map(|(i, (at, _))| smooth(*at) * noise(i)).collect();
    let map = plan.map(&light);
    let seams = map.seams();
    // 16 edges from pole to pole on each of 8 meridians; at the poles, all edges.
    assert_eq!(seams.edges, 8 * 16 + 2 * (32 - 8));
    assert!(seams.before > 0.03 && seams.after < 0.15 * seams.before, "{seams:?}");
    // Inside charts light stays, and nowhere does it change more than noise.
    for (sample, lux) in plan.samples.iter().zip(&light) {
        let ratio = map.light()[sample.texel] * std::f32::consts::PI / *lux;
        assert!((ratio - Vec3::ONE).abs().max_element() < 0.25, "{ratio}");
    }
    let is_inside = |at: usize| (4..12).contains(&(at % 16)) && (16..112).contains(&(at / 128));
    let inside = plan.samples.iter().zip(&light).filter(|(sample, _)| is_inside(sample.texel));
    for (sample, lux) in inside {
        let value = map.light()[sample.texel] * std::f32::consts::PI;
        assert!(value.abs_diff_eq(*lux, 1e-5), "{value} {lux}");
    }
}

#[test]
fn sharp_edges_are_no_seams() {
    let mut wall = quad(Vec3::new(0.0, 1.0, -1.0), Vec3::X, Vec3::Y);
    wall.uvs1.clone_from(&wall.uvs);
    "wall".clone_into(&mut wall.name);
    let scene = scene([floor(), wall]);
    let plan = plan(&scene, 64);
    let light: Vec<Vec3> = plan.places().iter().map(|(_, normal)| normal.abs()).collect();
    assert_eq!(plan.map(&light).seams(), Seams::default());
}

#[test]
fn files_hold_the_rows_from_the_top() {
    let scene = scene([floor()]);
    let plan = plan(&scene, 16);
    let light: Vec<Vec3> = plan.places().iter().map(|place| smooth(place.0)).collect();
    let map = plan.map(&light);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.exr");
    std::fs::write(&path, map.to_exr().unwrap()).unwrap();
    let read = exr::prelude::read_first_rgba_layer_from_file(
        &path,
        |size, _| vec![Vec3::ZERO; size.area()],
        |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * 16 + at.x()] = Vec3::new(r, g, b);
        },
    );
    let pixels = read.unwrap().layer_data.channel_data.pixels;
    for (read, light) in pixels.iter().zip(map.light()) {
        assert!(read.abs_diff_eq(*light, 2e-3), "{read} {light}");
    }
    let (bytes, intensity) = map.to_ktx2();
    assert_eq!(intensity, 1.0);
    let file = ktx2::Reader::new(&bytes).unwrap();
    let header = file.header();
    assert_eq!((header.pixel_width, header.pixel_height, header.pixel_depth), (16, 16, 0));
    let level = file.levels().next().unwrap();
    let (texels, _) = level.data.as_chunks::<8>();
    for (texel, light) in texels.iter().zip(map.light()) {
        let red = half::f16::from_le_bytes([texel[0], texel[1]]).to_f32();
        assert!((red - light.x).abs() < 2e-3, "{red} {light}");
    }
}
