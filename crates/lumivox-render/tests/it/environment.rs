//! Tests of maps as surroundings: directions in the background and in mirrors, and the light on a
//! floor, compared with sums over the map on the CPU.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Mat3, UVec2, Vec3};
use lumivox_render::{Exposure, Picture, RenderSettings, Renderer, View};
use lumivox_scene::sky::{Sky, SkySettings, sky};
use lumivox_scene::{Camera, Environment, EnvironmentMap, Instance, Material, Mesh, Scene};

use crate::common::{gpu, metal, picture};

fn map(width: u32, radiance: impl Fn(Vec3) -> Vec3) -> EnvironmentMap {
    let height = width / 2;
    let mut map = EnvironmentMap { width, height, ..EnvironmentMap::default() };
    map.rgb = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| radiance(map.direction(x as f32 + 0.5, y as f32 + 0.5)).to_array())
        .collect();
    map
}

/// A different colour in each direction, and more light above.
fn colors(direction: Vec3) -> Vec3 {
    1000.0 * (Vec3::splat(1.3) + Vec3::new(direction.x, direction.y, direction.z))
}

/// A disc with an illuminance of `lux`.
fn disc(to: Vec3, radius_rad: f32, lux: f32) -> impl Fn(Vec3) -> Vec3 {
    let radiance = lux / (PI * radius_rad.sin().powi(2));
    let inside = move |d: Vec3| d.dot(to.normalize()) > radius_rad.cos();
    move |d| if inside(d) { Vec3::splat(radiance) } else { Vec3::ZERO }
}

/// A floor of 4 x 4 m and, if `has_plate`, a plate of 1 x 1 m a metre above its centre.
fn scene(material: Material, environment: Environment, has_plate: bool) -> Scene {
    let square = |name: &str, half: f32, y: f32| {
        let corners = [(-half, half), (half, half), (half, -half), (-half, -half)];
        Mesh {
            name: name.to_owned(),
            positions: corners.map(|(x, z)| Vec3::new(x, y, z)).to_vec(),
            normals: vec![Vec3::Y; 4],
            uvs: vec![glam::Vec2::ZERO; 4],
            tangents: vec![Vec3::X.extend(1.0); 4],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Mesh::default()
        }
    };
    let mut scene = Scene { name: "floor".to_owned(), environment, ..Scene::default() };
    scene.materials.push(material);
    let mut plate = Material::diffuse("plate", Vec3::ZERO);
    plate.double_sided = true;
    scene.materials.push(plate);
    let meshes = [square("floor", 2.0, 0.0), square("plate", 0.5, 1.0)];
    for (index, mesh) in meshes.into_iter().enumerate().take(1 + usize::from(has_plate)) {
        scene.instances.push(Instance {
            name: mesh.name.clone(),
            mesh: index,
            material: index,
            ..Instance::default()
        });
        scene.meshes.push(mesh);
    }
    scene.validate().expect("a valid scene");
    scene
}

fn white() -> Material {
    Material::diffuse("white", Vec3::ONE)
}

fn around(map: EnvironmentMap, rotation_rad: f32) -> Environment {
    Environment { radiance: Vec3::ONE, map: Some(Arc::new(map)), rotation_rad }
}

fn render(scene: &Scene, camera: &Camera, settings: &RenderSettings) -> Picture {
    let settings = RenderSettings { exposure: Exposure::Stops(0.0), ..settings.clone() };
    let gpu = gpu();
    let mut quiet = |_| {};
    let new = Renderer::new(&gpu, scene, Some(camera), settings, &mut quiet);
    picture(&mut pollster::block_on(new).expect("a renderer"))
}

fn small(view: View) -> RenderSettings {
    let size = UVec2::new(65, 65);
    RenderSettings {
        size,
        resolution: 32,
        frames: 4,
        view,
        bounces: 1,
        ..RenderSettings::default()
    }
}

fn at(picture: &Picture, x: u32, y: u32) -> Vec3 {
    let [r, g, b, _] = picture.hdr[(y * picture.size.x + x) as usize];
    Vec3::new(r, g, b)
}

/// The direction in the map that corresponds to one in the world.
fn in_map(direction: Vec3, rotation_rad: f32) -> Vec3 {
    Mat3::from_rotation_y(-rotation_rad) * direction
}

