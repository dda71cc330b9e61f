// The first occupied cell of a level along a ray.

import package::cascades::{box_size, shown_cascade, stored_from_corner};
import package::render::passes::voxel_view::cell_walk::{longest_walk, walk_into, walked_on};
import package::render::passes::voxel_view::view::{Ray, MIN_OPACITY};
import package::volume::load_cell;

struct Hit {
    is_hit: bool,
    // Radiance towards the eye.
    radiance: vec3f,
    // The distance in cells.
    distance: f32,
    position: vec3f,
    axis: u32,
}

fn first_cube(ray: Ray, level: u32) -> Hit {
    let cascade = shown_cascade(level);
    let up = level - cascade;
    let size = vec3f(box_size() >> vec3u(up));
    var walk = walk_into(ray.origin, ray.direction, size);
    let steps = longest_walk(size);
    for (var step = 0u; step < steps && walk.is_inside; step++) {
        let cell = stored_from_corner(vec3u(walk.cell), up, cascade);
        let seen = load_cell(cell, up, ray.direction);
        if seen.a > MIN_OPACITY {
            // The radiance of the face along the view, if there is any: if a wall and a floor share
            // a cell, each colours its side of the cube.
            var inwards = vec3f(0.0);
            inwards[walk.axis] = walk.forward[walk.axis];
            let face = load_cell(cell, up, inwards);
            var radiance = seen.rgb / seen.a;
            if face.a > MIN_OPACITY {
                radiance = face.rgb / face.a;
            }
            let position = ray.origin + walk.distance * ray.direction;
            return Hit(true, radiance, walk.distance, position, walk.axis);
        }
        walk = walked_on(walk);
    }
    return Hit(false, vec3f(0.0), 0.0, vec3f(0.0), 0u);
}
