// @ts-check
// Camera moves: pure functions from a camera to the next. Angles in rad, lengths in metres.

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").Vec3} Vec3 */

/** The steepest line of sight, rad: beyond it, left and right would swap. */
const STEEPEST_RAD = 1.55;

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @param {Vec3} a @param {number} by @returns {Vec3} */
export const scale = (a, by) => [a[0] * by, a[1] * by, a[2] * by];
/** @param {Vec3} a @param {Vec3} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {Vec3} a */
export const length = (a) => Math.hypot(...a);

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export function cross(a, b) {
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** The unit vector, or `otherwise` for zero and infinite vectors.
 * @param {Vec3} a @param {Vec3} otherwise @returns {Vec3} */
function normalize(a, otherwise) {
    const size = length(a);
    return size > 0 && Number.isFinite(size) ? scale(a, 1 / size) : otherwise;
}

/** The camera's axes in the world: `above` is its own upward axis, `up` the normalized `camera.up`.
 * @param {Camera} camera
 * @returns {{ forward: Vec3, right: Vec3, above: Vec3, up: Vec3 }} */
export function axes(camera) {
    const up = normalize(camera.up, [0, 1, 0]);
    const forward = normalize(subtract(camera.target, camera.position), [0, 0, -1]);
    /** @type {Vec3} */
    const aside = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1];
    const right = normalize(cross(forward, up), normalize(cross(aside, up), [1, 0, 0]));
    return { forward, right, above: cross(right, forward), up };
}

/** A vector turned about an axis of length one (Rodrigues 1840).
 * @param {Vec3} v @param {Vec3} axis @param {number} angle @returns {Vec3} */
function rotate(v, axis, angle) {
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const along = scale(axis, dot(axis, v) * (1 - cos));
    return add(add(scale(v, cos), scale(cross(axis, v), sin)), along);
}

/** A rotation up, within STEEPEST_RAD, then to the left.
 * @param {Camera} camera @param {number} left @param {number} above @returns {(v: Vec3) => Vec3} */
function turn(camera, left, above) {
    const { forward, right, up } = axes(camera);
    const elevation = Math.asin(Math.min(1, Math.max(-1, dot(forward, up))));
    const raised = Math.min(STEEPEST_RAD, Math.max(-STEEPEST_RAD, elevation + above));
    return (v) => rotate(rotate(v, right, raised - elevation), up, left);
}

/** Orbits the camera about its target: a drag to the right turns the scene to the right.
 * @param {Camera} camera @param {number} right @param {number} down @returns {Camera} */
export function orbit(camera, right, down) {
    const offset = turn(camera, -right, -down)(subtract(camera.position, camera.target));
    return { ...camera, position: add(camera.target, offset) };
}

/** Turns the camera in place, to the right and down.
 * @param {Camera} camera @param {number} right @param {number} down @returns {Camera} */
export function look(camera, right, down) {
    const offset = turn(camera, -right, -down)(subtract(camera.target, camera.position));
    return { ...camera, target: add(camera.position, offset) };
}

/** Moves the camera parallel to the picture, by shares of the picture's height. A point at the
 * target stays under the pointer.
 * @param {Camera} camera @param {number} right @param {number} down @returns {Camera} */
export function pan(camera, right, down) {
    const { right: aside, above } = axes(camera);
    const distance = length(subtract(camera.target, camera.position));
    const height = 2 * distance * Math.tan((camera.vertical_fov_deg * Math.PI) / 360);
    return moved(camera, add(scale(aside, -right * height), scale(above, down * height)));
}

/** Multiplies the distance to the target by `factor`, down to `nearest`.
 * @param {Camera} camera @param {number} factor @param {number} nearest @returns {Camera} */
export function dolly(camera, factor, nearest) {
    const distance = length(subtract(camera.target, camera.position));
    const wanted = Math.max(distance * factor, Math.min(nearest, distance));
    return { ...camera, position: subtract(camera.target, scale(axes(camera).forward, wanted)) };
}

/** Moves the camera and its target to its right, up in the world, and forwards.
 * @param {Camera} camera @param {Vec3} way @returns {Camera} */
export function fly(camera, way) {
    const { forward, right, up } = axes(camera);
    return moved(camera, add(add(scale(right, way[0]), scale(up, way[1])), scale(forward, way[2])));
}

/** Moves the camera so that a box fills the picture; its direction stays. `fitted` adapts it to
 * upright pictures.
 * @param {Camera} camera @param {{ min: Vec3, max: Vec3 }} bounds @returns {Camera} */
export function frame(camera, bounds) {
    const distance = Math.max(radius(bounds), 1e-4) / Math.sin((camera.vertical_fov_deg * Math.PI) / 360);
    const target = scale(add(bounds.min, bounds.max), 0.5);
    return { ...camera, target, position: subtract(target, scale(axes(camera).forward, distance)) };
}

/** Turns the camera in place towards a point, which it then orbits.
 * @param {Camera} camera @param {Vec3} point @returns {Camera} */
export function lookAt(camera, point) {
    return length(subtract(point, camera.position)) > 0 ? { ...camera, target: point } : camera;
}

/** The camera for a picture of this aspect (width over height). Upright pictures get a larger
 * angle, up to 150 degrees, so that a phone shows as much at the sides as a square picture.
 * @param {Camera} camera @param {number} aspect @returns {Camera} */
export function fitted(camera, aspect) {
    if (!(aspect < 1)) return camera;
    const widened = (Math.atan(Math.tan((camera.vertical_fov_deg * Math.PI) / 360) / aspect) * 360) / Math.PI;
    return { ...camera, vertical_fov_deg: Math.max(camera.vertical_fov_deg, Math.min(150, widened)) };
}

/** Half the diagonal of a box.
 * @param {{ min: Vec3, max: Vec3 }} bounds */
export function radius(bounds) {
    return 0.5 * length(subtract(bounds.max, bounds.min));
}

/** @param {Camera} camera @param {Vec3} by @returns {Camera} */
function moved(camera, by) {
    return { ...camera, position: add(camera.position, by), target: add(camera.target, by) };
}