fn close(actual: Vec3, expected: Vec3, share: f32, what: &str) {
    let error = (actual - expected).abs().max_element() / expected.max_element();
    assert!(error <= share, "{what}: {actual}, not {expected} (off by {error})");
}

/// The background is upright, not mirrored, and turned by the given angle: centre, right and top of
/// the picture, for several view directions.
#[test]
fn the_background_shows_the_map_in_its_orientation() {
    let fov = 1.2_f32;
    for (forward, rotation_rad) in [
        (Vec3::NEG_Z, 0.0),
        (Vec3::X, 0.0),
        (Vec3::new(0.3, 0.4, 0.8), 0.0),
        (Vec3::NEG_Z, 0.9),
        (Vec3::new(-0.6, -0.2, 0.5), -2.5),
    ] {
        // Far away, so that the floor is not visible. The camera's position must not matter.
        let position = Vec3::new(300.0, 200.0, -250.0);
        let camera = Camera::look_at(position, position + forward, fov);
        let scene = scene(white(), around(map(256, colors), rotation_rad), false);
        let picture = render(&scene, &camera, &RenderSettings { frames: 1, ..small(View::Final) });
        let forward = forward.normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        for (x, y) in [(32, 32), (60, 32), (32, 5), (10, 55)] {
            let scale = 2.0 * (0.5 * fov).tan() / 65.0;
            let (across, above) = ((x as f32 - 32.0) * scale, (32.0 - y as f32) * scale);
            let direction = (forward + across * right + above * up).normalize();
            // The tolerance is for half floats, texels of 1.5 degrees, and a jitter of half a
            // pixel.
            let expected = colors(in_map(direction, rotation_rad));
            close(at(&picture, x, y), expected, 0.02, &format!("{forward} {rotation_rad} {x} {y}"));
        }
    }
}

/// A smooth floor mirrors the map.
#[test]
fn a_mirror_reflects_the_map_in_its_orientation() {
    let rotation_rad = 0.6;
    let position = Vec3::new(2.0, 2.0, 3.0);
    let camera = Camera::look_at(position, Vec3::ZERO, 0.3);
    let scene = scene(metal(0.0), around(map(256, colors), rotation_rad), false);
    let picture = render(&scene, &camera, &small(View::Final));
    let reflected = Vec3::new(-position.x, position.y, -position.z).normalize();
    let expected = colors(in_map(reflected, rotation_rad));
    close(at(&picture, 32, 32), expected, 0.03, "mirror");
}

/// A white open floor reflects E / pi, whatever part of the map became a light.
#[test]
fn an_open_floor_gets_the_maps_irradiance() {
    let to_sun = Vec3::new(0.5, 0.7, 0.3).normalize();
    let sun = disc(to_sun, 0.02, 9000.0);
    let with_sun = map(512, |d| colors(d) + sun(d));
    let camera = Camera::look_at(Vec3::new(0.0, 3.0, 0.01), Vec3::ZERO, 0.3);
    for (name, map) in [("gradient", map(128, colors)), ("sun", with_sun)] {
        let expected = map.irradiance(Vec3::Y) / PI;
        for rotation_rad in [0.0, 2.0] {
            // Includes direct light of the sun, the only other source.
            let scene = scene(white(), around(map.clone(), rotation_rad), false);
            let picture = render(&scene, &camera, &small(View::Final));
            let pixels = picture.hdr.iter().map(|p| Vec3::new(p[0], p[1], p[2]));
            let mean = pixels.sum::<Vec3>() / picture.hdr.len() as f32;
            close(mean, expected, 0.03, name);
        }
    }
}

