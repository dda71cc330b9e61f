// Using the page: the split, saving, sizes, camera, names for screen readers.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { test } from "node:test";
import { HELD, VIEWPORT } from "../harness/app.mjs";
import { columns, different, flip, flipOfFiles, freshPath, png } from "../harness/picture.mjs";
import { app } from "../harness/viewer.mjs";

const camera = () => app.call("camera");

/** Moves the camera; returns it before and after. @param {() => Promise<unknown>} move */
async function moved(move) {
    const from = await camera();
    await move();
    await app.settled();
    const to = await camera();
    assert.notDeepEqual(to, from);
    return [from, to];
}

const distance = (/** @type {any} */ { position, target }) => Math.hypot(...[0, 1, 2].map((axis) => position[axis] - target[axis]));

test("the canvas shows the picture", async () => {
    const size = { width: 120, height: 90 };
    await app.load("builtin:cornell");
    await app.call("set", { view: "albedo" });
    /** Hides or shows what covers the picture. @param {boolean} isBare @param {string} scale */
    const lay = (isBare, scale) => app.page.evaluate(([isBare, scale]) => {
        // Through the DOM: the page's policy blocks added style sheets.
        for (const part of ["bar", "below", "split"]) document.getElementById(part)?.style.setProperty("visibility", isBare ? "hidden" : "");
        const slider = /** @type {HTMLInputElement} */ (document.getElementById("scale"));
        slider.value = scale;
        slider.dispatchEvent(new Event("input"));
    }, /** @type {const} */ ([isBare, scale]));
    await app.page.setViewportSize(size);
    await lay(true, "1");
    await app.settled();
    const picture = await app.pixels();
    assert.deepEqual([picture.width, picture.height], [size.width, size.height]);
    const [shown, read] = [await freshPath("shown.png"), await freshPath("read.png")];
    await app.page.screenshot({ path: shown });
    await writeFile(read, png(picture));
    const difference = await flipOfFiles(read, shown);
    assert.ok(difference < 0.002, `FLIP ${difference} between what is shown and what is read back`);
    await lay(false, "0.25");
    await app.page.setViewportSize(VIEWPORT);
    await app.call("set", { view: "final" });
    await app.settled();
});

test("the split shows both views, each on its side", async () => {
    const still = { exposure: -1.5, view: "final" };
    const [direct, final] = [await app.pictureWith({ ...still, view: "direct" }), await app.pictureWith(still)];
    assert.ok(different(direct, final) > 1000);
    await app.inPanel("View", () => app.page.getByRole("button", { name: "direct | with indirect" }).click());
    const halves = await app.pixels();
    const middle = halves.width / 2;
    assert.equal(different(columns(halves, 0, middle), columns(direct, 0, middle)), 0, "the left half is direct light");
    assert.equal(different(columns(halves, middle, halves.width), columns(final, middle, halves.width)), 0, "the right half is all light");
    const handle = app.page.locator("#split");
    await handle.focus();
    await app.page.keyboard.press("Home");
    await app.complete();
    assert.equal(await handle.getAttribute("aria-valuenow"), "0");
    assert.equal(different(await app.pixels(), final), 0, "with the line at the left edge all is the right view");
    await app.page.keyboard.press("End");
    await app.complete();
    assert.equal(different(await app.pixels(), direct), 0, "with the line at the right edge all is the left view");
    await app.inPanel("View", () => app.page.getByRole("button", { name: "direct | with indirect" }).click());
    assert.equal(different(await app.pixels(), final), 0, "without the line all is the view of all light");
    await app.pictureWith({ exposure: "auto" });
});

test("the picture is saved as a PNG file", async () => {
    const [download] = await Promise.all([app.page.waitForEvent("download"), app.page.locator("#picture").click()]);
    assert.equal(download.suggestedFilename(), "cornell.png");
    const file = await freshPath("saved.png");
    await download.saveAs(file);
    assert.equal((await readFile(file)).readUInt32BE(16), 96);
    assert.equal(await flip(file, await app.pixels()), 0);
});

test("the picture has the window's size", async () => {
    const before = await app.pixels();
    await app.page.setViewportSize({ width: 320, height: 400 });
    await app.settled();
    const { width, height } = await app.pixels();
    assert.deepEqual([width, height], [80, 100]);
    await app.page.setViewportSize(VIEWPORT);
    await app.settled();
    assert.equal(different(before, await app.pixels()), 0, "the same window has the same picture");
});

