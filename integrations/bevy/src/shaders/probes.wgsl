// A grid of probes in the air, each with the irradiance towards six directions, as Bevy's irradiance volumes hold them.

import package::cascades::{finest_level, level_count, outer_high, outer_low};
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid_from_world;
import package::volume::wall_coverage;

const PI: f32 = 3.14159265359;
const SIDES: u32 = 6u;

struct ProbeSettings {
    // The corner of the grid of probes, m.
    low: vec3f,
    // Edge of a probe's cell, m.
    edge: f32,
    cells: vec3u,
    // The probes of this turn.
    first: u32,
    // Of the texture, whose box may be another for a frame or two.
    texture_low: vec3f,
    texture_edge: f32,
    texture_cells: vec3u,
    count: u32,
    // Where the grid was in the frame before, in cells.
    shift: vec3i,
    padding: u32,
}

// As `GatheredPoint` of `points/gather.wgsl`.
struct Gathered {
    indirect: vec3f,
    openness: f32,
    direct: vec3f,
    frames: u32,
}

struct Probe {
    // Irradiance in rgb; in a of the first one the turns so far, in a of the second one whether it is inside of something solid.
    light: array<vec4f, 6>,
}

@group(1) @binding(0) var<uniform> settings: ProbeSettings;
@group(1) @binding(1) var<storage, read_write> positions: array<vec4f>;
@group(1) @binding(2) var<storage, read_write> normals: array<vec4f>;
@group(1) @binding(3) var<storage, read_write> gathered: array<Gathered>;
@group(1) @binding(4) var<storage, read_write> probes: array<Probe>;
@group(1) @binding(5) var<storage, read_write> former: array<Probe>;

@group(2) @binding(0) var volume_texture: texture_storage_3d<rgba16float, write>;

fn side_direction(side: u32) -> vec3f {
    var direction = vec3f(0.0);
    direction[side / 2u] = select(1.0, -1.0, (side & 1u) != 0u);
    return direction;
}

fn cell_of(index: u32, cells: vec3u) -> vec3u {
    return vec3u(index % cells.x, index / cells.x % cells.y, index / (cells.x * cells.y));
}

fn index_of(cell: vec3u) -> u32 {
    return cell.x + settings.cells.x * (cell.y + settings.cells.y * cell.z);
}

fn probe_count() -> u32 {
    return settings.cells.x * settings.cells.y * settings.cells.z;
}

// The steps of a look along an axis for what stands there.
const MAX_STEPS: u32 = 96u;
const FELT: f32 = 0.5;

// 1: the first surface along a direction shows its back, -1: its front, 0: there is none.
fn back_of_first(start: vec3f, side: u32) -> i32 {
    let axis = side / 2u;
    let direction = side_direction(side);
    var position = start;
    for (var step = 0u; step < MAX_STEPS; step++) {
        let level = finest_level(position, 0u, 0.5);
        position += direction * exp2(f32(level));
        if any(position < outer_low()) || any(position > outer_high()) {
            return 0;
        }
        // Of surfaces that face along the axis, and against it.
        let coverage = wall_coverage(position, level, axis);
        let facing = select(coverage.y, coverage.x, direction[axis] < 0.0);
        let averted = select(coverage.x, coverage.y, direction[axis] < 0.0);
        if max(facing, averted) > FELT {
            return select(-1, 1, facing < 0.5 * averted);
        }
    }
    return 0;
}

// Whether a place is inside of something solid, or behind walls that have one side: what it meets first shows its back.
fn is_buried(position_in_world: vec3f) -> bool {
    let start = grid_from_world(position_in_world);
    var backs = 0;
    for (var side = 0u; side < SIDES; side++) {
        backs += back_of_first(start, side);
    }
    return backs > 0;
}

// Sets the points of a turn.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn place(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= settings.count {
        return;
    }
    let number = (settings.first + index) % probe_count();
    let cell = cell_of(number, settings.cells);
    let position = settings.low + (vec3f(cell) + 0.5) * settings.edge;
    for (var side = 0u; side < SIDES; side++) {
        positions[SIDES * index + side] = vec4f(position, 0.0);
        normals[SIDES * index + side] = vec4f(side_direction(side), 0.0);
    }
    probes[number].light[1].a = select(0.0, 1.0, is_buried(position));
}

