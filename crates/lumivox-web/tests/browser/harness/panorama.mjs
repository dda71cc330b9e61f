// A panorama as a file: Radiance, uncompressed (Ward 1991, "Real pixels", Graphics Gems II).

/** Bright above, dim and brown below, with a red and a blue side: turns and directions can be told apart.
 * @param {number} [height] @returns {Buffer} */
export function panorama(height = 16) {
    const width = 2 * height;
    const texels = Buffer.alloc(4 * width * height);
    for (let y = 0; y < height; y += 1) {
        for (let x = 0; x < width; x += 1) {
            const side = 0.5 + 0.5 * Math.sin((2 * Math.PI * x) / width);
            const color = y < height / 2 ? [200 * side, 120, 200 * (1 - side)] : [30, 20, 10];
            // One exponent for all: 2^(136 - 136) is one.
            texels.set([...color.map(Math.round), 136], 4 * (y * width + x));
        }
    }
    return Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`), texels]);
}
