//! How much surface the rasterizer's methods find in each voxel, and of what colour.

use glam::{Vec3, Vec4};
use lumivox::{Draw, Geometry, Grid, SurfaceMaterial};

use lumivox_classics::raster::Raster;

use super::{ALL, EXACT, RASTER, depth_inside, dominant, lab, turn, voxelize};
use crate::voxelize::read::{Lab, along, morton_decode};
use crate::voxelize::scenes::unit_grid;
use crate::voxelize::scenes::{Mesh, Random};
use crate::voxelize::twin::in_grid;

fn colored(reflectance: Vec3) -> SurfaceMaterial {
    SurfaceMaterial { reflectance: reflectance.extend(1.0), ..Default::default() }
}

const RED: Vec3 = Vec3::new(0.9, 0.1, 0.05);
const BLUE: Vec3 = Vec3::new(0.15, 0.3, 0.8);

/// A tilted plane, one half red and one half blue: each voxel has the colour of its side, both
/// sides have the same area, and their sum is that of the plane.
#[test]
fn a_two_coloured_plane_keeps_colours_and_area() {
    let p = Vec3::new;
    let at = |u: f32, v: f32| p(8.0, 9.0, 20.0) + u * p(44.0, 5.0, 18.0) + v * p(-4.0, 42.0, 11.0);
    let mut mesh = Mesh::default();
    for i in 0..20 {
        for j in 0..20 {
            let corner = |di: i32, dj: i32| at((i + di) as f32 / 20.0, (j + dj) as f32 / 20.0);
            mesh.quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
        }
    }
    let area = p(44.0, 5.0, 18.0).cross(p(-4.0, 42.0, 11.0)).as_dvec3();
    for (method, allowed) in ALL.into_iter().zip([1e-4, 0.01, 1e-4, 0.01]) {
        let lab = lab(method);
        let mut batch = mesh.batch(&lab.device, 0);
        let whole = batch.draws[0];
        let half = whole.index_count / 2;
        batch.draws = vec![
            Draw { index_count: half, ..whole },
            Draw { first_index: half, index_count: half, material: 1, ..whole },
        ];
        let geometry = Geometry::new(vec![batch], vec![colored(RED), colored(BLUE)]);
        let list = lab.voxelize(&unit_grid(64), &geometry);

        let (mut sum, mut weight, mut pure) = (Vec3::ZERO, 0.0, 0);
        for face in list.faces.iter().filter(|face| along(face) > 1e-3) {
            // Distance from the line between the halves, within the plane.
            let position = Vec3::from(face.position_in_world);
            let normal = area.as_vec3().normalize();
            let across = p(-4.0, 42.0, 11.0).cross(normal).normalize();
            let side = (position - at(0.5, 0.0)).dot(across);
            let reflectance = Vec3::from(face.reflectance);
            // Farther than a voxel reaches.
            if side.abs() > 1.8 {
                let own =
                    if side * (at(0.0, 0.0) - at(0.5, 0.0)).dot(across) > 0.0 { RED } else { BLUE };
                assert!((reflectance - own).abs().max_element() < 1e-5, "{method:?}: {face:?}");
                pure += 1;
            }
            let apart = (position - at(0.5, 0.5)).dot(normal);
            // Conservative pixels crossed by an edge are estimates.
            let most = if method == Some(Raster::Conservative) { 0.3 } else { 1e-3 };
            assert!(apart.abs() < most, "{method:?}: {face:?} is off its plane by {apart}");
            sum += along(face) * reflectance;
            weight += along(face);
        }
        assert!(pure > 1000, "{method:?}: {pure}");
        let mean = sum / weight;
        let error = (mean - 0.5 * (RED + BLUE)).abs().max_element();
        let kept = list.total_area().length() / area.length();
        println!("{method:?}: mean off by {error:.5}, area {kept:.4}");
        assert!(error < 0.01, "{method:?}: {mean}");
        assert!((kept - 1.0).abs() < allowed, "{method:?}: {kept} of the area");
        let direction = list.total_area().normalize().dot(area.normalize());
        assert!(direction > 0.99999, "{method:?}: {direction}");
    }
}

