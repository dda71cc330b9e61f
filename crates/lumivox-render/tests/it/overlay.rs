//! Tests that overlays are drawn and hidden at the right places, and never change radiance.

#![allow(clippy::float_cmp)] // Corners of cells, and full coverage, are told exactly.

use glam::{DVec2, Mat4, UVec2, UVec3, Vec2, Vec3};
use lumivox_render::{
    Exposure, Gpu, Overlay, OverlayLine, Picture, RenderSettings, Renderer, View, Wireframe, Wires,
    clip_from_world,
};
use lumivox_scene::{Camera, Instance, Material, Mesh, Scene};

use pollster::block_on;

use crate::common::{builtin, gpu, picture, renderer};

const WIRE: [u8; 3] = [41, 217, 255];
const BACKGROUND: [u8; 3] = [18, 18, 23];
/// Half of the width of triangles' edges, pixels.
const HALF_WIRE: f64 = 0.625;

fn settings(overlay: Overlay) -> RenderSettings {
    RenderSettings {
        size: UVec2::new(96, 54),
        resolution: 16,
        bounces: 0,
        frames: 1,
        view: View::Albedo,
        exposure: Exposure::Stops(0.0),
        shadow_resolution: 64,
        overlay,
        ..RenderSettings::default()
    }
}

fn add(scene: &mut Scene, corners: &[Vec3], material: Material) {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    scene.meshes.push(Mesh {
        positions: corners.to_vec(),
        normals: vec![normal; corners.len()],
        uvs: vec![Vec2::ZERO; corners.len()],
        tangents: vec![normal.any_orthonormal_vector().extend(1.0); corners.len()],
        indices: (1..corners.len() as u32 - 1).flat_map(|i| [0, i, i + 1]).collect(),
        ..Mesh::default()
    });
    scene.materials.push(material);
    scene.instances.push(Instance {
        name: String::new(),
        mesh: scene.meshes.len() - 1,
        material: scene.materials.len() - 1,
        world_from_local: Mat4::IDENTITY,
        ..Instance::default()
    });
}

fn grey() -> Material {
    Material::diffuse("grey", Vec3::splat(0.2))
}

fn triangle() -> [Vec3; 3] {
    [Vec3::new(-1.4, -0.7, 0.3), Vec3::new(1.2, -0.5, -0.6), Vec3::new(0.3, 0.8, 0.1)]
}

fn camera() -> Camera {
    Camera::look_at(Vec3::new(0.2, 0.1, 3.0), Vec3::ZERO, 0.7)
}

fn stage() -> Scene {
    let mut scene = Scene { cameras: vec![camera()], ..Scene::default() };
    add(&mut scene, &triangle(), grey());
    scene
}

/// Adds a square in front of the triangle that hides its upper half.
fn with_screen(mut scene: Scene) -> Scene {
    let corners = [(-2.0, 0.0), (2.0, 0.0), (2.0, 2.0), (-2.0, 2.0)];
    add(&mut scene, &corners.map(|(x, y)| Vec3::new(x, y, 1.0)), grey());
    scene
}

fn shown(gpu: &Gpu, scene: &Scene, settings: RenderSettings) -> Picture {
    let mut scene = scene.clone();
    scene.validate().expect("a valid scene");
    picture(&mut renderer(gpu, &scene, settings))
}

fn colors(picture: &Picture) -> impl Iterator<Item = (UVec2, [u8; 3])> + '_ {
    let width = picture.size.x;
    (0..)
        .zip(&picture.ldr)
        .map(move |(index, &[r, g, b, _])| (UVec2::new(index % width, index / width), [r, g, b]))
}

fn is_near(color: [u8; 3], other: [u8; 3]) -> bool {
    color.iter().zip(other).all(|(a, b)| a.abs_diff(b) <= 2)
}

/// The position of a point of the world in the picture, in pixels.
fn pixel_of(camera: &Camera, size: UVec2, place: Vec3) -> DVec2 {
    let clip = clip_from_world(camera, size).as_dmat4();
    let ndc = clip.project_point3(place.as_dvec3());
    size.as_dvec2() * DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y)
}

