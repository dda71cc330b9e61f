// @ts-check
// The surroundings: a panorama's strength and rotation, or uniform light.

import { apart, hex, linear } from "./color.js";
import { byId, h, number, row, slider } from "./dom.js";

/** @typedef {import("./types.js").Environment} Environment */
/** @typedef {import("./types.js").EnvironmentChange} EnvironmentChange */
/** @typedef {import("./types.js").Vec3} Vec3 */

/** Fields for the surroundings.
 * @param {Environment} environment @param {(change: EnvironmentChange) => void} change */
export function showEnvironment(environment, change) {
    let { strength, color } = apart(environment.radiance);
    const tell = () => {
        environment.radiance = /** @type {Vec3} */ (color.map((part) => part * strength));
        change({ radiance: environment.radiance });
    };
    const strong = number(strength, (now) => {
        strength = now;
        tell();
    }, { min: 0 });
    const { panorama } = environment;
    if (panorama !== undefined) {
        const turn = slider("Rotation", environment.rotation_deg, { min: -180, max: 180, step: 1 }, (rotation_deg) => {
            environment.rotation_deg = rotation_deg;
            change({ rotation_deg });
        });
        byId("environment").replaceChildren(
            h("p", { class: "weak", id: "panorama" }, `Surroundings: ${panorama}`),
            row("Intensity", "factor", strong), row("Rotation", "°", turn),
        );
        return;
    }
    const tint = h("input", { type: "color", value: hex(color), "aria-label": "Colour of the surroundings" });
    tint.addEventListener("input", () => {
        color = apart(linear(tint.value)).color;
        tell();
    });
    byId("environment").replaceChildren(row("Surroundings", "cd/m²", h("span", { class: "pair" }, tint, strong)));
}
