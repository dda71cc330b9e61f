//! Static and dynamic shares: kept and newly walked surface together give the bits of a whole
//! voxelization.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Mat4, Vec3, Vec4};
use lumivox::gpu::Recorder;
use lumivox::hooks::{Voxelization, VoxelizationShares, Walk, WalkStep, Walker};
use lumivox::{Draw, Geometry, GiError, Grid, SurfaceMaterial};

use crate::voxelize::read::{Lab, ReadList};
use crate::voxelize::scenes::{Mesh, Random, cornell_box};

/// Two spheres, a soup of small triangles and a large plate that move in the Cornell box; half of
/// the materials have two sides, one has holes, one emits.
fn stage(lab: &Lab) -> Geometry {
    let mut random = Random(5);
    let soup: Vec<[Vec3; 3]> = (0..400)
        .map(|_| {
            let centre = random.vector(-0.3, 0.3);
            [(); 3].map(|()| centre + random.vector(-0.03, 0.03))
        })
        .collect();
    let mut plate = Mesh::default();
    plate.quad(
        [(-0.4, -0.4), (0.4, -0.4), (0.4, 0.4), (-0.4, 0.4)].map(|(x, y)| Vec3::new(x, y, 0.0)),
    );
    let meshes = [
        cornell_box(),
        Mesh::sphere(Vec3::ZERO, 0.2, 12),
        Mesh::from_triangles(&soup),
        plate,
        Mesh::sphere(Vec3::ZERO, 0.1, 8),
    ];
    let batches = meshes.iter().zip(0..).map(|(mesh, material)| {
        let mut batch = mesh.batch(&lab.device, material);
        batch.draws[0].is_static = material == 0;
        batch
    });
    let material = |r: f32, emission: f32, alpha: f32, double_sided: bool| SurfaceMaterial {
        reflectance: Vec4::new(r, 0.5, 1.0 - r, alpha),
        emission: Vec3::splat(emission),
        alpha_is_coverage: alpha < 1.0,
        double_sided,
        ..SurfaceMaterial::default()
    };
    Geometry::new(
        batches.collect(),
        vec![
            material(0.9, 0.0, 1.0, false),
            material(0.2, 3.0, 1.0, false),
            material(0.4, 0.0, 1.0, true),
            material(0.6, 0.0, 0.4, true),
            material(0.8, 0.5, 1.0, false),
        ],
    )
}

fn set(geometry: &mut Geometry, mesh: usize, transform: Mat4) {
    geometry.batches[mesh].draws[0].world_from_local = transform;
}

fn at(x: f32, y: f32, z: f32) -> Mat4 {
    Mat4::from_translation(Vec3::new(x, y, z))
}

fn room() -> Grid {
    Grid::fit(Vec3::ZERO, Vec3::splat(2.0), 32, Vec3::ZERO).expect("it fits")
}

/// Asserts equal bits and equal counts.
fn assert_same(kept: &ReadList, whole: &ReadList, what: &str) {
    assert_eq!(kept.level_starts, whole.level_starts, "{what}");
    for (name, (a, b)) in ["occupancy", "ranks", "nodes", "first faces", "faces"]
        .iter()
        .zip(kept.bits().iter().zip(whole.bits()))
    {
        assert!(*a == b, "{what}: the {name} are not those of a whole voxelization");
    }
    let counts = |list: &ReadList| {
        let s = &list.stats;
        (s.triangles, s.skipped, s.outside, s.work_items, s.fragments, s.voxels, s.faces)
    };
    assert_eq!(counts(kept), counts(whole), "{what}");
}

