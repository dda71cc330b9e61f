//! Equal bits for every order; errors that name the problem.

use glam::{Mat4, Vec3};
use lumivox::gpu::Timing;
use lumivox::{Draw, Geometry, Gi, GiConfig, GiError, Grid, SurfaceMaterial};

use crate::voxelize::read::Lab;
use crate::voxelize::scenes::{Mesh, Random, cornell_box, triangle_soup, unit_grid};

#[test]
#[ignore = "slow: over three seconds"]
fn the_order_of_triangles_does_not_matter() {
    let lab = Lab::new();
    let grid = unit_grid(32);
    let material = SurfaceMaterial { double_sided: true, ..Default::default() };
    let mut triangles = triangle_soup();
    let first = lab
        .voxelize(&grid, &Mesh::from_triangles(&triangles).geometry(&lab.device, material.clone()));
    let mut random = Random(22);
    for i in (1..triangles.len()).rev() {
        triangles.swap(i, random.next() as usize % (i + 1));
    }
    let mesh = Mesh::from_triangles(&triangles);
    let shuffled = lab.voxelize(&grid, &mesh.geometry(&lab.device, material.clone()));
    assert!(first.bits() == shuffled.bits());

    // The division into batches and draws does not matter either.
    let (front, back) = triangles.split_at(1000);
    let mut batches = vec![
        Mesh::from_triangles(front).batch(&lab.device, 0),
        Mesh::from_triangles(back).batch(&lab.device, 1),
    ];
    let whole = batches[1].draws[0];
    batches[1].draws = (0..10)
        .map(|i| {
            let first_index = whole.index_count / 30 * i * 3;
            let end = if i == 9 { whole.index_count } else { whole.index_count / 30 * (i + 1) * 3 };
            Draw { first_index, index_count: end - first_index, material: i % 2, ..whole }
        })
        .collect();
    let geometry = Geometry::new(batches, vec![material.clone(), material]);
    let shared = lab.voxelize(&grid, &geometry);
    assert!(first.bits() == shared.bits());
}

/// The error with which voxelizing fails.
pub fn error_of(lab: &Lab, grid: &Grid, geometry: &Geometry) -> GiError {
    let mut gi = lab.gi(grid);
    pollster::block_on(gi.voxelize(geometry, Timing::Off)).expect_err("this must fail")
}

#[test]
fn contradictory_draws_are_refused() {
    let lab = Lab::new();
    let grid = unit_grid(16);
    let good = || cornell_box().geometry(&lab.device, SurfaceMaterial::default());
    let broken = |change: &dyn Fn(&mut Draw)| {
        let mut geometry = good();
        change(&mut geometry.batches[0].draws[0]);
        error_of(&lab, &grid, &geometry).to_string()
    };
    let text = broken(&|draw| draw.index_count = 4);
    assert_eq!(text, "draw 0 of batch 0: it has 4 indices, which is no multiple of 3");
    let text = broken(&|draw| draw.first_index = 3);
    assert_eq!(text, "draw 0 of batch 0: its indices end at 105, but the batch has 102");
    let text = broken(&|draw| draw.material = 7);
    assert_eq!(text, "draw 0 of batch 0: it names material 7, but there are 1");

    let mut geometry = good();
    geometry.materials[0].emission.x = f32::NAN;
    let text = error_of(&lab, &grid, &geometry).to_string();
    assert_eq!(text, "material 0: its emission must be finite and not negative");

    for geometry in [
        Geometry::default(),
        Mesh::from_triangles(&[[Vec3::ONE; 3]]).geometry(&lab.device, SurfaceMaterial::default()),
    ] {
        let error = error_of(&lab, &grid, &geometry);
        assert!(matches!(error, GiError::NothingToVoxelize { .. }), "{error}");
    }
}

#[test]
fn indices_out_of_range_do_no_harm() {
    let lab = Lab::new();
    let mut mesh = cornell_box();
    mesh.indices.extend([0, 1, 4_000_000_000, u32::MAX, u32::MAX - 1, 3]);
    let geometry = mesh.geometry(&lab.device, SurfaceMaterial::default());
    let grid = Grid::fit(Vec3::ZERO, Vec3::splat(2.0), 32, Vec3::ZERO).unwrap();
    assert!(lab.voxelize(&grid, &geometry).stats.voxels > 0);
}

#[test]
fn limit_errors_name_the_limit_and_a_remedy() {
    let lab = Lab::new();
    let grid = Grid::fit(Vec3::ZERO, Vec3::splat(2.0), 1024, Vec3::ZERO).unwrap();
    let error = Gi::with_pipelines(&lab.device, &lab.queue, GiConfig::new(grid));
    let Err(GiError::Limit { limit, needed, available, remedy, .. }) = error else {
        panic!("{error:?}");
    };
    assert_eq!(limit, "max_storage_buffer_binding_size");
    assert!(needed > available);
    assert_eq!(remedy, "a resolution of 512 would fit");

    // Too many faces, known only once they are counted.
    let mut mesh = Mesh::default();
    for layer in 0..24 {
        let z = layer as f32 / 24.0 * 1.9 + 0.01;
        let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        mesh.quad([corner(0., 0., z), corner(2., 0., z), corner(2., 2., z), corner(0., 2., z)]);
        let z = z + 0.001;
        mesh.quad([corner(0., 0., z), corner(0., 2., z), corner(2., 2., z), corner(2., 0., z)]);
    }
    let grid = Grid::fit(Vec3::ZERO, Vec3::splat(2.0), 512, Vec3::ZERO).unwrap();
    let error = error_of(&lab, &grid, &mesh.geometry(&lab.device, SurfaceMaterial::default()));
    assert!(matches!(error, GiError::Limit { .. }), "{error}");
    assert!(error.to_string().starts_with("the buffer of"), "{error}");
}

/// More items than 32 bits can number: an error, and no work with wrapped numbers.
#[test]
fn too_many_items_are_an_error() {
    let lab = Lab::new();
    let grid = unit_grid(512);
    let wall = [Vec3::new(0.0, 0.0, 9.5), Vec3::new(512.0, 0.0, 9.5), Vec3::new(0.0, 512.0, 9.5)];
    let mut batch = Mesh::from_triangles(&[wall; 100]).batch(&lab.device, 0);
    // 129 * 129 items a triangle, 100 triangles a draw.
    batch.draws = vec![Draw { world_from_local: Mat4::IDENTITY, ..batch.draws[0] }; 2700];
    let geometry = Geometry::new(vec![batch], vec![SurfaceMaterial::default()]);
    let error = error_of(&lab, &grid, &geometry);
    let GiError::Limit { needed, available, .. } = error else { panic!("{error}") };
    assert!(needed > available, "{error}");
}