fn luminance(rgb: vec3f) -> f32 {
    return dot(rgb, vec3f(0.2126, 0.7152, 0.0722));
}

// The least share of a turn in the mean over turns.
const LEAST_SHARE: f32 = 0.2;
// Light that differs by more than this share has changed.
const CHANGE: f32 = 0.3;

// Takes the light of a turn into the probes.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn take(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= settings.count {
        return;
    }
    let number = (settings.first + index) % probe_count();
    var now = 0.0;
    var before = 0.0;
    for (var side = 0u; side < SIDES; side++) {
        now += luminance(max(gathered[SIDES * index + side].indirect, vec3f(0.0)));
        before += luminance(probes[number].light[side].rgb);
    }
    var turns = probes[number].light[0].a;
    if abs(now - before) > CHANGE * max(now, before) {
        turns = 0.0;
    }
    let share = max(1.0 / (turns + 1.0), LEAST_SHARE);
    for (var side = 0u; side < SIDES; side++) {
        let light = max(gathered[SIDES * index + side].indirect, vec3f(0.0));
        let mean = mix(probes[number].light[side].rgb, light, share);
        probes[number].light[side] = vec4f(mean, probes[number].light[side].a);
    }
    probes[number].light[0].a = turns + 1.0;
}

// Keeps probes whose grid has moved.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn keep(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index < probe_count() {
        former[index] = probes[index];
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn move_on(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= probe_count() {
        return;
    }
    let before = vec3i(cell_of(index, settings.cells)) + settings.shift;
    let nearest = clamp(before, vec3i(0), vec3i(settings.cells) - 1);
    probes[index] = former[index_of(vec3u(nearest))];
    if any(before != nearest) {
        // The first light that it gathers takes the place of its neighbour's.
        probes[index].light[0].a = 0.0;
    }
}

fn show(cell: vec3u, light: array<vec4f, 6>) {
    var sides = light;
    for (var side = 0u; side < SIDES; side++) {
        let slab = vec3u(0u, side & 1u, side / 2u);
        textureStore(volume_texture, cell + slab * settings.texture_cells, sides[side]);
    }
}

fn is_there(probe: Probe) -> bool {
    return probe.light[0].a > 0.0;
}

// Writes the texture: the radiance of white matt surfaces. What is inside of something solid takes the light of what is around,
// so that it does not darken its surface.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn fill(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    let size = settings.texture_cells;
    if index >= size.x * size.y * size.z {
        return;
    }
    let cell = cell_of(index, size);
    let position = settings.texture_low + (vec3f(cell) + 0.5) * settings.texture_edge;
    let most = vec3i(settings.cells) - 1;
    let nearest = clamp(vec3i(floor((position - settings.low) / settings.edge)), vec3i(0), most);
    let own = probes[index_of(vec3u(nearest))];
    var light = own.light;
    if !is_there(own) || own.light[1].a > 0.0 {
        var sum = array<vec4f, 6>();
        var weight = 0.0;
        for (var reach = 1; reach <= 2 && weight == 0.0; reach++) {
            let low = max(nearest - reach, vec3i(0));
            let high = min(nearest + reach, most);
            for (var z = low.z; z <= high.z; z++) {
                for (var y = low.y; y <= high.y; y++) {
                    for (var x = low.x; x <= high.x; x++) {
                        let other = probes[index_of(vec3u(vec3i(x, y, z)))];
                        if !is_there(other) || other.light[1].a > 0.0 {
                            continue;
                        }
                        let away = vec3f(vec3i(x, y, z) - nearest);
                        let share = 1.0 / dot(away, away);
                        weight += share;
                        for (var side = 0u; side < SIDES; side++) {
                            sum[side] += share * other.light[side];
                        }
                    }
                }
            }
        }
        for (var side = 0u; side < SIDES; side++) {
            light[side] = sum[side] / max(weight, 1e-9);
        }
    }
    for (var side = 0u; side < SIDES; side++) {
        light[side] = vec4f(light[side].rgb / PI, 1.0);
    }
    show(cell, light);
}

// Writes darkness.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn empty(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    let size = settings.texture_cells;
    if index < size.x * size.y * size.z {
        show(cell_of(index, size), array<vec4f, 6>());
    }
}
