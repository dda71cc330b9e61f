// @ts-check
// The line that says what is being waited for, and for how long.

import { grouped } from "./dom.js";

/** @typedef {import("./types.js").FrameReport} FrameReport */

/** How often the time that is waited is told anew, ms. */
export const EVERY_MS = 250;
/** What comes sooner is not waited for, ms. */
const PATIENCE_MS = 500;

/** A time that someone waits.
 * @param {number} ms */
export function seconds(ms) {
    if (ms < 59_950) return `${(ms / 1000).toFixed(ms < 9_950 ? 1 : 0)} s`;
    return `${Math.floor(ms / 60_000)} min ${Math.round((ms % 60_000) / 1000)} s`;
}

/** @param {number} ms */
export const milliseconds = (ms) => `${ms < 10 ? ms.toFixed(1) : grouped(Math.round(ms))} ms`;

/** The line of a picture that gets better.
 * @param {FrameReport} report the last frame's @param {number} waited since it came, ms */
export function statusText({ frame, frames, frame_ms, complete, reference_samples }, waited) {
    const parts = [`${frame}/${frames} frames`, milliseconds(frame_ms)];
    if (reference_samples !== undefined) parts.push(`reference ${reference_samples} samples`);
    if (complete) return parts.join(" · ");
    const left = (frames - frame) * frame_ms - waited;
    if (frame < frames && left > PATIENCE_MS) parts.push(`about ${seconds(left)} to go`);
    if (waited > PATIENCE_MS) parts.push(`waiting for ${frame < frames ? `frame ${frame + 1}` : "the reference"} for ${seconds(waited)}`);
    return parts.join(" · ");
}
