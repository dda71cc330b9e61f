// The face whose light is shown at a hit.
//
// A face has one light, gathered at its start point. Another surface in the voxel may separate the
// hit from that start point, as a wall separates the ground inside a house from the ground outside.
// The hit then shows the light of the face of the same plane in the next voxel, away from that
// surface.

import package::volume::beside::{
    entry_at, face_between, face_like, patch_of, start_of_face, Likeness,
};
import package::volume::patch::{NOTHING, UNLIT};

// Maximum number of steps to other voxels, along one axis each: as many as walls meet at a corner.
const MOST_VOXELS = 3u;

const SAME_PLANE = Likeness(0.98, 0.05);

// The face whose light is shown at a point of a face; UNLIT if there is none nearby. The point is
// in the coordinates of the voxel.
fn face_seen_at(hit: u32, hit_entry: u32, hit_point: vec3f, hit_voxel: vec3i, cascade: u32) -> u32 {
    var face = hit;
    var entry = hit_entry;
    var point = hit_point;
    var voxel = hit_voxel;
    for (var i = 0u; i <= MOST_VOXELS && face != NOTHING; i++) {
        let own = patch_of(face);
        var wall = NOTHING;
        if own.is_parted {
            wall = face_between(entry, face, start_of_face(face), point);
        }
        if wall == NOTHING {
            return face;
        }
        // Step away from the wall, along its axis.
        let plane = patch_of(wall);
        let axis = plane.lobe >> 1u;
        let is_beyond = dot(plane.normal, point) > plane.offset;
        let step = select(-1, 1, is_beyond == (plane.normal[axis] > 0.0));
        voxel[axis] += step;
        point[axis] -= f32(step);
        entry = entry_at(voxel, cascade);
        face = face_like(entry, own.lobe, normalize(own.normal), point, SAME_PLANE);
    }
    return UNLIT;
}