fn distance_to(at: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let share = ((at - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    at.distance(a + share * along)
}

/// The distance of a pixel's centre from the nearest line.
fn nearest(pixel: UVec2, lines: &[(DVec2, DVec2)]) -> f64 {
    let at = pixel.as_dvec2() + 0.5;
    lines.iter().map(|(a, b)| distance_to(at, *a, *b)).fold(f64::INFINITY, f64::min)
}

fn edges(corners: &[Vec3], size: UVec2) -> Vec<(DVec2, DVec2)> {
    let pixels: Vec<DVec2> = corners.iter().map(|c| pixel_of(&camera(), size, *c)).collect();
    (0..pixels.len()).map(|i| (pixels[i], pixels[(i + 1) % pixels.len()])).collect()
}

fn wireframe(wireframe: Wireframe) -> Overlay {
    Overlay { wireframe, ..Overlay::default() }
}

#[test]
fn wires_cover_exactly_the_pixels_near_edges() {
    let gpu = gpu();
    let scene = stage();
    for mode in [Wireframe::Over, Wireframe::Through] {
        for hides_surfaces in [false, true] {
            let overlay = Overlay { hides_surfaces, ..wireframe(mode) };
            let picture = shown(&gpu, &scene, settings(overlay));
            let lines = edges(&triangle(), picture.size);
            let mut on = 0;
            for (pixel, color) in colors(&picture) {
                let distance = nearest(pixel, &lines);
                // Nearer pixels may be on either side: f32 places lines to a thousandth of a pixel.
                if (distance - HALF_WIRE).abs() > 1e-3 {
                    let is_wire = distance < HALF_WIRE;
                    assert_eq!(is_near(color, WIRE), is_wire, "{pixel}: {color:?}, {distance}");
                    on += u32::from(is_wire);
                    let is_plain = is_near(color, BACKGROUND);
                    assert_eq!(is_plain, hides_surfaces && !is_wire, "{pixel}: {color:?}");
                }
            }
            assert!(on > 150, "{on} pixels");
        }
    }
}

#[test]
fn wires_behind_surfaces_are_hidden() {
    let gpu = gpu();
    let scene = with_screen(stage());
    let size = settings(Overlay::default()).size;
    let own = edges(&triangle(), size);
    let screen = [(-2.0, 0.0), (2.0, 0.0), (2.0, 2.0), (-2.0, 2.0)];
    let corners = screen.map(|(x, y)| Vec3::new(x, y, 1.0));
    let mut others = edges(&corners, size);
    others.push((pixel_of(&camera(), size, corners[0]), pixel_of(&camera(), size, corners[2])));
    let lower_edge = pixel_of(&camera(), size, Vec3::Z).y;
    let lit = |mode| {
        let picture = shown(&gpu, &scene, settings(wireframe(mode)));
        // Count only the triangle's wires, above and below the lower edge of the square that hides
        // it.
        let own_wires = colors(&picture).filter(|(pixel, color)| {
            is_near(*color, WIRE) && nearest(*pixel, &own) < 0.6 && nearest(*pixel, &others) > 1.0
        });
        let is_behind = |pixel: UVec2| f64::from(pixel.y) + 0.5 < lower_edge;
        let (behind, below): (Vec<_>, Vec<_>) = own_wires.partition(|(pixel, _)| is_behind(*pixel));
        (behind.len(), below.len())
    };
    let (hidden, seen) = lit(Wireframe::Over);
    let (through, also_seen) = lit(Wireframe::Through);
    println!("over: {hidden} behind, {seen} below; through: {through}, {also_seen}");
    assert_eq!(hidden, 0);
    assert!(through > 30 && seen > 60);
    assert_eq!(seen, also_seen);
}

/// Edges of visible surfaces are unbroken, even at grazing angles.
#[test]
fn edges_of_visible_surfaces_are_unbroken() {
    let gpu = gpu();
    let mut scene = stage();
    scene.instances.clear();
    // A floor of strips, seen at an angle of two degrees.
    for strip in 0..12 {
        let (near, far) = (2.4 - 0.4 * strip as f32, 2.0 - 0.4 * strip as f32);
        let corners = [(-1.0, near), (1.0, near), (1.0, far), (-1.0, far)];
        add(&mut scene, &corners.map(|(x, z)| Vec3::new(x, -0.1, z)), grey());
    }
    scene.cameras = vec![Camera::look_at(Vec3::new(0.0, 0.0, 3.0), Vec3::new(0.0, -0.1, 0.0), 0.2)];
    let settings = RenderSettings { size: UVec2::new(256, 144), ..settings(Overlay::default()) };
    let count = |mode| {
        let overlay = Overlay { hides_surfaces: true, ..wireframe(mode) };
        let picture = shown(&gpu, &scene, RenderSettings { overlay, ..settings.clone() });
        colors(&picture).filter(|(_, color)| is_near(*color, WIRE)).count()
    };
    // No strip hides another.
    let (over, through) = (count(Wireframe::Over), count(Wireframe::Through));
    println!("{over} of {through} pixels");
    assert!(through > 300);
    assert_eq!(over, through);
}

fn line(is_hidden_by_surfaces: bool) -> OverlayLine {
    // From a point in front of the triangle to one behind it, outside the picture.
    let (from, to) = (Vec3::new(-0.7, -0.4, 1.0), Vec3::new(1.2, 0.3, -3.0));
    OverlayLine { from, to, color: [1.0, 0.0, 0.0, 0.5], is_hidden_by_surfaces }
}

#[test]
fn lines_blend_by_their_coverage_and_end_at_surfaces() {
    let gpu = gpu();
    let plain = shown(&gpu, &stage(), settings(Overlay::default()));
    let red = |is_hidden| {
        let overlay = Overlay { lines: vec![line(is_hidden)], ..Overlay::default() };
        let picture = shown(&gpu, &stage(), settings(overlay));
        let changed = colors(&picture).zip(colors(&plain)).filter(|(a, b)| a.1 != b.1);
        changed
            .inspect(|((_, [r, ..]), (_, [was, ..]))| {
                assert!(r.abs_diff(127 + was / 2) <= 2, "{r} over {was}");
            })
            .count()
    };
    let (hidden, through) = (red(true), red(false));
    println!("{hidden} of {through} pixels");
    assert!(hidden > 8 && through > hidden + 8);
}

/// A line that starts between eye and near plane, and one that starts behind the eye: both end at
/// the plane.
#[test]
fn lines_are_cut_at_the_near_plane() {
    let gpu = gpu();
    let mut scene = stage();
    scene.cameras[0].near_m = 1.0;
    let (eye, end) = (camera(), Vec3::new(-0.8, 0.3, 0.2));
    let draw = |from: Vec3| {
        let line = OverlayLine { from, to: end, color: [1.0; 4], is_hidden_by_surfaces: false };
        let overlay = Overlay { lines: vec![line], hides_surfaces: true, ..Overlay::default() };
        let picture = shown(&gpu, &scene, settings(overlay));
        let lit = colors(&picture).filter(|(_, color)| is_near(*color, [255; 3]));
        lit.map(|(pixel, _)| pixel).collect::<Vec<_>>()
    };
    let before_the_eye = Vec3::new(0.6, -0.2, 2.9);
    let depth_m = |place: Vec3| (place - eye.position).dot(eye.forward);
    let share = (1.0 - depth_m(end)) / (depth_m(before_the_eye) - depth_m(end));
    let cut = draw(end.lerp(before_the_eye, share));
    assert!(cut.len() > 15, "{} pixels", cut.len());
    assert_eq!(cut, draw(before_the_eye));
    let beyond = before_the_eye + 3.0 * (before_the_eye - end);
    assert!(depth_m(beyond) < -1.0);
    assert_eq!(cut, draw(beyond));
}

/// Without an overlay, pictures are bit-identical to those before; no overlay changes radiance; two
/// runs agree.
#[test]
fn overlays_do_not_change_radiance() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let base = RenderSettings {
        size: UVec2::new(64, 36),
        resolution: 32,
        frames: 3,
        view: View::Final,
        ..settings(Overlay::default())
    };
    let plain = shown(&gpu, &scene, base.clone());
    let overlay = Overlay {
        wireframe: Wireframe::Over,
        wire_voxels: Wires::Over,
        grid_box: true,
        lines: vec![line(true)],
        ..Overlay::default()
    };
    let drawn = RenderSettings { overlay, ..base.clone() };
    let first = shown(&gpu, &scene, drawn.clone());
    assert!(first.hdr == plain.hdr, "the radiance has changed");
    assert!(first.ldr != plain.ldr, "nothing is drawn");
    assert!(first == shown(&gpu, &scene, drawn.clone()), "two runs differ");

    // If a renderer shows and hides the overlay, pictures are bit-identical each time.
    let mut changing = renderer(&gpu, &scene, drawn.clone());
    let set = |changing: &mut Renderer, settings: &RenderSettings| {
        block_on(changing.set_settings(settings.clone(), &mut |_| {})).expect("few lines");
    };
    assert!(picture(&mut changing) == first);
    let bytes = |changing: &Renderer| {
        let memory = changing.memory();
        memory.iter().find(|used| used.name == "picture").expect("the picture").bytes
    };
    let with_overlay = bytes(&changing);
    for _ in 0..2 {
        set(&mut changing, &base);
        assert!(picture(&mut changing) == plain, "something is left");
        assert_eq!(bytes(&changing) + 40 * 64 * 36, with_overlay);
        set(&mut changing, &drawn);
        assert_eq!((changing.frame_count(), changing.overlay_frame_count()), (3, 0));
        assert!(picture(&mut changing) == first, "drawn over a finished picture");
        assert_eq!(changing.overlay_frame_count(), 3);
    }
    // Another camera restarts picture and overlay.
    let moved = Camera { position: changing.camera().position * 0.9, ..changing.camera().clone() };
    changing.set_camera(moved.clone());
    let seen = picture(&mut changing);
    let mut fresh = renderer(&gpu, &scene, changing.settings().clone());
    fresh.set_camera(moved);
    assert!(seen == picture(&mut fresh), "something of the earlier camera is left");
}

/// A tiny triangle in the centre of each cell of a block with `edge` cells along each edge and a
/// corner at the origin.
fn voxels(edge: u32) -> (Scene, RenderSettings) {
    let mut scene = Scene { cameras: vec![oblique_camera()], ..Scene::default() };
    let bounds = lumivox_scene::Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let overlay =
        Overlay { wire_voxels: Wires::Through, hides_surfaces: true, ..Overlay::default() };
    let settings = RenderSettings {
        grid_bounds: Some(bounds),
        size: UVec2::new(320, 240),
        ..settings(overlay)
    };
    let cell = cell_size();
    for offset in cells(edge) {
        let middle = cell * (offset + 0.5);
        let corners = [(-0.1, -0.1), (0.1, -0.1), (0.0, 0.1)];
        add(&mut scene, &corners.map(|(x, y)| middle + cell * Vec3::new(x, y, 0.0)), grey());
    }
    (scene, settings)
}

/// A camera that sees three sides of a block well.
fn oblique_camera() -> Camera {
    Camera::look_at(Vec3::new(1.7, 1.3, 2.1), Vec3::splat(0.15), 0.25)
}

/// The coordinates of a block's cells.
fn cells(edge: u32) -> impl Iterator<Item = Vec3> {
    (0..edge.pow(3))
        .map(move |i| UVec3::new(i % edge, (i / edge) % edge, i / edge.pow(2)).as_vec3())
}

/// The edge of 2 m is 13 voxels, with a margin of 1.5 on each side; the origin is a corner of
/// cells.
fn cell_size() -> f32 {
    2.0 / 13.0
}

/// The edges of a block's cells in the world: first those on the block's surface, then those
/// inside.
fn block_edges(low: Vec3, edge: u32) -> [Vec<(Vec3, Vec3)>; 2] {
    let last = edge as f32;
    let all = cells(edge).flat_map(|cell| {
        (0..8_usize).flat_map(move |i| {
            let corner = cell + Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
            [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (corner, corner + axis))
        })
    });
    let is_of_block = |at: &Vec3| at.max_element() <= last;
    let is_outside =
        |a: Vec3, b: Vec3| (0..3).any(|i| a[i] == b[i] && (a[i] == 0.0 || a[i] == last));
    let (outer, inner): (Vec<_>, Vec<_>) =
        all.filter(|(_, b)| is_of_block(b)).partition(|(a, b)| is_outside(*a, *b));
    [outer, inner].map(|edges| {
        let place = |at| low + cell_size() * at;
        edges.into_iter().map(|(a, b)| (place(a), place(b))).collect()
    })
}

fn is_amber(color: [u8; 3]) -> bool {
    color[0] > 180 && color[2] < 100
}

/// One cell has twelve edges. In a block of eight cells, the six edges that meet in the centre are
/// between hidden faces, and are not drawn.
#[test]
fn wire_cubes_draw_only_edges_of_visible_faces() {
    let gpu = gpu();
    for edge in [1, 2] {
        let (scene, settings) = voxels(edge);
        let mut renderer: Renderer = renderer(&gpu, &scene, settings);
        let grid = *renderer.gi().grid();
        assert!((grid.voxel_size_m - cell_size()).abs() < 1e-6);
        let low = grid.world_from_grid(grid.grid_from_world(Vec3::splat(0.01)).floor());
        let picture = picture(&mut renderer);
        assert_eq!(renderer.voxel_stats().voxels, edge.pow(3));
        let [outer, inner] = block_edges(low, edge);
        assert_eq!(inner.is_empty(), edge == 1);
        let on_screen = |(a, b): &(Vec3, Vec3)| {
            let place = |at| pixel_of(&oblique_camera(), picture.size, at);
            (place(*a), place(*b))
        };
        let lines: Vec<_> = outer.iter().map(on_screen).collect();
        let drawn: Vec<DVec2> = colors(&picture)
            .filter(|(_, color)| is_amber(*color))
            .map(|(pixel, _)| pixel.as_dvec2() + 0.5)
            .collect();
        for at in &drawn {
            // A line is 1.1 pixels wide; at the block's outline, all of it is inside.
            let distance = nearest(at.as_uvec2(), &lines);
            assert!(distance < 1.15, "{at} is {distance} pixels from the nearest edge");
        }
        let is_drawn = |at: DVec2| drawn.iter().any(|pixel| pixel.distance(at) < 1.5);
        let along = |(a, b): (DVec2, DVec2)| (1..8).map(move |i| a.lerp(b, f64::from(i) / 8.0));
        for at in lines.iter().copied().flat_map(along) {
            assert!(is_drawn(at), "nothing is drawn at {at}");
        }
        // Edges inside the block are not drawn; checked at points far from other edges.
        let within = inner.iter().map(on_screen).flat_map(along);
        let free: Vec<DVec2> =
            within.filter(|at| lines.iter().all(|(a, b)| distance_to(*at, *a, *b) > 3.0)).collect();
        assert_eq!(free.is_empty(), edge == 1);
        assert!(free.iter().all(|at| !is_drawn(*at)));
    }
}

/// Surfaces hide the wires behind them, not those in front; all wires are of one level.
#[test]
#[ignore = "slow: over three seconds"]
fn wire_voxels_show_one_level_and_end_at_surfaces() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let count = |wire_voxels, voxel_level| {
        let overlay = Overlay { wire_voxels, hides_surfaces: true, ..Overlay::default() };
        let base = RenderSettings { size: UVec2::new(480, 270), ..settings(overlay) };
        let picture = shown(&gpu, &scene, RenderSettings { voxel_level, ..base });
        colors(&picture).filter(|(_, color)| is_amber(*color)).count()
    };
    let over = [0, 1, 2].map(|level| {
        let (over, through) = (count(Wires::Over, level), count(Wires::Through, level));
        println!("level {level}: {over} over, {through} through");
        assert!(over > 200 && through > over + over / 8);
        over
    });
    assert!(over[1] > 2 * over[2]);
}

