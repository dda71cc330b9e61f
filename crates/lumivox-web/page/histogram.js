// @ts-check
// The histogram of the picture's luminance, in stops, with marks for middle grey and white.

import { byId } from "./dom.js";

/** @typedef {import("./types.js").Histogram} Histogram */

/** The shortest interval between drawings, ms. */
const EVERY_MS = 300;
/** The stops below and above white that are always shown. */
const [BELOW_WHITE, ABOVE_WHITE] = [12, 3];

/** The shown bins: those around the screen's range, and all that have pixels.
 * @param {Histogram} histogram @returns {{ first: number, end: number }} */
export function shown({ bins, white, bins_per_stop }) {
    const filled = (/** @type {number} */ bin) => bins[bin] > 0;
    const places = bins.map((_, bin) => bin);
    // The first bin holds black; it does not extend the range.
    const least = places.find((bin) => bin > 0 && filled(bin)) ?? bins.length;
    const most = places.findLast(filled) ?? 0;
    const first = Math.max(0, Math.min(least, Math.floor(white) - BELOW_WHITE * bins_per_stop, bins.length - 1));
    return { first, end: Math.min(bins.length, Math.max(most + 1, Math.ceil(white) + ABOVE_WHITE * bins_per_stop, first + 1)) };
}

/** The exposure in words.
 * @param {Histogram} histogram */
export function inWords({ stops, share_above_white }) {
    const percent = 100 * share_above_white;
    const clipped = percent < 0.05 ? "nothing" : `${percent < 10 ? percent.toFixed(1) : Math.round(percent)} %`;
    return `Exposed by ${stops.toFixed(1)} stops; ${clipped} is brighter than white`;
}

let isAsked = false;

/** Redraws the histogram while it is visible, at most every EVERY_MS.
 * @param {() => Promise<Histogram | undefined>} ask */
export async function followHistogram(ask) {
    if (isAsked || !byId("picture-section", HTMLDetailsElement).open) return;
    isAsked = true;
    // Ask only after the wait, so that the newest picture is shown.
    await new Promise((resolve) => setTimeout(resolve, EVERY_MS));
    isAsked = false;
    showHistogram(await ask());
}

/** @param {Histogram | undefined} histogram */
function showHistogram(histogram) {
    byId("histogram-place").hidden = histogram === undefined;
    const canvas = byId("histogram", HTMLCanvasElement);
    const { clientWidth, clientHeight } = canvas;
    const context = canvas.getContext("2d");
    if (!histogram || !context || clientWidth === 0) return;
    byId("histogram-words").textContent = inWords(histogram);
    canvas.width = clientWidth * devicePixelRatio;
    canvas.height = clientHeight * devicePixelRatio;
    context.scale(devicePixelRatio, devicePixelRatio);
    const { first, end } = shown(histogram);
    const bins = histogram.bins.slice(first, end);
    const width = clientWidth / bins.length;
    const x = (/** @type {number} */ bin) => (bin - first) * width;
    // A few bins hold most of the pixels: square roots make the rest visible.
    const most = Math.sqrt(Math.max(...bins, 1));
    bins.forEach((count, index) => {
        const height = (Math.sqrt(count) / most) * clientHeight;
        context.fillStyle = first + index >= histogram.white ? "#ff7b72" : "#a3a7af";
        context.fillRect(index * width, clientHeight - height, Math.max(1, width - 0.5), height);
    });
    for (const [bin, color] of /** @type {[number, string][]} */ ([[histogram.middle_grey, "#f2a93b"], [histogram.white, "#ffffff"]])) {
        context.fillStyle = color;
        context.fillRect(x(bin) - 0.5, 0, 1, clientHeight);
    }
}
