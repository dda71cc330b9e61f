// A grid of probes in the air, each with the irradiance for six directions, as in Bevy's irradiance
// volumes.

import package::cascades::finest_level;
import package::cones::ray::{trace_ray, Passed, Ray};
import package::constants::{LINEAR_WORKGROUP_SIZE, PI, PROBE_SIDES};
import package::gpu::dispatch::linear_index;
import package::grid::grid_from_world;
import package::volume::patch::BLACK;

struct ProbeSettings {
    // The corner of the grid of probes, m.
    low: vec3f,
    // Edge of a probe's cell, m.
    edge: f32,
    cells: vec3u,
    // The probes of this turn.
    first: u32,
    // The grid of the texture; it may differ for a frame or two.
    texture_low: vec3f,
    texture_edge: f32,
    texture_cells: vec3u,
    count: u32,
    // Offset of the grid from the previous frame's, in cells.
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
    // Irradiance in rgb. a is 0 if the first surface seen is a back face, which makes the light
    // invalid, and 1 otherwise.
    light: array<vec4f, 6>,
    // Number of turns in which the probe has gathered.
    turns: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
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

// Whether the first surface along a direction shows its back: the probe is inside something solid,
// or behind a single-sided wall.
fn sees_back(start: vec3f, side: u32) -> bool {
    var passed = Passed(0u, true, 1.0);
    let ray = Ray(start, side_direction(side), 3e38, finest_level(start, 0u, 0.5));
    return trace_ray(ray, &passed).face == BLACK;
}

// Writes the points that gather in this turn, and marks the sides that see backs.
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
    for (var side = 0u; side < PROBE_SIDES; side++) {
        positions[PROBE_SIDES * index + side] = vec4f(position, 0.0);
        normals[PROBE_SIDES * index + side] = vec4f(side_direction(side), 0.0);
        probes[number].light[side].a = select(1.0, 0.0, sees_back(grid_from_world(position), side));
    }
}

fn luminance(rgb: vec3f) -> f32 {
    return dot(rgb, vec3f(0.2126, 0.7152, 0.0722));
}

// The least weight of a turn in the mean over turns.
const LEAST_SHARE: f32 = 0.2;
// Light counts as changed if it differs by more than this share.
const CHANGE: f32 = 0.3;

// Blends the light of a turn into the probes.
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
    for (var side = 0u; side < PROBE_SIDES; side++) {
        now += luminance(max(gathered[PROBE_SIDES * index + side].indirect, vec3f(0.0)));
        before += luminance(probes[number].light[side].rgb);
    }
    let has_changed = abs(now - before) > CHANGE * max(now, before);
    let turns = select(probes[number].turns, 0u, has_changed);
    let share = max(1.0 / (f32(turns) + 1.0), LEAST_SHARE);
    for (var side = 0u; side < PROBE_SIDES; side++) {
        let light = max(gathered[PROBE_SIDES * index + side].indirect, vec3f(0.0));
        let mean = mix(probes[number].light[side].rgb, light, share);
        probes[number].light[side] = vec4f(mean, probes[number].light[side].a);
    }
    probes[number].turns = turns + 1u;
}

// Saves the probes before their grid moves.
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
        // The first light that the probe gathers replaces its neighbour's.
        probes[index].turns = 0u;
    }
}

fn show(cell: vec3u, light: array<vec4f, 6>) {
    var sides = light;
    for (var side = 0u; side < PROBE_SIDES; side++) {
        let slab = vec3u(0u, side & 1u, side / 2u);
        textureStore(volume_texture, cell + slab * settings.texture_cells, sides[side]);
    }
}

// Search radius for valid light around a probe without any, in cells.
const REACH: i32 = 2;

// The light of a cell from one direction; if invalid, of cells around it.
fn light_around(cell: vec3i, side: u32) -> vec3f {
    let most = vec3i(settings.cells) - 1;
    var sum = vec4f(0.0);
    for (var reach = 0; reach <= REACH && sum.a == 0.0; reach++) {
        let low = max(cell - reach, vec3i(0));
        let high = min(cell + reach, most);
        for (var z = low.z; z <= high.z; z++) {
            for (var y = low.y; y <= high.y; y++) {
                for (var x = low.x; x <= high.x; x++) {
                    let index = index_of(vec3u(vec3i(x, y, z)));
                    let light = probes[index].light[side];
                    let away = vec3f(vec3i(x, y, z) - cell);
                    let share = light.a * f32(min(probes[index].turns, 1u)) / max(dot(away, away), 1.0);
                    sum += share * vec4f(light.rgb, 1.0);
                }
            }
        }
    }
    return sum.rgb / max(sum.a, 1e-9);
}

// Writes the texture: the radiance of white matt surfaces. Probes inside something solid get the
// light around them, so that they do not darken its surface.
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
    var light = array<vec4f, 6>();
    for (var side = 0u; side < PROBE_SIDES; side++) {
        light[side] = vec4f(light_around(nearest, side) / PI, 1.0);
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