#[test]
fn moved_draws_match_a_full_revoxelization() {
    let lab = Lab::new();
    let (grid, mut geometry) = (room(), stage(&lab));
    let turned = Mat4::from_rotation_x(0.7);
    // In the air; in walls and floor, sharing voxels and lobes; half outside; wholly outside.
    let moves = [
        ("in the air", [at(0.5, 1.5, 1.0), at(1.4, 1.5, 0.7), at(1.0, 1.7, 1.0) * turned]),
        ("in walls", [at(0.0, 1.5, 1.0), at(1.4, 0.0, 0.7), at(1.0, 1.0, 0.01)]),
        ("in blocks", [at(0.5, 1.2, 0.8), at(1.3, 0.6, 1.4), at(1.0, 0.6, 1.0) * turned]),
        ("half outside", [at(2.1, 1.5, 1.0), at(-0.1, 0.2, 0.7), at(1.0, 2.0, 2.0) * turned]),
        ("outside", [at(9.0, 1.5, 1.0), at(1.4, -8.0, 0.7), at(1.0, 1.0, 7.0)]),
        ("in the air", [at(0.5, 1.5, 1.0), at(1.4, 1.5, 0.7), at(1.0, 1.7, 1.0) * turned]),
    ];
    set(&mut geometry, 4, at(30.0, 0.0, 0.0));
    let mut kept = lab.gi(&grid);
    let mut first = None;
    for (step, (name, transforms)) in moves.into_iter().enumerate() {
        for (mesh, transform) in (1..).zip(transforms) {
            set(&mut geometry, mesh, transform);
        }
        let partly = lab.voxelize_into(&geometry, &mut kept);
        let whole = lab.voxelize(&grid, &geometry);
        assert_same(&partly, &whole, name);
        assert_eq!(partly.stats.static_reused, step > 0, "{name}");
        let room = u64::from(geometry.batches[0].draws[0].index_count / 3);
        let walked = partly.stats.triangles - if step > 0 { room } else { 0 };
        assert_eq!(partly.stats.walked, walked, "{name}");
        assert!(!whole.stats.static_reused);
        let is_kept = |(what, _): &(&str, u64)| *what == "voxels: kept of static draws";
        assert!(kept.memory().iter().any(is_kept));
        let again = first.get_or_insert_with(|| lab.voxelize(&grid, &geometry));
        assert_eq!(again.bits() == partly.bits(), name == "in the air", "{name}: a move shows");
    }
}

#[test]
fn added_and_removed_draws_match_a_full_revoxelization() {
    let lab = Lab::new();
    let (grid, mut geometry) = (room(), stage(&lab));
    for mesh in 1..5 {
        set(&mut geometry, mesh, at(0.4 * mesh as f32, 1.0, 1.1));
    }
    let draws: Vec<Vec<Draw>> = geometry.batches.iter().map(|b| b.draws.clone()).collect();
    let mut kept = lab.gi(&grid);
    // Drawn meshes, and whether the static share is reused: all, fewer, only the room, again; then
    // no room; then nothing reusable.
    let cases: [(&[usize], bool); 7] = [
        (&[0, 1, 2, 3, 4], false),
        (&[0, 3], true),
        (&[0], true),
        (&[0, 1, 4], true),
        (&[1, 4], false),
        (&[0, 1, 4], false),
        (&[0, 1], true),
    ];
    for (shown, is_reused) in cases {
        for (mesh, batch) in geometry.batches.iter_mut().enumerate() {
            batch.draws = if shown.contains(&mesh) { draws[mesh].clone() } else { Vec::new() };
        }
        let partly = lab.voxelize_into(&geometry, &mut kept);
        assert_same(&partly, &lab.voxelize(&grid, &geometry), &format!("{shown:?}"));
        assert_eq!(partly.stats.static_reused, is_reused, "{shown:?}");
    }
}

/// A change to a geometry, and its name.
type Change<'a> = (&'a str, &'a dyn Fn(&mut Geometry));

