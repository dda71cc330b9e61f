// @ts-check
// The light under the mouse: illuminance and luminance.

import { byId, grouped } from "./dom.js";

/** @typedef {import("./types.js").LightHere} LightHere */

/** The shortest interval between requests, ms. */
const EVERY_MS = 120;

/** Three digits of a number that spans many powers of ten.
 * @param {number} value */
export function threeDigits(value) {
    if (value >= 1000) return grouped(Number(value.toPrecision(3)));
    return value > 0 && value < 1e-3 ? value.toExponential(1) : String(Number(value.toPrecision(3)));
}

/** @param {LightHere | undefined} light */
export function lightText(light) {
    if (!light) return "";
    const seen = `${threeDigits(light.luminance_cd_m2)} cd/m²`;
    return light.illuminance_lux === undefined ? seen : `${threeDigits(light.illuminance_lux)} lux · ${seen}`;
}

export class Probe {
    /** The mouse, from 0 to 1; null if outside. @type {{ x: number, y: number } | null} */
    #place = null;
    #isAsking = false;
    #isDue = false;
    #ask;

    /** @param {HTMLElement} canvas
     * @param {(place: { x: number, y: number }) => Promise<LightHere | undefined>} ask */
    constructor(canvas, ask) {
        this.#ask = ask;
        canvas.addEventListener("pointermove", (event) => {
            // While dragging, the user looks at something else.
            if (event.buttons !== 0) return this.#leave();
            const { left, top, width, height } = canvas.getBoundingClientRect();
            const inside = (/** @type {number} */ share) => Math.min(1, Math.max(0, share));
            this.#place = { x: inside((event.clientX - left) / width), y: inside((event.clientY - top) / height) };
            this.look();
        });
        canvas.addEventListener("pointerleave", () => this.#leave());
    }

    /** Asks again after the mouse or the picture changed. */
    look() {
        this.#isDue = true;
        if (!this.#isAsking) void this.#all();
    }

    async #all() {
        this.#isAsking = true;
        while (this.#isDue && this.#place) {
            this.#isDue = false;
            // A lost device is reported elsewhere.
            const light = await this.#ask(this.#place).catch(() => undefined);
            byId("probe").textContent = this.#place ? lightText(light) : "";
            await new Promise((resolve) => setTimeout(resolve, EVERY_MS));
        }
        this.#isAsking = false;
    }

    #leave() {
        this.#place = null;
        byId("probe").textContent = "";
    }
}
