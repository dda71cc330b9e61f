// What is changed on the page besides settings: panoramas, materials, what is chosen, what is cancelled.

import assert from "node:assert/strict";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { App, LINK, NATIVE, VIEWPORT } from "./harness/app.mjs";
import { Session } from "./harness/browser.mjs";
import { glb } from "./harness/files.mjs";
import { panorama } from "./harness/panorama.mjs";
import { colors, different, flip, nativePicture } from "./harness/picture.mjs";

/** Pictures with a panorama: `BOUND`, and what seams between the faces of its cube add. */
const SURROUNDED = 0.09;

/** @type {Session} */
let session;
/** @type {string} */
let folder;
const HALL = panorama();
before(async () => {
    folder = await mkdtemp(join(tmpdir(), "lumivox-editing-"));
    await writeFile(join(folder, "hall.hdr"), HALL);
    session = await Session.start({ beside: [{ name: "skies/hall.hdr", bytes: HALL }] });
});
after(async () => {
    await session?.end();
    await rm(folder, { recursive: true });
});

/** Waits until the page shows what surrounds it. @param {App} app */
async function surrounded(app) {
    await app.page.waitForSelector("#panorama", { state: "attached" });
    await app.settled();
    await app.check();
    assert.equal((await app.call("environment")).panorama, "hall");
}

test("a panorama is dropped, turned and made brighter, as the native program shows it", async () => {
    const app = await App.show(session, "builtin:spheres", { link: "exposure=-7" });
    await app.drop([{ name: "hall.hdr", bytes: HALL }]);
    await surrounded(app);
    const file = join(folder, "hall.hdr");
    const native = (/** @type {string[]} */ ...more) => nativePicture("builtin:spheres", ...NATIVE, "--environment", file, "--exposure", "-7", ...more);
    const agrees = async (/** @type {string} */ path, /** @type {string} */ what) => {
        const difference = await flip(path, await app.pixels(), `${what}.png`);
        console.log(`${what}: FLIP ${difference.toFixed(5)}`);
        assert.ok(difference <= SURROUNDED, `${what}: FLIP ${difference} is above ${SURROUNDED}`);
    };
    const plain = await app.pixels();
    await agrees(await native(), "panorama");
    await app.inPanel("Light", async () => {
        const number = app.page.locator("#environment").getByRole("spinbutton", { name: "Rotation" });
        await number.fill("90");
        await number.press("Enter");
        const factor = app.page.locator("#environment").getByRole("spinbutton", { name: "Intensity" });
        await factor.fill("2");
        await factor.press("Enter");
    });
    const turned = await app.pixels();
    assert.ok(different(plain, turned) > 1000);
    await agrees(await native("--environment-rotation", "90", "--environment-intensity", "2"), "panorama-turned");
    await app.check();
    await app.close();
});

test("a link brings a panorama, and a scene is dropped with one", async () => {
    const app = await App.show(session, "builtin:spheres", { link: "environment=skies/hall.hdr&environment_rotation=90&environment_intensity=2" });
    const { panorama: name, rotation_deg, radiance } = await app.call("environment");
    assert.deepEqual([name, Math.round(rotation_deg), radiance], ["hall", 90, [2, 2, 2]]);
    await app.page.locator("#link").click();
    await app.page.locator("#messages .note").first().waitFor();
    assert.match(app.page.url(), /environment=skies\/hall\.hdr&environment_intensity=2&environment_rotation=90/);
    await app.drop([{ name: "hall.hdr", bytes: HALL }, { name: "cornell.glb", bytes: await glb("cornell") }]);
    await app.page.waitForSelector(`#title:text-is("cornell")`, { state: "attached" });
    await surrounded(app);
    // It took the place of what would have been put around it.
    await app.check();
    await app.close();
});

test("what is no panorama tells so, and the picture stays", async () => {
    const app = await App.show(session, "builtin:cornell");
    const before = await app.pixels();
    for (const [name, bytes, message] of /** @type {[string, string | Buffer, RegExp][]} */ ([
        ["page.hdr", "<!doctype html>", /page\.hdr.*Radiance/],
        ["half.hdr", HALL.subarray(0, 200), /half\.hdr/],
    ])) {
        await app.drop([{ name, bytes }]);
        assert.match(await app.error(), message);
        await app.complete();
        assert.equal(different(before, await app.pixels()), 0);
    }
    await app.check();
    await app.close();
});

test("materials are edited in the panel", async () => {
    const app = await App.show(session, "builtin:cornell");
    const before = await app.pixels();
    const materials = await app.call("materials");
    assert.ok(materials.every((/** @type {any} */ { shading }) => shading === "metallic-roughness"));
    const red = materials.findIndex((/** @type {any} */ { color: [r, g] }) => r > 2 * g);
    await app.inPanel("Materials", async () => {
        const fields = app.page.locator(`#materials details[data-number="${red}"]`);
        await fields.evaluate((/** @type {HTMLDetailsElement} */ details) => (details.open = true));
        await fields.getByLabel("Colour", { exact: true }).evaluate((/** @type {HTMLInputElement} */ input) => {
            input.value = "#0000ff";
            input.dispatchEvent(new Event("input"));
        });
        const roughness = fields.getByRole("spinbutton", { name: "Roughness" });
        await roughness.fill("0.25");
        await roughness.press("Enter");
        await fields.getByRole("spinbutton", { name: "Emission" }).fill("3");
        await fields.getByRole("spinbutton", { name: "Emission" }).press("Enter");
    });
    const changed = (await app.call("materials"))[red];
    assert.deepEqual([changed.color, changed.roughness, changed.emission], [[0, 0, 1], 0.25, [3, 3, 3]]);
    assert.ok(different(before, await app.pixels()) > 500);
    await app.check();
    await app.close();
});

