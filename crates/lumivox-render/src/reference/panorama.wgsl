// The surroundings: constant within each texel, so that directions sampled in proportion to them
// have exactly that density.

import package::constants::PI;
import package::render::reference::random::random_2;
import package::render::reference::world::{panorama, panorama_rows, world};

struct Surroundings {
    // Radiance without the peaks that the renderer turns into lights.
    soft: vec3f,
    // Radiance that the peaks add.
    peaks: vec3f,
    // Density of `draw_surroundings`, per steradian.
    density: f32,
}

// From the world to the map: a rotation about y.
fn map_from_world(direction: vec3f) -> vec3f {
    let turn = world.environment_turn;
    return vec3f(
        turn.x * direction.x - turn.y * direction.z,
        direction.y,
        turn.y * direction.x + turn.x * direction.z,
    );
}

fn world_from_map(direction: vec3f) -> vec3f {
    let turn = world.environment_turn;
    return vec3f(
        turn.x * direction.x + turn.y * direction.z,
        direction.y,
        -turn.y * direction.x + turn.x * direction.z,
    );
}

fn texel_of(in_map: vec3f) -> vec2i {
    let size = vec2f(textureDimensions(panorama));
    // The centre of the map is the direction -z; columns continue towards +x, rows go down from +y.
    let across = 0.5 + atan2(in_map.x, -in_map.z) / (2.0 * PI);
    // acos would have no resolution near the poles.
    let down = atan2(length(in_map.xz), in_map.y) / PI;
    return clamp(vec2i(vec2f(across, down) * size), vec2i(0), vec2i(size) - 1);
}

// The solid angle of a texel. The difference of two cosines is written as a product, which is
// precise near the poles.
fn texel_sr(row: i32) -> f32 {
    let size = vec2f(textureDimensions(panorama));
    return 4.0 * PI / size.x * sin(PI * (f32(row) + 0.5) / size.y) * sin(0.5 * PI / size.y);
}

fn column_share(at: vec2i) -> f32 {
    let before = select(textureLoad(panorama, max(at - vec2i(1, 0), vec2i(0)), 0).a, 0.0, at.x == 0);
    return textureLoad(panorama, at, 0).a - before;
}

fn row_share(row: i32) -> f32 {
    let before = select(textureLoad(panorama_rows, vec2i(0, max(row - 1, 0)), 0).r, 0.0, row == 0);
    return textureLoad(panorama_rows, vec2i(0, row), 0).r - before;
}

fn surroundings(direction: vec3f) -> Surroundings {
    let in_map = map_from_world(direction);
    let at = texel_of(in_map);
    let whole = textureLoad(panorama, at, 0).rgb;
    var soft = whole;
    for (var index = 0u; index < world.peak_count; index++) {
        let peak = world.peaks[index];
        soft = select(soft, min(soft, peak.around), dot(in_map, peak.direction) >= peak.cos_cap);
    }
    return Surroundings(
        world.environment * soft,
        world.environment * (whole - soft),
        column_share(at) * row_share(at.y) / texel_sr(at.y),
    );
}

// A direction sampled in proportion to the radiance; its density is that of `surroundings`.
fn draw_surroundings() -> vec3f {
    let place = random_2();
    let inside = random_2();
    let size = vec2i(textureDimensions(panorama));
    // Find the first row whose cumulative probability exceeds the random number.
    var row = 0;
    var last = size.y - 1;
    while row < last {
        let middle = (row + last) / 2;
        let is_above = textureLoad(panorama_rows, vec2i(0, middle), 0).r > place.y;
        last = select(last, middle, is_above);
        row = select(middle + 1, row, is_above);
    }
    var column = 0;
    last = size.x - 1;
    while column < last {
        let middle = (column + last) / 2;
        let is_above = textureLoad(panorama, vec2i(middle, row), 0).a > place.x;
        last = select(last, middle, is_above);
        column = select(middle + 1, column, is_above);
    }
    // Uniform over the row means uniform in the cosine, 1 - 2 sin^2 of half the angle.
    let half_sines = sin(0.5 * PI / f32(size.y) * vec2f(f32(row), f32(row + 1)));
    let half_square = mix(half_sines.x * half_sines.x, half_sines.y * half_sines.y, inside.y);
    let cosine = 1.0 - 2.0 * half_square;
    let sine = 2.0 * sqrt(max(half_square * (1.0 - half_square), 0.0));
    let turn = 2.0 * PI * ((f32(column) + inside.x) / f32(size.x) - 0.5);
    return world_from_map(vec3f(sine * sin(turn), cosine, -sine * cos(turn)));
}
