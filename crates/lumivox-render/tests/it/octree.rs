//! Tests that the octree gives the dense volume's picture: the same voxels, the same light, and
//! look-ups that differ only in the last bits.

use glam::{UVec2, Vec3};
use lumivox::{Directionality, VolumeKind};
use lumivox_render::{Gpu, Picture, RenderError, RenderSettings, Renderer, ShadowMethod, View};
use lumivox_scene::{Bounds, Camera, Instance, Material, Scene};

use crate::common::zoo::quad;
use crate::common::{builtin, gpu, picture, renderer, turned};

/// The largest relative difference of a picture's mean (measured: up to 0.0016). At each level,
/// values are rounded to half floats, by the texture unit in one volume and by `pack2x16float` in
/// the other. At the grid's border, the octree has the masks of the cell next to it.
const MAX_BIAS: f64 = 0.003;
/// The largest root mean square difference of its pixels, divided by the mean, after two noisy
/// frames (measured: up to 0.011): by rounding, a ray may hit a wall's edge in only one of the
/// volumes.
const MAX_RMS: f64 = 0.02;

fn settings(volume: VolumeKind) -> RenderSettings {
    RenderSettings {
        size: UVec2::new(80, 60),
        resolution: 64,
        frames: 2,
        bounces: 3,
        shadow_resolution: 512,
        volume,
        ..RenderSettings::default()
    }
}

fn octree() -> VolumeKind {
    VolumeKind::Octree
}

fn rendered(gpu: &Gpu, scene: &str, settings: RenderSettings) -> Picture {
    picture(&mut renderer(gpu, &builtin(scene), settings))
}

/// Bias and root mean square of the difference, as shares of the mean light; absolute for
/// visibility, which is nearly 0 in closed rooms.
fn difference(view: View, a: &Picture, b: &Picture) -> (f64, f64) {
    let luminance = |pixel: &[f32; 4]| f64::from(pixel[0] + pixel[1] + pixel[2]) / 3.0;
    let count = a.hdr.len() as f64;
    let mean = a.hdr.iter().map(luminance).sum::<f64>() / count;
    let mean = if view == View::Occlusion { 1.0 } else { mean };
    let differences = || a.hdr.iter().zip(&b.hdr).map(|(a, b)| luminance(b) - luminance(a));
    let bias = differences().sum::<f64>() / count / mean;
    let rms = (differences().map(|d| d * d).sum::<f64>() / count).sqrt() / mean;
    (bias, rms)
}

