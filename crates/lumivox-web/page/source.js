// @ts-check
// The kind of a source, by its file names.

/** @typedef {import("./types.js").Source} Source */

const SCENE = /\.(gltf|glb|obj|ply|stl|scene|vxct|txt)$/i;
const PANORAMA = /\.(hdr|exr|pic|png|jpe?g)$/i;

/** The path of an address, without query and fragment.
 * @param {string} address */
const path = (address) => address.replace(/[?#].*$/, "");

/** True if a source is only a panorama, to be put around the present scene. Pictures beside a scene
 * are its textures.
 * @param {Source} source */
export function isPanorama(source) {
    if (typeof source === "string") return PANORAMA.test(path(source));
    return source.some(({ path }) => PANORAMA.test(path)) && !source.some(({ path }) => SCENE.test(path));
}

/** The name of a source.
 * @param {Source} source */
export function nameOf(source) {
    if (typeof source === "string") return source.replace(/^builtin:/, "");
    return (source.find(({ path }) => SCENE.test(path)) ?? source.find(({ path }) => PANORAMA.test(path)) ?? source[0]).path;
}