/// In a fully covered pixel, the area and position of each voxel's share are exact.
#[test]
fn conservative_shares_are_exact_within_a_plane() {
    let p = Vec3::new;
    let grid = unit_grid(64);
    for t in [
        [p(3.0, 4.0, 20.3), p(61.0, 7.0, 38.0), p(9.0, 60.0, 47.0)],
        [p(30.2, 4.0, 3.0), p(31.0, 6.0, 61.0), p(52.0, 60.0, 9.0)],
        [p(3.0, 30.4, 4.0), p(5.0, 30.4, 61.0), p(60.0, 30.4, 6.0)],
    ] {
        let turned = in_grid(&grid, &t);
        let axis = dominant(&turned)[0];
        let turned = turned.map(|p| turn(p, axis));
        let exact = voxelize(EXACT, &grid, &[t]);
        let own = voxelize(Some(Raster::Conservative), &grid, &[t]);
        let mut compared = 0;
        for face in &exact.faces {
            let voxel = morton_decode(face.cell).as_dvec3() + 0.5;
            if depth_inside(&turned, turn(voxel, axis).truncate()) < 1.0 {
                continue;
            }
            let other = own.faces.iter().find(|other| other.cell == face.cell);
            let area = other.map_or(0.0, along);
            assert!((area - along(face)).abs() < 1e-3, "{face:?}: {area}");
            if let Some(other) = other.filter(|_| along(face) > 0.05) {
                let [a, b] = [face, other].map(|face| Vec3::from(face.position_in_world));
                assert!((a - b).abs().max_element() < 0.2, "{face:?}: {other:?}");
                let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
                assert!((b - t[0]).dot(normal).abs() < 1e-3, "{face:?}: {other:?}");
            }
            compared += 1;
        }
        assert!(compared > 1000, "{compared}");
    }
}

/// Most triangles smaller than voxels cover no pixel centre: those that do represent all.
#[test]
#[ignore = "slow: over three seconds"]
fn small_triangles_keep_their_area_on_average() {
    let grid = Grid::fit(Vec3::NEG_ONE, Vec3::ONE, 64, Vec3::ZERO).unwrap();
    let along_of = |method| {
        let lab = lab(method);
        let sphere = Mesh::sphere(Vec3::ZERO, 1.0, 300);
        let list = lab.voxelize(&grid, &sphere.geometry(&lab.device, SurfaceMaterial::default()));
        let closed = list.total_area().length() / list.total_along();
        assert!(closed < 0.01, "{method:?}: a closed surface has a sum of {closed}");
        list.total_along()
    };
    let exact = along_of(EXACT);
    for (method, allowed) in RASTER.into_iter().zip([0.02, 1e-3, 0.02]) {
        let share = along_of(method) / exact;
        println!("{method:?}: {share:.4} of the area");
        assert!((share - 1.0).abs() < allowed, "{method:?}: {share} of the area");
    }
}

/// A triangle that is smaller than its voxel, and the only one in it, is found by few of the
/// sampled points. These weigh accordingly more: over many triangles the area is kept.
#[test]
#[ignore = "slow: over three seconds"]
fn isolated_triangles_keep_their_area_on_average() {
    let mut random = Random(15);
    let triangles: Vec<_> = (0..20 * 20 * 20)
        .map(|i| {
            // Three voxels apart, so that no two share one, and anywhere in their voxels.
            let voxel = Vec3::new((i % 20) as f32, (i / 20 % 20) as f32, (i / 400) as f32);
            let center = 3.0 * voxel + 2.5 + random.vector(-0.5, 0.5);
            [(); 3].map(|()| center + random.vector(-0.5, 0.5))
        })
        .collect();
    let grid = unit_grid(64);
    let along_of = |method| voxelize(method, &grid, &triangles).total_along();
    let exact = along_of(EXACT);
    // The noise of a thousand points is 3 %. The conservative method is exact here.
    for (method, allowed) in RASTER.into_iter().zip([0.06, 0.01, 0.06]) {
        let share = along_of(method) / exact;
        println!("{method:?}: {share:.4} of the area");
        assert!((share - 1.0).abs() < allowed, "{method:?}: {share} of the area");
    }
}

