// A panorama as an uncompressed Radiance file (Ward 1991, "Real pixels", Graphics Gems II), and its
// luminance.

/** The radiance in a direction, cd/m2: bright above, dim brown below, with a red and a blue side,
 * so that rotations are visible.
 * @param {number} around from 0 to 1, from the left edge @param {boolean} isAbove
 * @returns {[number, number, number]} */
function color(around, isAbove) {
    const side = 0.5 + 0.5 * Math.sin(2 * Math.PI * around);
    return isAbove ? [200 * side, 120, 200 * (1 - side)] : [30, 20, 10];
}

/** @param {number} [height] @returns {Buffer} */
export function panorama(height = 32) {
    const width = 2 * height;
    const texels = Buffer.alloc(4 * width * height);
    for (let y = 0; y < height; y += 1) {
        for (let x = 0; x < width; x += 1) {
            // One exponent for all: 2^(136 - 136) is one.
            texels.set([...color((x + 0.5) / width, y < height / 2).map(Math.floor), 136], 4 * (y * width + x));
        }
    }
    return Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`), texels]);
}

/** Its luminance at a place of a picture from this camera, cd/m2 (ITU-R BT.709-6, section 3.2).
 * @param {any} camera @param {[number, number]} place from 0 to 1 @param {number} aspect
 * @param {number} turned degrees */
export function luminance(camera, [x, y], aspect, turned) {
    const axes = [0, 1, 2];
    const unit = (/** @type {number[]} */ v) => v.map((part) => part / Math.hypot(...v));
    const cross = (/** @type {number[]} */ a, /** @type {number[]} */ b) => axes.map((i) => a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
    const forward = unit(axes.map((axis) => camera.target[axis] - camera.position[axis]));
    const right = unit(cross(forward, camera.up));
    const above = cross(right, forward);
    const tangent = Math.tan((camera.vertical_fov_deg * Math.PI) / 360);
    const [dx, dy, dz] = axes.map((axis) => forward[axis] + ((2 * x - 1) * aspect * right[axis] + (1 - 2 * y) * above[axis]) * tangent);
    const [sin, cos] = [Math.sin((turned * Math.PI) / 180), Math.cos((turned * Math.PI) / 180)];
    // Undo the rotation. The middle of the file is at -z, and +x is to its right.
    const around = 0.5 + Math.atan2(cos * dx - sin * dz, -(sin * dx + cos * dz)) / (2 * Math.PI);
    const [red, green, blue] = color(around, dy > 0);
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}
