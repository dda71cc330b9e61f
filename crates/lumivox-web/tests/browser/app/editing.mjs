// Editing on the page besides settings: materials, selection, undo, cancelling.

import assert from "node:assert/strict";
import { test } from "node:test";
import { VIEWPORT } from "../harness/app.mjs";
import { colors, different } from "../harness/picture.mjs";
import { app } from "../harness/viewer.mjs";

test("materials are edited in the panel", async () => {
    await app.load("builtin:cornell");
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
});

test("a double click selects the orbit target", async () => {
    await app.load("builtin:spheres");
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
    // The clicked point is now in the middle.
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
    // F frames the selected object.
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
});

test("a loading is cancelled, and the last scene stays", async () => {
    await app.load("builtin:cornell");
    const before = await app.pixels();
    // A request that is never answered.
    await app.page.route("**/endless.glb", () => {});
    await app.inPanel("Scene", async () => {
        const field = app.page.locator("#address");
        await field.fill("endless.glb");
        await field.press("Enter");
        await app.page.locator("#loading-time", { hasText: /^\d\.[5-9] s$/ }).waitFor();
        assert.match((await app.page.locator("#loading-stage").textContent()) ?? "", /Loading endless\.glb/);
        await app.page.locator("#loading-cancel").click();
        await app.note("endless.glb was cancelled");
    });
    await app.complete();
    assert.equal((await app.call("scene")).name, "cornell");
    assert.equal(different(before, await app.pixels()), 0);
    assert.ok(await app.page.locator("#loading").isHidden());
});

test("the picture fills the screen, and comes back", async () => {
    await app.load("builtin:cornell");
    const button = app.page.locator("#fullscreen");
    const isFull = () => app.page.evaluate(() => document.fullscreenElement !== null);
    // The page is notified a moment after the browser has switched.
    const isPressed = (/** @type {string} */ pressed) => app.page.locator(`#fullscreen[aria-pressed=${pressed}]`).waitFor();
    await button.click();
    await isPressed("true");
    assert.equal(await isFull(), true);
    assert.ok(await app.page.locator("#panel").isHidden());
    await app.page.keyboard.press("Alt+Enter");
    await isPressed("false");
    assert.equal(await isFull(), false);
    await app.settled();
    assert.ok(colors(await app.pixels()) > 100);
});

test("undo and redo restore changes", async () => {
    await app.load("builtin:cornell");
    const before = await app.pixels();
    const undo = app.page.locator("#undo");
    const lights = (await app.call("scene")).lights.length;
    assert.ok(await undo.isDisabled());
    await app.inPanel("Objects", () => app.page.locator("#objects input[type=checkbox]").first().click());
    await app.inPanel("Light", () => app.page.locator("[data-add=point]").click());
    const after = await app.pixels();
    assert.ok(different(before, after) > 100);
    assert.match((await undo.getAttribute("title")) ?? "", /^Undo: .*light/i);
    await app.page.locator("#canvas").focus();
    await app.page.keyboard.press("Control+z");
    await app.settled();
    assert.equal((await app.call("scene")).lights.length, lights);
    await undo.click();
    await app.settled();
    assert.equal(different(before, await app.pixels()), 0);
    assert.ok(await undo.isDisabled());
    assert.ok(await app.page.locator("#objects input[type=checkbox]").first().isChecked());
    await app.page.keyboard.press("Control+Shift+z");
    await app.page.keyboard.press("Control+y");
    await app.settled();
    assert.equal(different(after, await app.pixels()), 0);
    assert.ok(await app.page.locator("#redo").isDisabled());
    // Undo includes settings, but not the window's size.
    await app.inPanel("View", () => app.page.locator("input[name=view][value=albedo]").click());
    await app.page.setViewportSize({ width: 320, height: 240 });
    await app.settled();
    await undo.click();
    await app.settled();
    assert.equal((await app.call("settings")).view, "final");
    assert.equal((await app.pixels()).width, 80);
    await app.page.setViewportSize(VIEWPORT);
    await app.settled();
});

test("the light under the mouse and the histogram are those of the picture", async () => {
    await app.load("builtin:furnace");
    // A furnace has the same luminance everywhere.
    const { luminance_cd_m2, illuminance_lux } = await app.call("probe", 0.5, 0.5);
    await app.page.mouse.move(VIEWPORT.width / 2, VIEWPORT.height / 2);
    const shown = app.page.locator("#probe", { hasText: /lux · .* cd\/m²/ });
    await shown.waitFor();
    const [lux, seen] = [...((await shown.textContent()) ?? "").replaceAll("\u202f", "").matchAll(/[\d.]+(?:e-?\d+)?/g)].map(Number);
    assert.ok(Math.abs(seen / luminance_cd_m2 - 1) < 0.01, `${seen} and ${luminance_cd_m2}`);
    assert.ok(Math.abs(lux / illuminance_lux - 1) < 0.01, `${lux} and ${illuminance_lux}`);
    const { bins, bins_per_stop, first_stop, white, middle_grey } = await app.call("histogram");
    const place = Math.floor((Math.log2(luminance_cd_m2) - first_stop) * bins_per_stop);
    const around = bins.slice(place - 1, place + 2).reduce((/** @type {number} */ sum, /** @type {number} */ count) => sum + count, 0);
    const all = bins.reduce((/** @type {number} */ sum, /** @type {number} */ count) => sum + count, 0);
    assert.equal(all, 96 * 72);
    assert.ok(around > 0.5 * all, `${around} of ${all} pixels`);
    assert.ok(Math.abs(white - middle_grey - bins_per_stop * Math.log2(1 / 0.18)) < 1e-3);
    await app.inPanel("Picture", async () => {
        await app.page.locator("#histogram-words", { hasText: /Exposed by .* stops/ }).waitFor();
        const drawn = await app.page.locator("#histogram").evaluate((/** @type {HTMLCanvasElement} */ canvas) => {
            const { data } = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")).getImageData(0, 0, canvas.width, canvas.height);
            return data.filter((byte, at) => at % 4 === 3 && byte > 0).length;
        });
        assert.ok(drawn > 100, `${drawn} pixels of the histogram`);
    });
    await app.page.mouse.move(0, 0);
});

test("a coarse picture precedes the requested one", async () => {
    const seen = await app.worker.evaluate(async () => {
        // @ts-ignore
        const { renderer } = self;
        await renderer.set({ resolution: 40 });
        /** @type {string[]} */
        const events = [];
        const context = GPUCanvasContext.prototype;
        const texture = context.getCurrentTexture;
        context.getCurrentTexture = function () {
            events.push("picture");
            return texture.call(this);
        };
        const scene = await renderer.loadScene("builtin:spheres", (/** @type {{ stage: string }} */ { stage }) => void (events.at(-1) !== stage && events.push(stage)));
        context.getCurrentTexture = texture;
        return { events, voxels: scene.voxels, resolution: (await renderer.settings()).resolution };
    });
    console.log(seen.events.join(", "));
    const [first, last] = [seen.events.indexOf("picture"), seen.events.lastIndexOf("voxelize")];
    assert.ok(first > 0 && last > first, seen.events.join(", "));
    assert.equal(seen.resolution, 40);
    await app.render();
    assert.equal((await app.call("render")).frame, 2);
    await app.call("set", { resolution: 32 });
    await app.render();
});
