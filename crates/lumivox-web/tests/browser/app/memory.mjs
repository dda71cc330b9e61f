// Memory does not grow from scene to scene.

import assert from "node:assert/strict";
import { test } from "node:test";
import { isRelease } from "../harness/environment.mjs";
import { glb } from "../harness/files.mjs";
import { app, session } from "../harness/viewer.mjs";

/** Scene loads. Memory is compared between load FIRST, when caches are filled, and the last. Each
 * of four scenes is loaded twice in between; a leaked one exceeds SLACK. A release also finds
 * small leaks. */
const LOADS = isRelease() ? 50 : 16;
const FIRST = 8;
/** Tolerance for garbage collectors and caches, bytes; a scene of this test takes 28 MiB. */
const SLACK = 24 << 20;

async function memory() {
    const wasm = await app.worker.evaluate(async () => {
        const lumivox = await import(new URL("lumivox/lumivox.js", self.location.href).href);
        const { memory } = await lumivox.default();
        // @ts-ignore: there by --expose-gc
        for (let time = 0; time < 3; time += 1) self.gc(), await new Promise((resolve) => setTimeout(resolve, 50));
        return memory.buffer.byteLength;
    });
    return { wasm, page: await session.memory("renderer"), gpu: await session.memory("GPU") };
}

test(`memory is stable over ${LOADS} scene loads`, async () => {
    const base64 = (await glb("panel")).toString("base64");
    const load = (/** @type {number} */ count) => app.worker.evaluate(async ([base64, count]) => {
        // @ts-ignore: the page leaves it there
        const renderer = self.renderer;
        const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
        const sources = ["builtin:cornell", new File([bytes], "panel.glb"), "builtin:spheres", "builtin:furnace"];
        for (let time = 0; time < count; time += 1) {
            await renderer.loadScene(sources[time % sources.length]);
            await renderer.render();
        }
    }, /** @type {const} */ ([base64, count]));
    await load(FIRST);
    const first = await memory();
    const middle = (LOADS - FIRST) / 2;
    await load(middle);
    const half = await memory();
    await load(LOADS - FIRST - middle);
    const last = await memory();
    const mebibytes = (/** @type {Record<string, number>} */ of) =>
        Object.entries(of).map(([what, bytes]) => `${what} ${(bytes / (1 << 20)).toFixed(1)} MiB`).join(", ");
    console.log(`after ${FIRST} loads: ${mebibytes(first)}\nafter ${FIRST + middle}: ${mebibytes(half)}\nafter ${LOADS}: ${mebibytes(last)}`);
    assert.equal(last.wasm, first.wasm, "WASM's memory must not have grown");
    for (const what of /** @type {const} */ (["page", "gpu"])) {
        assert.ok(last[what] <= first[what] + SLACK, `the ${what} process has grown from ${first[what]} to ${last[what]} bytes`);
    }
});
