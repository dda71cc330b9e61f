// @ts-check
// The status line: the present work, and how long it has taken.

import { grouped } from "./dom.js";

/** @typedef {import("./types.js").FrameReport} FrameReport */

/** The interval at which the elapsed time is updated, ms. */
export const EVERY_MS = 250;
/** Shorter waits and remaining times are not shown, ms. */
const PATIENCE_MS = 500;

/** An elapsed time.
 * @param {number} ms */
export function seconds(ms) {
    if (ms < 59_950) return `${(ms / 1000).toFixed(ms < 9_950 ? 1 : 0)} s`;
    return `${Math.floor(ms / 60_000)} min ${Math.round((ms % 60_000) / 1000)} s`;
}

/** @param {number} ms */
export const milliseconds = (ms) => `${ms < 10 ? ms.toFixed(1) : grouped(Math.round(ms))} ms`;

/** The text of the status line.
 * @param {FrameReport} report of the last frame @param {number} waited since then, ms */
export function statusText({ frame, frames, frame_ms, complete, reference_samples }, waited) {
    const parts = [`${frame}/${frames} frames`, milliseconds(frame_ms)];
    if (reference_samples !== undefined) parts.push(`reference ${reference_samples} samples`);
    if (complete) return parts.join(" · ");
    const left = (frames - frame) * frame_ms - waited;
    if (frame < frames && left > PATIENCE_MS) parts.push(`about ${seconds(left)} to go`);
    if (waited > PATIENCE_MS) parts.push(`waiting for ${frame < frames ? `frame ${frame + 1}` : "the reference"} for ${seconds(waited)}`);
    return parts.join(" · ");
}

/** The line of times, budget, scale and figures.
 * @param {FrameReport} report the last frame's @param {number} count of frames
 * @param {number} mean of their times, ms */
export function timesText({ frame_ms, budget_ms, scale, samples_per_pixel, history_frames }, count, mean) {
    const parts = [`Frame ${milliseconds(frame_ms)}, mean of ${count} ${milliseconds(mean)}`];
    if (budget_ms > 0) parts.push(`budget ${milliseconds(budget_ms)}, scale ${Math.round(100 * scale)} %`);
    if (samples_per_pixel !== undefined) parts.push(`${Math.round(samples_per_pixel)} cone samples a pixel`);
    if (history_frames !== undefined) parts.push(`light of ${history_frames.toFixed(1)} frames`);
    return parts.join(" · ");
}