/// The shadow of a plate is sharp, falls away from the bright texels, and turns with the map.
#[test]
fn shadows_fall_away_from_the_sun() {
    let to_sun = Vec3::new(1.0, 1.0, 0.0).normalize();
    let sun = disc(to_sun, 0.05, 50_000.0);
    let map = map(256, |d| Vec3::splat(100.0) + sun(d));
    // From the texels, minus the radiance behind the sun.
    let lit = (map.irradiance(to_sun).x / PI - 100.0) * to_sun.y;
    let gpu = gpu();
    let mut quiet = |_| {};
    for rotation_rad in [0.0, PI / 2.0] {
        // Seen from the sun, the plate's centre covers this point of the floor.
        let there = Mat3::from_rotation_y(rotation_rad) * Vec3::new(-1.0, 0.0, 0.0);
        let scene = scene(white(), around(map.clone(), rotation_rad), true);
        let camera = |to: Vec3| Camera::look_at(to + Vec3::new(0.0, 0.9, 0.01), to, 0.2);
        let settings = RenderSettings { exposure: Exposure::Stops(0.0), ..small(View::Direct) };
        let first = camera(there);
        let new = Renderer::new(&gpu, &scene, Some(&first), settings, &mut quiet);
        let mut renderer = pollster::block_on(new).expect("a renderer");
        let mut middle = |to: Vec3| {
            renderer.set_camera(camera(to));
            at(&picture(&mut renderer), 32, 32).x
        };
        let shadow = middle(there);
        assert!(shadow < 1e-3 * lit, "shadow at {there}: {shadow}");
        for beside in [-there, there + 0.6 * there.cross(Vec3::Y), there * 1.6, there * 0.42] {
            let found = middle(beside);
            assert!((found / lit - 1.0).abs() < 0.03, "light at {beside}: {found}, not {lit}");
        }
    }
}

/// The sun of a map is reflected once: by the highlight of its light on rough surfaces, as an image
/// in mirrors.
#[test]
#[ignore = "slow: over three seconds"]
fn the_sun_is_reflected_once() {
    let radius_rad = 0.06_f32;
    let to_sun = Vec3::new(0.0, 1.0, -1.0).normalize();
    let sun = disc(to_sun, radius_rad, 2000.0);
    let radiance = 2000.0 / (PI * radius_rad.sin().powi(2));
    // Bright enough that the unit of radiance lets a half float store the sun in a mirror.
    let around_it = 1000.0;
    let map = map(512, |d| Vec3::splat(around_it) + sun(d));
    let camera = Camera::look_at(Vec3::new(0.0, 2.0, 2.0), Vec3::ZERO, 0.5);
    let reflected = |roughness: f32| {
        let scene = scene(metal(roughness), around(map.clone(), 0.0), false);
        let settings = RenderSettings { frames: 16, ..small(View::Final) };
        render(&scene, &camera, &settings)
    };
    // The disc in the mirror has the sun's radiance and size.
    let mirror = reflected(0.0);
    let disc = at(&mirror, 32, 32).x;
    assert!(
        (disc / (around_it + radiance) - 1.0).abs() < 0.03,
        "the disc has {disc}, not {radiance}"
    );
    let pixel_rad = 2.0 * 0.25_f32.tan() / 65.0;
    let sum = |picture: &Picture| picture.hdr.iter().map(|p| p[0] - around_it).sum::<f32>();
    let lit = sum(&mirror) / radiance;
    let expected = PI * (radius_rad / pixel_rad).powi(2);
    assert!((lit / expected - 1.0).abs() < 0.06, "{lit} pixels of sun, not {expected}");
    // Rougher metal shows the same light as a highlight. It may differ by the part of the wider
    // lobe outside the picture, and because a disc is not a point.
    let rough = reflected(0.25);
    let share = sum(&rough) / sum(&mirror);
    assert!((0.75..1.1).contains(&share), "the highlight has {share} of the disc's light");
}

/// A sky and its sun give a floor the irradiance computed from them.
#[test]
fn a_sky_lights_the_floor_in_real_units() {
    let settings = SkySettings {
        sun_direction: Vec3::new(1.0, 1.5, 0.5),
        width: 256,
        ..SkySettings::default()
    };
    let Sky { map, sun } = sky(&settings).expect("a sky");
    let sun = sun.expect("it is up");
    let expected = (map.irradiance(Vec3::Y) + sun.color * sun.intensity * -sun.direction.y) / PI;
    let mut scene = scene(white(), around(map, 0.0), false);
    scene.lights.push(sun);
    let camera = Camera::look_at(Vec3::new(0.0, 3.0, 0.01), Vec3::ZERO, 0.3);
    let picture = render(&scene, &camera, &small(View::Final));
    let pixels = picture.hdr.iter().map(|p| Vec3::new(p[0], p[1], p[2]));
    let mean = pixels.sum::<Vec3>() / picture.hdr.len() as f32;
    close(mean, expected, 0.02, "floor");
}
