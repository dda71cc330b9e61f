// @ts-check
// Linear colours and their screen codes (IEC 61966-2-1).

/** @typedef {import("./types.js").Vec3} Vec3 */

/** A linear colour's screen code, relative to its strongest channel, or to `white`.
 * @param {Vec3} color @param {number} [white] */
export function hex(color, white = Math.max(...color, 1e-12)) {
    const byte = (/** @type {number} */ part) => {
        const share = Math.min(1, Math.max(0, part / white));
        const encoded = share <= 0.0031308 ? 12.92 * share : 1.055 * share ** (1 / 2.4) - 0.055;
        return Math.round(encoded * 255).toString(16).padStart(2, "0");
    };
    return `#${color.map(byte).join("")}`;
}

/** The linear colour of a screen code.
 * @param {string} text @returns {Vec3} */
export function linear(text) {
    const part = (/** @type {number} */ at) => {
        const encoded = Number.parseInt(text.slice(at, at + 2), 16) / 255;
        return encoded <= 0.04045 ? encoded / 12.92 : ((encoded + 0.055) / 1.055) ** 2.4;
    };
    return [part(1), part(3), part(5)];
}

/** A colour's strongest channel, and the colour divided by it; white for black.
 * @param {Vec3} color @returns {{ strength: number, color: Vec3 }} */
export function apart(color) {
    const strength = Math.max(...color);
    return strength > 0 ? { strength, color: /** @type {Vec3} */ (color.map((part) => part / strength)) } : { strength: 0, color: [1, 1, 1] };
}