/// A hundred thousand fragments in one voxel: a quarter of them red, and not one is lost.
#[test]
#[ignore = "slow: over three seconds"]
fn crowded_voxels_average_all_their_fragments() {
    const COUNT: u32 = 100_000;
    let triangles: Vec<_> = (0..COUNT)
        .map(|i| {
            // One layer: surfaces farther apart would hide each other (layers.rs).
            let z = 6.5 + (f32::from(u16::try_from(i % 50_000).unwrap()) / 50_000.0 - 0.5) / 4096.0;
            // Covers only the centre of the voxel's column.
            [Vec3::new(5.1, 3.1, z), Vec3::new(5.9, 3.3, z), Vec3::new(5.4, 3.9, z)]
        })
        .collect();
    for method in RASTER {
        let lab = lab(method);
        let mut batch = Mesh::from_triangles(&triangles).batch(&lab.device, 0);
        let whole = batch.draws[0];
        batch.draws = (0..COUNT / 1000)
            .map(|i| Draw {
                first_index: 3000 * i,
                index_count: 3000,
                material: u32::from(i % 4 != 0),
                ..whole
            })
            .collect();
        let materials = vec![colored(RED), colored(BLUE)];
        let list = lab.voxelize(&unit_grid(16), &Geometry::new(vec![batch], materials));
        assert_eq!(list.voxels().into_iter().collect::<Vec<_>>(), [[5, 3, 6]], "{method:?}");
        assert_eq!(list.stats.fragments, u64::from(COUNT), "{method:?}");
        let [face] = list.faces[..] else { panic!("{method:?}: {} faces", list.faces.len()) };
        let expected = 0.25 * RED + 0.75 * BLUE;
        let error = (Vec3::from(face.reflectance) - expected).abs().max_element();
        assert!(error < 1e-5, "{method:?}: {face:?}, off by {error}");
        assert!((face.position_in_world[2] - 6.5).abs() < 1e-4, "{method:?}: {face:?}");
        assert!((along(&face) - 1.0).abs() < 1e-6, "{method:?}: {face:?}");
    }
}
/// Textures, holes and colours on a wall whose pixels are whole voxels match the exact method.
#[test]
#[ignore = "slow: over three seconds"]
fn rastered_surfaces_match_the_exact_method() {
    use crate::voxelize::textures::{columns, texture, textured, wall};
    let material = |lab: &Lab, alpha_is_coverage, transmission| {
        let shade = |x: u32, y: u32| [(x * 30) as u8, 200, 30, (255 - y * 30) as u8];
        SurfaceMaterial {
            reflectance: Vec4::new(1.0, 0.8, 0.5, 1.0),
            reflectance_texture: Some(textured(lab, texture(lab, 8, shade))),
            emission: Vec3::new(7.0, 3.0, 1.0),
            alpha_is_coverage,
            transmission,
            ..Default::default()
        }
    };
    let of = |lab: &Lab, (holes, transmission)| {
        columns(lab, &wall().geometry(&lab.device, material(lab, holes, transmission)))
    };
    let exact = Lab::new();
    let cases = [(false, 0.0), (true, 0.0), (false, 0.7)].map(|case| (case, of(&exact, case)));
    for method in RASTER {
        let lab = lab(method);
        for (case, right) in &cases {
            let own = of(&lab, *case);
            // The border's texels wrap around; on the diagonal two triangles meet.
            let inner = |[x, y]: [u32; 2]| (5..11).contains(&x) && (5..11).contains(&y) && x != y;
            let mut compared = 0;
            for (column, face) in own.iter().filter(|(column, _)| inner(*column)) {
                let (_, right) = right.iter().find(|(other, _)| other == column).expect("a face");
                let (a, b) = (Vec3::from(face.reflectance), Vec3::from(right.reflectance));
                assert!((a - b).abs().max_element() < 2e-3, "{method:?} {column:?}: {a}, not {b}");
                assert!((along(face) - along(right)).abs() < 2e-3, "{method:?} {column:?}");
                let (a, b) = (Vec3::from(face.emission), Vec3::from(right.emission));
                assert!((a - b).abs().max_element() < 1e-3, "{method:?} {column:?}: {a}, not {b}");
                compared += 1;
            }
            assert_eq!(compared, 30, "{method:?}");
        }
    }
}
