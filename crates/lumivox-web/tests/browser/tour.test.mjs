// The first page, on a phone: its room moves, chapters follow the scrolling, controls change the
// light, the benchmark's file can be imported, and dropped files open in the viewer.

import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { App, LINK } from "./harness/app.mjs";
import { Session } from "./harness/browser.mjs";
import { OBJ } from "./harness/files.mjs";
import { panorama } from "./harness/panorama.mjs";
import { freshPath, native } from "./harness/picture.mjs";

const PHONE = { viewport: { width: 360, height: 640 }, hasTouch: true, isMobile: true, acceptDownloads: true };
/** Pictures and times for a software GPU, by file of the page.
 * @type {Record<string, [string, string][]>} */
const SMALL = {
    "benchmark.js": [["{ width: 640, height: 360 }", "{ width: 48, height: 27 }"], ["resolution: 64", "resolution: 16"], ["[4000, 3, 2, 20_000]", "[200, 3, 1, 200_000]"]],
    "tour.js": [["width: 384, budget: 400", "width: 96, budget: 0"], ["GATHERED = 12", "GATHERED = 2"], ["viewer.html${DROPPED}", `viewer.html\${DROPPED}#${LINK}`]],
};

/** @type {Session} */
let session;
/** @type {App} */
let app;
before(async () => {
    session = await Session.start();
    app = await App.open(session, {
        path: "",
        context: PHONE,
        before: (page) => Promise.all(Object.entries(SMALL).map(([file, changes]) => page.route(`**/${file}`, async (route) => {
            const response = await route.fetch();
            let body = await response.text();
            for (const [from, to] of changes) {
                assert.ok(body.includes(from), `${file} has no ${from} any more`);
                body = body.replace(from, to);
            }
            await route.fulfill({ response, body });
        }))),
    });
});
after(() => session?.end());

/** Scrolls to a chapter, and waits until it is live. @param {string} name */
async function turnTo(name) {
    await app.page.locator(`figure[data-chapter=${name}]`).evaluate((figure) => figure.scrollIntoView({ block: "center", behavior: "instant" }));
    await app.page.waitForSelector(`figure[data-chapter=${name}] > canvas.live`);
}

/** The mean of the renderer's picture, 0 to 255. */
async function brightness() {
    const { data } = await app.pixels();
    return data.reduce((sum, value) => sum + value, 0) / data.length;
}

test("a picture is there at once, and the room moves soon", async () => {
    const picture = app.page.locator("figure[data-chapter=room] > img");
    assert.ok(await picture.evaluate(async (/** @type {HTMLImageElement} */ img) => {
        await img.decode();
        return img.naturalWidth === 16 * img.naturalHeight / 9;
    }));
    await app.page.waitForSelector("figure[data-chapter=room] > canvas.live");
    const marks = await app.page.evaluate(() => Object.fromEntries(performance.getEntriesByType("mark").map(({ name, startTime }) => [name, Math.round(startTime)])));
    console.log(`ms: started ${marks.started}, lit ${marks.loaded}, live ${marks.live}`);
    // Pictures also differ by the noise of a room at rest, so compare the sun.
    const sun = async () => (await app.call("scene")).lights[0].direction;
    /** @type {Set<string>} */
    const seen = new Set();
    for (let tries = 0; tries < 100 && seen.size < 4; tries += 1) {
        seen.add(String(await sun()));
        await app.page.waitForTimeout(100);
    }
    assert.equal(seen.size, 4, "the sun does not move");
    assert.match(await app.page.locator("#state").innerText(), /^Live: \d+ x \d+ pixels/);
    await app.messages.check();
});

test("nothing is wider than a phone", async () => {
    assert.equal(await app.page.evaluate(() => document.documentElement.scrollWidth), 360);
    const small = await app.page.locator("a:visible, button:visible:not(:disabled)").evaluateAll((all) =>
        all.filter((one) => one.closest("main") && !one.closest("p.weak") && one.getBoundingClientRect().height < 36).map((one) => one.textContent));
    assert.deepEqual(small, [], "too small for a finger");
});

