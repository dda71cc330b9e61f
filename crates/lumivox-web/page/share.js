// @ts-check
// Sharing: a link to the present picture, and the picture as a file.

import { same } from "./parameters.js";
import { encode } from "./link.js";
import { say } from "./messages.js";

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").Environment} Environment */
/** @typedef {import("./types.js").LinkState} LinkState */
/** @typedef {import("./types.js").ParameterInfo} ParameterInfo */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {import("./types.js").Source} Source */
/** @typedef {import("./types.js").Split} Split */

/** The content of a link. It has only the settings set by hand: VXCT's own settings change with the
 * volume, and setting them would select its look. Defaults are left out, except with a preset,
 * whose values may differ.
 * @param {{ source: Source | null, panorama?: Source | null, environment?: Environment,
 *   preset?: string, camera: Camera | null, split?: Split | null, scale?: number,
 *   settings: Settings, touched: Set<string> }} now
 * @param {ParameterInfo[]} parameters @returns {LinkState} */
export function linkState({ source, panorama, environment, preset, camera, split, scale, settings, touched }, parameters) {
    const carried = parameters.filter(({ name, default: first }) =>
        settings[name] !== undefined && touched.has(name) && (preset !== undefined || !same(settings[name], first)));
    /** @type {LinkState} */
    const state = { settings: Object.fromEntries(carried.map(({ name }) => [name, settings[name]])) };
    if (typeof source === "string") state.scene = source;
    if (typeof panorama === "string" && environment) {
        const [red] = environment.radiance;
        state.environment = panorama;
        if (red !== 1) state.environment_intensity = red;
        if (environment.rotation_deg !== 0) state.environment_rotation = environment.rotation_deg;
    }
    if (preset !== undefined) state.preset = preset;
    if (camera) state.camera = camera;
    if (split) state.split = split;
    if (scale !== undefined) state.scale = scale;
    return state;
}

/** Puts a link into the address bar.
 * @param {LinkState} state */
export function showLink(state) {
    const address = new URL(`#${encode(state)}`, location.href).href;
    history.replaceState(null, "", address);
    return address;
}

/** Copies a link, or shows it if the browser does not let a page copy.
 * @param {LinkState} state */
export async function copyLink(state) {
    const address = showLink(state);
    const note = state.scene === undefined ? " It carries the camera and the settings, but not your file." : "";
    try {
        await navigator.clipboard.writeText(address);
        say(`The link is copied.${note}`, { kind: "note" });
    } catch {
        say(`This browser does not let a page copy: here is the link.${note}`, { kind: "note", link: address });
    }
}

/** Hands a picture to the browser's downloads.
 * @param {Blob} picture @param {string} name of the scene */
export function download(picture, name) {
    save(picture, `${name.replace(/[^\w.-]+/g, "-") || "picture"}.png`);
}

/** Hands a file to the browser's downloads.
 * @param {Blob} file @param {string} name */
export function save(file, name) {
    const anchor = document.createElement("a");
    anchor.href = URL.createObjectURL(file);
    anchor.download = name;
    anchor.click();
    // The download has begun by then.
    setTimeout(() => URL.revokeObjectURL(anchor.href), 60_000);
}
