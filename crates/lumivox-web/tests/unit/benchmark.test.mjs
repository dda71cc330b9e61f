// The benchmark of the first page: which clock its times are of.

import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { measure } from "../../page/benchmark.js";

/** By the GPU's clock, and of a whole frame, ms. */
const [GPU_MS, FRAME_MS] = [2, 10];

beforeEach(() => {
    let now = 0;
    mock.method(performance, "now", () => (now += 100));
    mock.method(globalThis, "fetch", async () => ({ json: async () => ({ version: "1" }) }));
    Object.defineProperty(globalThis, "navigator", { value: { userAgent: "test" }, configurable: true });
});
afterEach(() => mock.restoreAll());

/** Measures a GPU of which every frame takes as long.
 * @param {(call: number, frame: number) => number[]} stages the times of stages after a call of
 *   `load`, by the number of that call and of the frame after it */
async function measured(stages) {
    let [loads, frames] = [0, 0];
    /** @type {any} */
    const stage = {
        say() {},
        async ask(/** @type {string} */ call) {
            if (call !== "load") return undefined;
            [loads, frames] = [loads + 1, 0];
            return { scene: { lights: [{ name: "lamp" }] } };
        },
        async frame() {
            frames += 1;
            // Every second one is complete: the benchmark measures the others.
            return { frame_ms: FRAME_MS, complete: frames % 2 === 0, stages: stages(loads, frames).map((ms) => ({ name: "cones", ms })) };
        },
    };
    const { clock, cases } = await measure(stage, { name: "a GPU", is_fallback: false });
    assert.equal(cases.length, 4);
    return { clock, times: [...new Set(cases.flatMap(({ median_ms, p95_ms }) => [median_ms, p95_ms]))] };
}

const gpu = { clock: "timestamps", times: [GPU_MS] };
const whole = { clock: "frames", times: [FRAME_MS] };

test("times are those of the GPU, without the first frame after loading", async () => {
    assert.deepEqual(await measured((_, frame) => (frame === 1 ? [GPU_MS, 50] : [GPU_MS])), gpu);
});

test("frames without a time of the GPU are not counted", async () => {
    assert.deepEqual(await measured((_, frame) => (frame % 5 === 0 ? [] : [GPU_MS])), gpu);
});

test("all cases are measured by whole frames if one has no times of the GPU", async () => {
    assert.deepEqual(await measured(() => []), whole);
    assert.deepEqual(await measured((load) => (load === 1 ? [GPU_MS] : [2 * FRAME_MS])), whole);
});
