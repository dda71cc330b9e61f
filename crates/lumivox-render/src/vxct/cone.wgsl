// One of VXCT's cones through our volume. Lengths here are in voxels.
//
// As there, the cells that are read at a distance are as wide as the cone, between two levels by interpolation. What
// differs: opacity counts per length, so that steps of any size and voxels of any size give the same; what is met is
// composited front to back until nothing shines through; and cells never reach down to the surface that the cone
// leaves, nor beyond the light that it looks for.
//
// The volume's two kinds tell coverage in two ways. An isotropic cell's is a mean over its volume: a wall that is a
// voxel thick has 2^-l at the level l, and over any cone that crosses it, coverage per voxel edge sums up to one. Six
// lobes keep a wall's coverage from level to level: there it is coverage per edge of the cell that does.

import package::constants::ISOTROPIC;
import package::grid::grid;
import package::volume::{is_empty, probe_volume, sample_probe, Probe};

struct VxctCone {
    origin_in_grid: vec3f,
    direction: vec3f,
    // Diameter per distance.
    width: f32,
    // Where sampling starts.
    start: f32,
    // Where the light is that the cone looks for; without one, very far.
    reach: f32,
    step_per_diameter: f32,
    // Of the origin above the plane of its surface, and the cone's cosine against that plane's normal.
    height: f32,
    cos_plane: f32,
    // At the distance d what is met counts smoothstep(0, 1, softness sqrt(d)); 0: all of it.
    softness: f32,
    // What is met shines with (1 + d / fade_length)^-fade.
    fade: f32,
    fade_length: f32,
}

struct VxctTraced {
    radiance: vec3f,
    // The share that met nothing.
    transmittance: f32,
    // Where the cone ended.
    distance: f32,
    samples: u32,
}

// Trilinear weights of samples half a cell apart sum up to two in each cell, wherever they begin: finer steps change
// nothing, and up to a whole cell nothing is passed over.
const LEAST_STEP: f32 = 0.5;

// What is left is less than a step of 8 bits.
const MIN_TRANSMITTANCE: f32 = 1.0 / 512.0;

// Radiance times coverage, and coverage, per voxel edge.
fn density(probe: Probe, level: u32, direction: vec3f) -> vec4f {
    let per_edge = select(exp2(-f32(level)), 1.0, ISOTROPIC != 0u);
    return sample_probe(probe, direction) * per_edge;
}

// The way along a direction out of the 2x2x2 cells that a look-up reads, in cells.
fn way_out(position_in_grid: vec3f, direction: vec3f, cell: f32) -> f32 {
    let place = position_in_grid / cell + 0.5;
    let rest = select(floor(place) - place, floor(place) + 1.0 - place, direction > vec3f(0.0));
    let along = select(direction, vec3f(1e-6), abs(direction) < vec3f(1e-6));
    let ways = select(rest / along, vec3f(1e6), abs(direction) < vec3f(1e-6));
    return min(ways.x, min(ways.y, ways.z));
}

fn trace_vxct(cone: VxctCone) -> VxctTraced {
    let extent = vec3f(grid.dimensions);
    let side = max(extent.x, max(extent.y, extent.z));
    let top = grid.levels - 1u;
    let largest_cell = exp2(f32(top));
    var traced = VxctTraced(vec3f(0.0), 1.0, cone.start, 0u);
    var is_inside = cone.start < cone.reach;
    loop {
        var position: vec3f;
        var fine_level: u32;
        var coarse_level: u32;
        var coarse: Probe;
        var share: f32;
        var step: f32;
        var middle: f32;
        // Pass over empty space (package::trace::cone tells why in a loop of its own).
        loop {
            let at = traced.distance;
            let clear = 0.5 * min(cone.height + at * cone.cos_plane, cone.reach - at);
            let wanted = clamp(min(cone.width * at, clear), 1.0, largest_cell);
            fine_level = min(u32(log2(wanted)), top);
            coarse_level = min(fine_level + 1u, top);
            share = saturate(log2(wanted) - f32(fine_level));
            let cell = exp2(f32(fine_level));
            step = clamp(cone.width * at * cone.step_per_diameter, LEAST_STEP * cell, cell);
            step = min(step, max(cone.reach - at, 0.0));
            middle = at + 0.5 * step;
            position = cone.origin_in_grid + cone.direction * middle;
            let coarse_cell = exp2(f32(coarse_level));
            // Outside the grid the cells at its border are still felt for half a cell.
            let margin = min(coarse_cell, 0.5 * side);
            is_inside = is_inside && at < cone.reach
                && all(position >= vec3f(-margin)) && all(position <= extent + margin);
            // Where the coarser cells are empty, so are the finer ones, as far as they reach.
            coarse = probe_volume(position, coarse_level, cone.direction);
            let is_passed = is_inside && is_empty(coarse);
            let way = way_out(position, cone.direction, coarse_cell) * coarse_cell;
            let passed = max(step, 0.5 * step + way - 0.25 * cell);
            traced.distance += select(0.0, passed, is_passed);
            traced.samples += u32(is_inside);
            continuing {
                break if !is_passed;
            }
        }
        if is_inside {
            let fine = probe_volume(position, fine_level, cone.direction);
            var met = vec4f(0.0);
            if !is_empty(fine) {
                met = (1.0 - share) * density(fine, fine_level, cone.direction);
            }
            if share > 0.0 {
                met += share * density(coarse, coarse_level, cone.direction);
            }
            if met.a > 0.0 {
                let x = saturate(cone.softness * sqrt(middle));
                let counted = select(1.0, x * x * (3.0 - 2.0 * x), cone.softness > 0.0);
                let taken = min(met.a * step * counted, traced.transmittance);
                let faded = pow(1.0 + middle / cone.fade_length, -cone.fade);
                traced.radiance += met.rgb * (taken / met.a * faded);
                traced.transmittance -= taken;
            }
            traced.distance += step;
        }
        continuing {
            break if !is_inside || traced.transmittance <= MIN_TRANSMITTANCE;
        }
    }
    if traced.transmittance <= MIN_TRANSMITTANCE {
        traced.transmittance = 0.0;
    }
    return traced;
}