test("mouse, wheel, keys and fingers move the camera", async () => {
    const [x, y] = [VIEWPORT.width / 2, VIEWPORT.height / 2];
    const { mouse, keyboard } = app.page;
    const drag = async (/** @type {"left" | "right"} */ button) => {
        await mouse.move(x, y);
        await mouse.down({ button });
        await mouse.move(x + 30, y + 10, { steps: 3 });
        await mouse.up({ button });
    };
    const [still, orbited] = await moved(() => drag("left"));
    assert.ok(Math.abs(distance(still) - distance(orbited)) < 1e-3, "orbiting keeps the distance");
    await moved(() => drag("right"));
    await moved(() => mouse.wheel(0, -300));
    await moved(() => keyboard.press("w", HELD));
    await moved(() => keyboard.press("Home"));
    const devtools = await app.page.context().newCDPSession(app.page);
    const touch = (/** @type {string} */ type, /** @type {{ x: number, y: number }[]} */ touchPoints) =>
        devtools.send("Input.dispatchTouchEvent", { type: /** @type {"touchMove"} */ (type), touchPoints });
    await moved(async () => {
        await touch("touchStart", [{ x, y }]);
        await touch("touchMove", [{ x: x + 20, y }]);
        await touch("touchEnd", []);
    });
    await moved(async () => {
        await touch("touchStart", [{ x: x - 20, y }, { x: x + 20, y }]);
        await touch("touchMove", [{ x: x - 40, y }, { x: x + 40, y }]);
        await touch("touchEnd", []);
    });
});

test("lights and objects change the picture, and back", async () => {
    await app.page.locator("#canvas").focus();
    await app.page.keyboard.press("Home");
    await app.settled();
    const before = await app.pixels();
    const box = app.page.locator("#objects input[type=checkbox]").first();
    await app.inPanel("Objects", () => box.click());
    assert.ok(different(before, await app.pixels()) > 100);
    await app.inPanel("Objects", () => box.click());
    assert.equal(different(before, await app.pixels()), 0);
    const lights = (await app.call("scene")).lights.length;
    await app.inPanel("Light", () => app.page.locator("[data-add=point]").click());
    assert.equal((await app.call("scene")).lights.length, lights + 1);
    assert.ok(different(before, await app.pixels()) > 100);
    await app.inPanel("Light", async () => {
        await app.page.locator("#lights details").last().evaluate((/** @type {HTMLDetailsElement} */ details) => (details.open = true));
        await app.page.locator("#lights").getByRole("button", { name: /Remove/ }).last().click();
    });
    assert.equal(different(before, await app.pixels()), 0);
});

test("a phone has room for it, and every control has a name", async () => {
    await app.page.setViewportSize({ width: 360, height: 640 });
    const width = () => app.page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok((await width()) <= 360);
    await app.page.locator("#panel-toggle").tap();
    const open = (/** @type {boolean} */ isOpen) =>
        app.page.evaluate((isOpen) => document.querySelectorAll("details").forEach((details) => (details.open = isOpen)), isOpen);
    await open(true);
    assert.ok((await width()) <= 360);
    const tree = await app.page.locator("body").ariaSnapshot();
    const controls = tree.split("\n").filter((line) => /^\s*- (button|checkbox|combobox|textbox|searchbox|slider|radio|spinbutton)\b/.test(line));
    assert.ok(controls.length > 50, `${controls.length} controls`);
    assert.deepEqual(controls.filter((line) => !/^\s*- \w+ "/.test(line)), [], "controls without a name");
    // An open histogram is measured in each frame.
    await open(false);
    await app.page.locator("#panel-toggle").tap();
    await app.page.setViewportSize(VIEWPORT);
    await app.settled();
});

test("ours | reference traces paths beside the picture", async () => {
    await app.load("builtin:cornell");
    await app.inPanel("View", async () => {
        const toggle = app.page.getByRole("button", { name: "ours | reference" });
        await toggle.click();
        await app.page.locator("#status", { hasText: /reference [1-9]\d* samples/ }).waitFor();
        await toggle.click();
    });
    assert.ok(await app.page.locator("#split").isHidden());
});