/// Changes of static draws are found without being reported.
#[test]
#[ignore = "slow: over three seconds"]
fn changes_to_static_draws_are_detected() {
    let lab = Lab::new();
    let (grid, geometry) = (room(), stage(&lab));
    let changes: [Change<'_>; 6] = [
        ("moved", &|g| g.batches[0].draws[0].world_from_local = at(0.1, 0.0, 0.0)),
        ("painted", &|g| g.materials[0].reflectance.x = 0.1),
        ("two-sided", &|g| g.materials[0].double_sided = true),
        ("fewer triangles", &|g| g.batches[0].draws[0].index_count -= 3),
        ("more is static", &|g| g.batches[2].draws[0].is_static = true),
        ("other buffers", &|g| g.batches[0].positions = stage(&lab).batches[0].positions.clone()),
    ];
    for (name, change) in changes {
        let mut kept = lab.gi(&grid);
        lab.voxelize_into(&geometry, &mut kept);
        let mut changed = geometry.clone();
        change(&mut changed);
        let partly = lab.voxelize_into(&changed, &mut kept);
        assert!(!partly.stats.static_reused, "{name} was not noticed");
        assert_same(&partly, &lab.voxelize(&grid, &changed), name);
    }
}

/// A method that leaves all walks to the exact one.
#[derive(Debug)]
struct AsItIs;

impl Voxelization for AsItIs {
    fn name(&self) -> &'static str {
        "as it is"
    }

    fn make(&self, _: &VoxelizationShares<'_>) -> Result<Box<dyn Walker>, GiError> {
        Ok(Box::new(Self))
    }
}

impl Walker for AsItIs {
    fn walk(&self, _: &mut Recorder, _: WalkStep, walk: &Walk<'_>) -> bool {
        assert!(walk.runs().count() > 0, "there are triangles");
        false
    }
}

/// A caller's method sees every walk, and may decline it.
#[test]
fn a_custom_method_can_fall_back_to_exact_voxelization() {
    let lab = Lab::new();
    let (grid, geometry) = (room(), stage(&lab));
    let own = Lab::by(Some(Arc::new(AsItIs))).voxelize(&grid, &geometry);
    assert_same(&own, &lab.voxelize(&grid, &geometry), "the exact walk");
}

/// By voxel and lobe: the faces' vector area, and reflectance and emission times the area along the
/// lobe.
type Sums = BTreeMap<(u32, u32), [Vec3; 3]>;

fn sums_by_lobe(list: &ReadList) -> Sums {
    let mut sums = Sums::new();
    for face in &list.faces {
        let own = sums.entry((face.cell, face.lobe)).or_default();
        let along = crate::voxelize::read::along(face);
        own[0] += Vec3::from(face.vector_area);
        own[1] += Vec3::from(face.reflectance) * along;
        own[2] += Vec3::from(face.emission) * along;
    }
    sums
}

/// Two shares equal one share: the same voxels, and lobes whose sums differ only by rounding,
/// unless both shares lie in one plane and their area exceeds a plane's limit.
#[test]
fn static_and_dynamic_parts_equal_one_voxelization() {
    let lab = Lab::new();
    let (grid, mut geometry) = (room(), stage(&lab));
    for (mesh, place) in (1..).zip([at(0.0, 1.5, 1.0), at(1.4, 0.0, 0.7), at(1.0, 1.0, 0.01)]) {
        set(&mut geometry, mesh, place);
    }
    let two = lab.voxelize(&grid, &geometry);
    for batch in &mut geometry.batches {
        batch.draws[0].is_static = true;
    }
    let one = lab.voxelize(&grid, &geometry);
    assert!(two.occupancy == one.occupancy, "the voxels differ");
    assert_eq!(two.stats.fragments, one.stats.fragments);
    let [two, one] = [&two, &one].map(sums_by_lobe);
    assert!(two.keys().eq(one.keys()), "the lobes differ");
    let mut compared = 0;
    for (lobe, (a, b)) in two.iter().map(|(lobe, a)| (lobe, (a, &one[lobe]))) {
        if a[0].abs().max_element() > 1.0 {
            continue;
        }
        compared += 1;
        for (a, b) in a.iter().zip(b) {
            assert!((*a - *b).abs().max_element() < 1e-4, "{lobe:?}: {a} and {b}");
        }
    }
    assert!(2 * compared > one.len(), "of {} lobes {compared} are compared", one.len());
}
