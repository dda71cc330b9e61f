// Using the page: links, the split, saving, sizes, camera, names for screen readers.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { App, LINK, VIEWPORT } from "./harness/app.mjs";
import { Session } from "./harness/browser.mjs";
import { columns, different, flip, flipOfFiles, freshPath, png } from "./harness/picture.mjs";

/** How long keys are held to move, ms. */
const HELD = { delay: 150 };

/** @type {Session} */
let session;
/** @type {App} */
let app;
before(async () => {
    session = await Session.start();
    app = await App.show(session, "builtin:cornell", {
        context: { acceptDownloads: true, hasTouch: true },
    });
});
after(() => session?.end());

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
    const sharp = await App.show(session, "builtin:cornell", { link: "view=albedo" });
    await sharp.page.locator("#scale").evaluate((/** @type {HTMLInputElement} */ slider) => {
        slider.value = "1";
        slider.dispatchEvent(new Event("input"));
    });
    await sharp.page.setViewportSize(size);
    // Through the DOM: the page's policy blocks added style sheets.
    await sharp.page.evaluate(() => {
        for (const part of ["bar", "below", "split"]) document.getElementById(part)?.style.setProperty("visibility", "hidden");
    });
    await sharp.settled();
    const picture = await sharp.pixels();
    assert.deepEqual([picture.width, picture.height], [size.width, size.height]);
    const [shown, read] = [await freshPath("shown.png"), await freshPath("read.png")];
    await sharp.page.screenshot({ path: shown });
    await writeFile(read, png(picture));
    const difference = await flipOfFiles(read, shown);
    assert.ok(difference < 0.002, `FLIP ${difference} between what is shown and what is read back`);
    await sharp.check();
    await sharp.close();
});

test("a link carries camera, settings, split and picture", async () => {
    const app = await App.show(session, "builtin:cornell", { context: { permissions: ["clipboard-read", "clipboard-write"] } });
    await app.page.locator("#canvas").focus();
    await app.page.keyboard.press("ArrowLeft", HELD);
    await app.settled();
    await app.inPanel("View", () => app.page.locator("#compare").selectOption("albedo"));
    await app.inPanel("Volume", () => app.page.locator("#set-volume").selectOption("octree"));
    await app.page.locator("#link").click();
    await app.page.locator("#messages .note").waitFor();
    const address = await app.page.evaluate(() => navigator.clipboard.readText());
    assert.equal(address, app.page.url());
    const other = await App.open(session, { link: new URL(address).hash.slice(1) });
    await other.complete();
    const [ours, theirs] = [await app.call("settings"), await other.call("settings")];
    assert.deepEqual(theirs, ours);
    assert.equal(theirs.volume, "octree");
    assert.ok(!/grid_offset|tone_map/.test(address), `what is as usual needs no place in a link: ${address}`);
    const [from, to] = [await app.call("camera"), await other.call("camera")];
    for (const part of ["position", "target"]) {
        for (const axis of [0, 1, 2]) assert.ok(Math.abs(from[part][axis] - to[part][axis]) < 1e-5, `${part} ${from[part]} and ${to[part]}`);
    }
    assert.equal(different(await app.pixels(), await other.pixels()), 0);
    await other.check();
    await other.close();
    await app.check();
    await app.close();
});

test("a link with errors tells them, and shows the rest", async () => {
    const other = await App.open(session, { link: `scene=builtin:panel&${LINK}&bounces=many&nonsense=1&camera=1,2` });
    await other.complete();
    const text = await other.error();
    for (const part of ["bounces", "nonsense", "camera"]) assert.match(text, new RegExp(part));
    assert.equal((await other.call("scene")).name, "panel");
    await other.check();
    await other.close();
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
    await app.check();
});

test("the picture is saved as a PNG file", async () => {
    const [download] = await Promise.all([app.page.waitForEvent("download"), app.page.locator("#picture").click()]);
    assert.equal(download.suggestedFilename(), "cornell.png");
    const file = await freshPath("saved.png");
    await download.saveAs(file);
    assert.equal((await readFile(file)).readUInt32BE(16), 96);
    assert.equal(await flip(file, await app.pixels()), 0);
    await app.check();
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
    await app.check();
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
    await app.check();
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
    await app.check();
});

test("a phone has room for it, and every control has a name", async () => {
    const phone = await App.open(session, {
        link: `scene=builtin:cornell&${LINK}`,
        context: { viewport: { width: 360, height: 640 }, deviceScaleFactor: 2, isMobile: true, hasTouch: true },
    });
    await phone.complete();
    const width = () => phone.page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok((await width()) <= 360);
    assert.ok(await phone.page.locator("#panel").isHidden(), "a phone shows the picture first");
    await phone.page.locator("#panel-toggle").tap();
    await phone.page.evaluate(() => document.querySelectorAll("details").forEach((details) => (details.open = true)));
    assert.ok((await width()) <= 360);
    const tree = await phone.page.locator("body").ariaSnapshot();
    const controls = tree.split("\n").filter((line) => /^\s*- (button|checkbox|combobox|textbox|searchbox|slider|radio|spinbutton)\b/.test(line));
    assert.ok(controls.length > 50, `${controls.length} controls`);
    assert.deepEqual(controls.filter((line) => !/^\s*- \w+ "/.test(line)), [], "controls without a name");
    await phone.check();
    await phone.close();
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
    await app.check();
});