#[test]
#[ignore = "slow: over three seconds"]
fn irradiance_agrees_with_the_dense_volume() {
    let gpu = gpu();
    let views = [View::Diffuse, View::Occlusion];
    for (scene, name) in [(turned("cornell"), "cornell, turned"), (builtin("atrium"), "atrium")] {
        let [dense, sparse] = [VolumeKind::Dense, octree()].map(|volume| {
            let settings = RenderSettings { view: views[0], ..settings(volume) };
            let mut renderer = renderer(&gpu, &scene, settings);
            views.map(|view| {
                renderer.set_view(view, 0).expect("a view");
                picture(&mut renderer)
            })
        });
        for (view, (dense, sparse)) in views.into_iter().zip(dense.iter().zip(&sparse)) {
            let (bias, rms) = difference(view, dense, sparse);
            let what = view.name();
            assert!(bias.abs() < MAX_BIAS, "{name}, {what}: the mean differs by {bias:.5}");
            assert!(rms < MAX_RMS, "{name}, {what}: pixels differ by {rms:.5}");
        }
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn isotropic_voxels_and_cone_shadows_match_dense_volumes() {
    let gpu = gpu();
    let of = |volume| {
        let settings = RenderSettings {
            directionality: Directionality::Isotropic,
            shadows: ShadowMethod::Cone,
            ..settings(volume)
        };
        rendered(&gpu, "cornell", settings)
    };
    let (bias, rms) = difference(View::Final, &of(VolumeKind::Dense), &of(octree()));
    assert!(bias.abs() < MAX_BIAS, "the mean differs by {bias:.5}");
    assert!(rms < MAX_RMS, "pixels differ by {rms:.5}");
}

#[test]
fn node_and_brick_views_need_an_octree() {
    let gpu = gpu();
    let scene = builtin("cornell");
    for view in [View::Nodes, View::Bricks] {
        let dense = RenderSettings { view, ..settings(VolumeKind::Dense) };
        let error = pollster::block_on(Renderer::new(&gpu, &scene, None, dense, &mut |_| {}))
            .expect_err("a dense volume has none");
        assert!(matches!(error, RenderError::Setting { name: "view", .. }), "{error}");
        assert!(error.to_string().contains("--volume octree"), "{error}");
        let sparse = RenderSettings { view, ..settings(octree()) };
        let shown = rendered(&gpu, "cornell", sparse);
        // Orange, with much more red than blue: nodes and texels that exist for neighbours.
        let is_orange = |p: &&[f32; 4]| p[0] > 5.0 * p[2] && p[1] > 2.0 * p[2] && p[0] < 4.0 * p[1];
        let orange = shown.hdr.iter().filter(is_orange).count();
        assert!(orange > 50, "{}: {orange} orange pixels", view.name());
        assert!(orange < shown.hdr.len() / 2, "{}: {orange} orange pixels", view.name());
    }
}

/// The lowest and the highest coordinates of the pixels of one colour.
fn extent(picture: &Picture, is_of_it: impl Fn(&[f32; 4]) -> bool) -> (UVec2, UVec2) {
    let pixels = (0..).zip(&picture.hdr).filter(|(_, pixel)| is_of_it(pixel));
    let places = pixels.map(|(i, _)| UVec2::new(i % picture.size.x, i / picture.size.x));
    places.fold((picture.size, UVec2::ZERO), |(low, high), at| (low.min(at), high.max(at)))
}

/// For a single voxel, nodes without cells surround the one with cells on all sides; there are no
/// others, whatever the grid's resolution.
#[test]
fn neighbour_nodes_surround_every_node_with_cells() {
    let mut seen = Vec::new();
    for resolution in [16, 136] {
        // A margin of 1.5 voxels on each side: the origin is a corner of nodes of two voxels.
        let cell = 2.0 / (resolution as f32 - 3.0);
        let mut scene = Scene::default();
        let middle = Vec3::splat(0.5 * cell);
        scene.meshes.push(quad(middle, 0.2 * cell * Vec3::X, 0.2 * cell * Vec3::Y));
        scene.materials.push(Material::diffuse("grey", Vec3::splat(0.5)));
        scene.instances.push(Instance::default());
        let eye = cell * Vec3::new(11.0, 8.0, 13.0);
        scene.cameras = vec![Camera::look_at(eye, Vec3::splat(cell), 0.6)];
        scene.validate().expect("a valid scene");
        let settings = RenderSettings {
            view: View::Nodes,
            resolution,
            grid_bounds: Some(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }),
            size: UVec2::new(160, 120),
            frames: 1,
            ..settings(octree())
        };
        let shown = picture(&mut renderer(&gpu(), &scene, settings));
        let own = extent(&shown, |pixel| pixel[2] > 3.0 * pixel[0]);
        let others = extent(&shown, |pixel| pixel[0] > 5.0 * pixel[2]);
        println!("own {own:?}, others {others:?}");
        assert!(own.0.cmplt(own.1).all(), "own {own:?}");
        assert!((others.0 + 5).cmplt(own.0).all(), "own {own:?}, others {others:?}");
        assert!((own.1 + 5).cmplt(others.1).all(), "own {own:?}, others {others:?}");
        seen.push((own, others));
    }
    assert_eq!(seen[0], seen[1]);
}

#[test]
fn the_lit_view_shows_voxels_the_lamp_reaches() {
    let gpu = gpu();
    let settings = RenderSettings { view: View::Lit, ..settings(octree()) };
    let mut renderer = renderer(&gpu, &builtin("cornell"), settings);
    let shares = |picture: &Picture| {
        let yellow = picture.hdr.iter().filter(|p| p[0] > 3.0 * p[2] && p[3] > 0.0).count();
        let grey = picture.hdr.iter().filter(|p| p[0] <= p[2] && p[3] > 0.0).count();
        let count = picture.hdr.len() as f64;
        (yellow as f64 / count, grey as f64 / count)
    };
    let (lit, unlit) = shares(&picture(&mut renderer));
    // Most of the box is lit, except the blocks' shadows and the sides that face away.
    assert!((0.5..0.9).contains(&lit) && (0.05..0.4).contains(&unlit), "{lit:.3}, {unlit:.3}");
    // The view of voxels adds bounces; the lit view must leave them out again.
    renderer.set_view(View::Voxels, 0).expect("a view");
    picture(&mut renderer);
    renderer.set_view(View::Lit, 0).expect("a view");
    assert_eq!(shares(&picture(&mut renderer)), (lit, unlit));
}
