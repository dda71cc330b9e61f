// Animations that are dropped on the page.

import assert from "node:assert/strict";
import { test } from "node:test";
import { app } from "../harness/viewer.mjs";

test("the time slider follows the playing animation", async () => {
    await app.drop([{ name: "swing.gltf", bytes: swing() }]);
    await app.page.waitForSelector(`#title:text-is("swing")`, { state: "attached" });
    await app.complete();
    const time = app.page.locator("#time");
    const play = app.page.locator("#play");
    await app.inPanel("Scene", async () => {
        await play.click();
        await app.page.waitForFunction(() => Number(/** @type {HTMLInputElement} */ (document.getElementById("time")).value) > 0.2);
        await play.click();
    });
    const shown = Number(await time.inputValue());
    assert.ok(shown > 0.2 && shown <= 100, `${shown}`);
    const report = await app.call("render");
    assert.ok(Math.abs(report.time_s - shown) < 0.02, `${report.time_s} s, but the slider says ${shown} s`);
    assert.equal(await app.page.locator("#time-value").textContent(), shown.toFixed(2));
});

test("a scene camera follows its animation", async () => {
    await app.drop([{ name: "swing.gltf", bytes: swing() }]);
    await app.page.waitForSelector(`#title:text-is("swing")`, { state: "attached" });
    await app.complete();
    const at = async (/** @type {number} */ share) => {
        await app.page.locator("#time").evaluate((/** @type {HTMLInputElement} */ input, share) => {
            input.valueAsNumber = share * Number(input.max);
            input.dispatchEvent(new Event("input", { bubbles: true }));
        }, share);
        await app.settled();
        return (await app.call("camera")).position.map((/** @type {number} */ place) => Math.round(place * 100) / 100 + 0);
    };
    // A turn by 180 degrees about z.
    assert.deepEqual(await at(0.5), [0, 1, 3]);
    assert.deepEqual(await at(1), [-1, 0, 3]);
    // Home goes to the animated place; a camera moved by hand stays.
    await app.page.locator("canvas").first().press("Home");
    await app.settled();
    assert.deepEqual(await at(0.5), [0, 1, 3]);
    await app.page.locator("canvas").first().hover();
    await app.page.mouse.wheel(0, 100);
    await app.settled();
    const byHand = await at(1);
    assert.ok(Math.abs(byHand[0]) < 0.5 && byHand[1] > 0.5 && byHand[2] !== 3, `${byHand}`);
});

/** A triangle that swings for a hundred seconds, with a camera on it (Khronos, glTF 2.0). */
function swing() {
    const floats = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 100, 0, 0, 0, 1, 0, 0, 1, 0];
    const bytes = Buffer.from(new Float32Array(floats).buffer);
    const view = (/** @type {number} */ from, /** @type {number} */ count) => ({ buffer: 0, byteOffset: 4 * from, byteLength: 4 * count });
    return JSON.stringify({
        asset: { version: "2.0" },
        scene: 0,
        scenes: [{ nodes: [0] }],
        nodes: [{ mesh: 0, children: [1] }, { name: "eye", camera: 0, translation: [1, 0, 3] }],
        cameras: [{ type: "perspective", perspective: { yfov: 1, znear: 0.01 } }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
        materials: [{ doubleSided: true, emissiveFactor: [1, 1, 1] }],
        animations: [{ channels: [{ sampler: 0, target: { node: 0, path: "rotation" } }], samplers: [{ input: 1, output: 2 }] }],
        accessors: [
            { bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] },
            { bufferView: 1, componentType: 5126, count: 2, type: "SCALAR", min: [0], max: [100] },
            { bufferView: 2, componentType: 5126, count: 2, type: "VEC4" },
        ],
        bufferViews: [view(0, 9), view(9, 2), view(11, 8)],
        buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
    });
}