test("all pictures of chapters are there", async () => {
    const missing = await app.page.locator("figure > img").evaluateAll((all) => Promise.all(all.map(async (img) => {
        /** @type {HTMLImageElement} */ (img).loading = "eager";
        return await /** @type {HTMLImageElement} */ (img).decode().then(() => "", () => /** @type {HTMLImageElement} */ (img).src);
    })));
    assert.deepEqual(missing.filter(Boolean), []);
});

test("closing the wall darkens the room", async () => {
    await turnTo("wall");
    const open = await brightness();
    await app.page.locator("#wall-open").fill("0");
    await app.page.locator("#wall pre b", { hasText: /^-?0$/ }).waitFor();
    let closed = open;
    for (let tries = 0; tries < 60 && closed > 75; tries += 1) {
        await app.page.waitForTimeout(250);
        closed = await brightness();
    }
    console.log(`brightness: open ${open.toFixed(1)}, closed ${closed.toFixed(1)}`);
    // Alpha is always 255, a quarter of the mean.
    assert.ok(open > 90 && closed < 75, `open ${open}, closed ${closed}`);
});

test("the lamp follows the arrow keys", async () => {
    await turnTo("lamp");
    const light = async () => (await app.call("scene")).lights[0].position;
    const before = await light();
    await app.page.locator(".lamp").press("ArrowUp");
    let after = before;
    for (let tries = 0; tries < 100 && after[1] === before[1]; tries += 1) {
        await app.page.waitForTimeout(100);
        after = await light();
    }
    assert.ok(after[1] > before[1] + 0.05, `${before} ${after}`);
});

test("the program imports the benchmark's file", async () => {
    await app.page.locator("#measure-start").click();
    await app.page.locator("#measured tr.own td").nth(3).waitFor();
    await app.page.locator("#measure-name input").fill("A software GPU | of a test");
    const download = app.page.waitForEvent("download");
    await app.page.locator("#measure-save").click();
    const file = await freshPath("result.json");
    await (await download).saveAs(file);
    const table = await native("bench", "--import", file);
    console.log(table);
    assert.match(table, /\n\| A software GPU \\\| of a test \| 1 \| whole frames \| [\d.]+ \| [\d.]+ \| [\d.]+ \| [\d.]+ \|\n$/);
    await writeFile(file, "{}");
    await assert.rejects(native("bench", "--import", file), /result\.json: .*missing field `kind`/);
    await app.messages.check();
});

test("a dropped model opens in the viewer", async () => {
    await app.drop(OBJ);
    await app.page.waitForURL(/viewer\.html#/);
    await app.page.waitForSelector('#title:text-is("corner")', { state: "attached" });
    // Without its .mtl the floor would have another name.
    assert.deepEqual((await app.call("materials")).map((/** @type {{ name: string }} */ { name }) => name), ["floor", "lamp"]);
    await app.messages.check();
});

test("the first chapter in view keeps its settings when the speed is known", async () => {
    await app.page.goto(`${session.address}#voxels`);
    await app.page.locator("#state", { hasText: /^Live: 96 x / }).waitFor();
    assert.equal((await app.call("settings")).resolution, 48);
});

test("a dropped panorama is put around the viewer's first scene", async () => {
    await app.drop([{ name: "hall.hdr", bytes: panorama() }]);
    await app.page.waitForURL(/viewer\.html#/);
    await app.page.waitForSelector('#panorama:has-text("hall")', { state: "attached" });
    assert.ok((await app.call("scene")).objects.length > 0);
    await app.messages.check();
});

test("without WebGPU the pictures stay, and a line says so", async () => {
    const plain = await Session.start({ webgpu: false });
    try {
        const without = await App.open(plain, { path: "", context: PHONE });
        await without.state("unsupported");
        assert.match(await without.page.locator("#state").innerText(), /^These are pictures: this browser has no WebGPU here/);
        assert.ok(await without.page.locator("figure[data-chapter=room] > img").isVisible());
        assert.equal(await without.page.locator(".control:visible, .lamp:visible, .line:visible").count(), 0);
        // Chromium's own.
        assert.deepEqual(without.messages.take().filter((text) => !/No available adapters/.test(text)), []);
    } finally {
        await plain.end();
    }
});