test("a double click chooses what is there, and the camera orbits it", async () => {
    const app = await App.show(session, "builtin:spheres");
    const { objects, bounds } = await app.call("scene");
    const [x, y] = [VIEWPORT.width / 2, VIEWPORT.height * 0.55];
    const picked = await app.call("pick", x / VIEWPORT.width, y / VIEWPORT.height);
    const from = await app.call("camera");
    await app.page.mouse.dblclick(x, y);
    await app.settled();
    const to = await app.call("camera");
    assert.deepEqual(to.position, from.position);
    const way = [0, 1, 2].map((axis) => picked.position[axis] - to.position[axis]);
    const sight = [0, 1, 2].map((axis) => to.target[axis] - to.position[axis]);
    const cosine = way.reduce((sum, part, axis) => sum + part * sight[axis], 0) / Math.hypot(...way) / Math.hypot(...sight);
    assert.ok(cosine > 0.99999, `the camera looks past the point: ${cosine}`);
    assert.equal(await app.page.locator(".object[aria-current]").textContent(), objects[picked.object].name);
    // What was at the place of the click is in the middle now.
    const middle = await app.call("pick", 0.5, 0.5);
    assert.ok(Math.hypot(...[0, 1, 2].map((axis) => middle.position[axis] - picked.position[axis])) < 1e-2 * bounds.max[0]);
    // The orbit keeps its distance from it.
    await app.page.locator("#canvas").focus();
    const distance = (/** @type {any} */ { position }) => Math.hypot(...[0, 1, 2].map((axis) => position[axis] - picked.position[axis]));
    await app.page.mouse.move(x, y);
    await app.page.mouse.down();
    await app.page.mouse.move(x + 40, y, { steps: 3 });
    await app.page.mouse.up();
    await app.settled();
    assert.ok(Math.abs(distance(await app.call("camera")) / distance(to) - 1) < 1e-3);
    // F shows all of what was chosen.
    await app.page.keyboard.press("f");
    await app.settled();
    const framed = await app.call("camera");
    const center = [0, 1, 2].map((axis) => (picked.bounds.min[axis] + picked.bounds.max[axis]) / 2);
    const offset = [0, 1, 2].map((axis) => center[axis] - framed.position[axis]);
    const ahead = [0, 1, 2].map((axis) => framed.target[axis] - framed.position[axis]);
    const towards = offset.reduce((sum, part, axis) => sum + part * ahead[axis], 0) / Math.hypot(...offset) / Math.hypot(...ahead);
    assert.ok(towards > 0.9999, `${towards}`);
    await app.page.keyboard.press("Escape");
    assert.equal(await app.page.locator(".object[aria-current]").count(), 0);
    await app.check();
    await app.close();
});

test("a loading is cancelled, and the last scene stays", async () => {
    const app = await App.open(session, { link: `scene=builtin:cornell&${LINK}` });
    await app.complete();
    const before = await app.pixels();
    // A server that never ends.
    await app.page.route("**/endless.glb", () => {});
    await app.inPanel("Scene", async () => {
        const field = app.page.locator("#address");
        await field.fill("endless.glb");
        await field.press("Enter");
        await app.page.locator("#loading-time", { hasText: /^\d\.[5-9] s$/ }).waitFor();
        assert.match((await app.page.locator("#loading-stage").textContent()) ?? "", /Loading endless\.glb/);
        await app.page.locator("#loading-cancel").click();
        await app.page.locator("#messages .note", { hasText: "endless.glb was cancelled" }).waitFor();
    });
    await app.complete();
    assert.equal((await app.call("scene")).name, "cornell");
    assert.equal(different(before, await app.pixels()), 0);
    assert.ok(await app.page.locator("#loading").isHidden());
    await app.check();
    await app.close();
});

test("the slider of the time follows what plays", async () => {
    const app = await App.open(session, { link: LINK });
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
    await app.check();
    await app.close();
});

test("the picture fills the screen, and comes back", async () => {
    const app = await App.show(session, "builtin:cornell");
    const button = app.page.locator("#fullscreen");
    const isFull = () => app.page.evaluate(() => document.fullscreenElement !== null);
    await button.click();
    await app.page.waitForFunction(() => document.fullscreenElement !== null);
    assert.equal(await button.getAttribute("aria-pressed"), "true");
    assert.ok(await app.page.locator("#panel").isHidden());
    await app.page.keyboard.press("Alt+Enter");
    await app.page.waitForFunction(() => document.fullscreenElement === null);
    assert.equal(await isFull(), false);
    assert.equal(await button.getAttribute("aria-pressed"), "false");
    await app.settled();
    assert.ok(colors(await app.pixels()) > 100);
    await app.check();
    await app.close();
});

/** A triangle that swings for a hundred seconds (Khronos, glTF 2.0). */
function swing() {
    const floats = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 100, 0, 0, 0, 1, 0, 0, 1, 0];
    const bytes = Buffer.from(new Float32Array(floats).buffer);
    const view = (/** @type {number} */ from, /** @type {number} */ count) => ({ buffer: 0, byteOffset: 4 * from, byteLength: 4 * count });
    return JSON.stringify({
        asset: { version: "2.0" },
        scene: 0,
        scenes: [{ nodes: [0] }],
        nodes: [{ mesh: 0 }],
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
