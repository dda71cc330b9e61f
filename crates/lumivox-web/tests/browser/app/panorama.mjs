// Panoramas around a scene, and scenes lit only by their own emission.

import assert from "node:assert/strict";
import { test } from "node:test";
import { OBJ } from "../harness/files.mjs";
import { luminance, panorama } from "../harness/panorama.mjs";
import { different } from "../harness/picture.mjs";
import { app } from "../harness/viewer.mjs";

const HALL = panorama();

/** Waits until the page shows the panorama. */
async function surrounded() {
    await app.page.waitForSelector(`#panorama:has-text("hall")`, { state: "attached" });
    await app.settled();
    assert.equal((await app.call("environment")).panorama, "hall");
}

test("a panorama is dropped with a scene, turned and made brighter", async () => {
    await app.drop([...OBJ, { name: "hall.hdr", bytes: HALL }]);
    await app.page.waitForSelector(`#title:text-is("corner")`, { state: "attached" });
    await surrounded();
    // Look upwards, so that the border between bright and dim is far from the measured places.
    await app.call("setCamera", { position: [0, 1, 5], target: [0, 3.5, 0] });
    await app.render();
    const camera = await app.call("camera");
    /** Checks the background to a tenth, since a pixel covers several texels, away from edges of
     * the cube map. @param {number} turned @param {number} factor */
    const shows = async (turned, factor) => {
        /** @type {[number, number][]} */
        const places = [[0.3, 0.45], [0.7, 0.45]];
        for (const place of places) {
            const seen = (await app.call("probe", ...place)).luminance_cd_m2;
            const expected = factor * luminance(camera, place, 96 / 72, turned);
            console.log(`turned by ${turned}, times ${factor}: ${seen} cd/m2 at ${place}, expected ${expected}`);
            assert.ok(Math.abs(seen / expected - 1) < 0.1, `${seen} cd/m2 at ${place}, expected ${expected}`);
        }
    };
    await shows(0, 1);
    const plain = await app.pixels();
    await app.inPanel("Light", async () => {
        const number = app.page.locator("#environment").getByRole("spinbutton", { name: "Rotation" });
        await number.fill("90");
        await number.press("Enter");
        const factor = app.page.locator("#environment").getByRole("spinbutton", { name: "Intensity" });
        await factor.fill("0.25");
        await factor.press("Enter");
    });
    await app.render();
    await shows(90, 0.25);
    assert.ok(different(plain, await app.pixels()) > 1000);
});

test("invalid panoramas show an error, picture unchanged", async () => {
    const before = await app.pixels();
    for (const [name, bytes, message] of /** @type {[string, string | Buffer, RegExp][]} */ ([
        ["page.hdr", "<!doctype html>", /page\.hdr: it is a web page/],
        ["half.hdr", HALL.subarray(0, 200), /half\.hdr/],
    ])) {
        await app.drop([{ name, bytes }]);
        assert.match(await app.error(), message);
        await app.complete();
        assert.equal(different(before, await app.pixels()), 0);
    }
});

test("a hint shows while only emission lights", async () => {
    await app.load("builtin:panel");
    const hint = app.page.locator("#hint");
    assert.ok(await hint.isVisible());
    await app.inPanel("Light", () => app.page.locator("[data-add=point]").click());
    assert.ok(await hint.isHidden());
    await app.page.locator("#undo").click();
    await app.settled();
    assert.ok(await hint.isVisible());
    await app.drop(OBJ);
    await app.drop([{ name: "hall.hdr", bytes: HALL }]);
    await surrounded();
    assert.ok(await hint.isHidden());
});

test("a dropped panorama replaces staged surroundings", async () => {
    await app.inPanel("Scene", () => app.page.locator("#surroundings").selectOption("sky"));
    const staged = await app.call("scene");
    assert.ok(staged.lights.some((/** @type {any} */ { name }) => name === "default sun"));
    await app.drop([{ name: "hall.hdr", bytes: HALL }]);
    await surrounded();
    const { lights, objects } = await app.call("scene");
    assert.ok(!lights.some((/** @type {any} */ { name }) => name === "default sun"));
    assert.equal(objects.length, staged.objects.length);
    assert.equal(await app.page.locator("#surroundings").inputValue(), "panorama");
    // The automatic surroundings return.
    await app.inPanel("Scene", () => app.page.locator("#surroundings").selectOption("auto"));
    assert.notEqual((await app.call("environment")).panorama, "hall");
});
