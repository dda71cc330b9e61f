// The exact overlap of a triangle and a voxel, by separating axes (Schwarz and Seidel 2010, "Fast
// parallel surface and solid voxelization on GPUs", section 3.1).
//
// The axes are the box's (the footprint's rectangle and the range of depth), the triangle's normal
// (the range of the plane's depth over the column), and the nine products of their edges: three
// edges in each of the three projections. The walk has tested all but two of the projections.

import package::voxelize::walk::{EdgeTest, Walk, edge_test, may_touch};

// Edge tests in the projections along v (onto u and w) and along u (onto v and w).
struct SideTests {
    ab_uw: EdgeTest,
    bc_uw: EdgeTest,
    ca_uw: EdgeTest,
    ab_vw: EdgeTest,
    bc_vw: EdgeTest,
    ca_vw: EdgeTest,
}

fn side_tests(walk: ptr<function, Walk>) -> SideTests {
    let a = (*walk).a;
    let b = (*walk).b;
    let c = (*walk).c;
    let extent = (*walk).extent;
    return SideTests(
        edge_test(a.xz, b.xz, c.xz, extent),
        edge_test(b.xz, c.xz, a.xz, extent),
        edge_test(c.xz, a.xz, b.xz, extent),
        edge_test(a.yz, b.yz, c.yz, extent),
        edge_test(b.yz, c.yz, a.yz, extent),
        edge_test(c.yz, a.yz, b.yz, extent),
    );
}

// Whether the walk's current voxel and the triangle have a point in common.
fn touches(walk: ptr<function, Walk>, tests: SideTests) -> bool {
    let centre = vec3f((*walk).voxel) + 0.5;
    return may_touch(tests.ab_uw, centre.xz) && may_touch(tests.bc_uw, centre.xz)
        && may_touch(tests.ca_uw, centre.xz) && may_touch(tests.ab_vw, centre.yz)
        && may_touch(tests.bc_vw, centre.yz) && may_touch(tests.ca_vw, centre.yz);
}