/// An emissive wall along the grid, with a left half twice as bright: the volume's light on it is
/// linearly interpolated between the cells' centres.
#[test]
fn the_light_of_a_level_is_interpolated_on_surfaces() {
    let gpu = gpu();
    let cell = cell_size();
    let mut scene = Scene { cameras: vec![], ..Scene::default() };
    let bounds = lumivox_scene::Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let glow = |radiance: f32| Material {
        emissive: Vec3::new(radiance, 1.0, 0.25 * radiance),
        ..Material::diffuse("glow", Vec3::ZERO)
    };
    for (left, right, radiance) in [(-1.0, 0.0, 8.0), (0.0, 1.0, 4.0)] {
        let corners = [(left, -1.0), (right, -1.0), (right, 1.0), (left, 1.0)];
        add(&mut scene, &corners.map(|(x, y)| Vec3::new(x, y, 0.4 * cell)), glow(radiance));
    }
    scene.cameras.push(Camera::look_at(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 0.4));
    let base = RenderSettings {
        grid_bounds: Some(bounds),
        size: UVec2::new(64, 32),
        view: View::Lod,
        ..settings(Overlay::default())
    };
    for voxel_level in 0..3 {
        let mut renderer = renderer(&gpu, &scene, RenderSettings { voxel_level, ..base.clone() });
        let grid = *renderer.gi().grid();
        let picture = picture(&mut renderer);
        let edge = f64::from(1 << voxel_level);
        // The light of a cell of the level, from the bright half's share of it.
        let boundary = f64::from(grid.grid_from_world(Vec3::ZERO).x);
        let in_cell = |index: f64| {
            let bright = (boundary - index * edge).clamp(0.0, edge) / edge;
            8.0 * bright + 4.0 * (1.0 - bright)
        };
        for x in 0..64 {
            let (eye, direction) =
                renderer.camera().ray(Vec2::new(x as f32 + 0.5, 16.5), picture.size);
            let at = eye + direction * ((0.4 * cell - eye.z) / direction.z);
            let place = f64::from(grid.grid_from_world(at).x) / edge - 0.5;
            let share = place - place.floor();
            let expected =
                in_cell(place.floor()) * (1.0 - share) + in_cell(place.floor() + 1.0) * share;
            let [r, g, b, a] = picture.hdr[(16 * 64 + x) as usize].map(f64::from);
            // For half floats, and filters whose weights have at least 8 bits.
            let tolerance = 8.0 / 256.0 + 0.01;
            assert!(
                (r - expected).abs() < tolerance,
                "level {voxel_level}, {x}: {r}, not {expected}"
            );
            assert!((b - 0.25 * expected).abs() < tolerance && (g - 1.0).abs() < 0.005 && a == 1.0);
        }
    }
}

/// `Camera::ray` matches the renderer's projection.
#[test]
fn camera_rays_match_the_renderers_projection() {
    let size = UVec2::new(160, 90);
    let mut camera = Camera::look_at(Vec3::new(3.0, -1.0, 2.0), Vec3::new(-4.0, 2.0, 7.0), 1.1);
    camera.up = Vec3::new(0.3, 1.0, -0.2);
    for pixel in [(0.0, 0.0), (80.0, 45.0), (159.5, 0.5), (12.25, 71.75)] {
        let pixel = Vec2::from(pixel);
        let (origin, direction) = camera.ray(pixel, size);
        for distance in [0.5, 20.0] {
            let clip = clip_from_world(&camera, size);
            let ndc = clip.project_point3(origin + distance * direction);
            let seen = size.as_vec2() * (0.5 + 0.5 * ndc.truncate() * Vec2::new(1.0, -1.0));
            assert!((seen - pixel).length() < 2e-3, "{seen} instead of {pixel}");
        }
    }
}
