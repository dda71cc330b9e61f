// The status line.

import assert from "node:assert/strict";
import { test } from "node:test";
import { seconds, statusText, timesText } from "../../page/status.js";

const report = { frame: 4, frames: 16, frame_ms: 800, complete: false, stages: [] };

test("times are rounded for reading", () => {
    assert.deepEqual([0, 1234, 12_345, 59_949, 61_000].map(seconds), ["0.0 s", "1.2 s", "12 s", "60 s", "1 min 1 s"]);
});

test("the status shows the remaining time", () => {
    assert.equal(statusText(report, 0), "4/16 frames · 800 ms · about 9.6 s to go");
    // A short remaining time is not shown.
    assert.equal(statusText({ ...report, frame: 15, frame_ms: 30 }, 10), "15/16 frames · 30 ms");
});

test("the status shows long waits and their reason", () => {
    assert.equal(statusText(report, 3000), "4/16 frames · 800 ms · about 6.6 s to go · waiting for frame 5 for 3.0 s");
    const traced = { ...report, frame: 16, reference_samples: 12 };
    assert.equal(statusText(traced, 2000), "16/16 frames · 800 ms · reference 12 samples · waiting for the reference for 2.0 s");
});

test("a complete picture shows no wait", () => {
    assert.equal(statusText({ ...report, frame: 16, complete: true }, 1e6), "16/16 frames · 800 ms");
});

test("the times line shows only known figures", () => {
    const still = { ...report, frame_ms: 20, budget_ms: 0, scale: 1 };
    assert.equal(timesText(still, 3, 25), "Frame 20 ms, mean of 3 25 ms");
    const moving = { ...still, budget_ms: 16, scale: Math.SQRT1_2, samples_per_pixel: 37.6, history_frames: 12.34 };
    assert.equal(
        timesText(moving, 80, 17),
        "Frame 20 ms, mean of 80 17 ms · budget 16 ms, scale 71 % · 38 cone samples a pixel · light of 12.3 frames",
    );
});
