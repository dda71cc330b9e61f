// The package in bundlers, and `lumivox/three`: three.js scenes of known light, and the example.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { join } from "node:path";
import { App } from "./harness/app.mjs";
import { Session } from "./harness/browser.mjs";
import { filesOf, project, vite, webpack } from "./harness/bundles.mjs";

/** The longest that compiling for SwiftShader takes. */
const COMPILED_MS = 240_000;

/** @type {Session} */
let session;
before(async () => {
    const folder = await project();
    const bundles = [
        await filesOf(await vite(join(folder, "cornell")), "vite"),
        await filesOf(await webpack(join(folder, "cornell"), "beside.js"), "webpack"),
        await filesOf(await webpack(join(folder, "cornell"), "inlined.js"), "inlined"),
        await filesOf(await webpack(join(folder, "forms"), "forms.js", "development"), "forms"),
        await filesOf(await vite(join(folder, "example")), "hall"),
        await filesOf(await vite(join(folder, "react")), "react"),
    ];
    session = await Session.start();
    await session.serve(bundles.flat());
});
after(() => session?.end());

/** The WebAssembly is the same in all bundles, so only one of them renders.
 * @type {[string, string, string, string | RegExp][]} */
const BUNDLES = [
    ["vite", "Vite bundles the package, and its page shows the scene", "", "cornell: 40 triangles"],
    ["webpack", "webpack bundles the package, whose WebAssembly answers", "#init", /^\d+ scenes/],
    ["inlined", "webpack bundles the entry with inlined WebAssembly, which answers", "#init", /^\d+ scenes/],
];
for (const [name, what, end, said] of BUNDLES) {
    test(what, async () => {
        const app = await App.open(session, { path: `${name}/index.html${end}` });
        await app.page.locator("p").getByText(said).waitFor({ timeout: COMPILED_MS });
        await app.check();
        await app.close();
    });
}

describe("scenes of three.js whose light is known, in a bundle of webpack", () => {
    /** @type {App} */
    let app;
    before(async () => {
        app = await App.open(session, { path: "forms/index.html" });
        await app.page.waitForSelector("html[data-state=ready]", { state: "attached", timeout: COMPILED_MS });
    });
    after(() => app?.close());

    /** @param {string} form @returns {Promise<any>} */
    // @ts-ignore: the page leaves it there
    const light = (form) => app.page.evaluate((form) => globalThis.forms[form](), form);
    /** @param {number} value @param {number} exact @param {number} error a share */
    const isNear = (value, exact, error) => assert.ok(Math.abs(value / exact - 1) < error, `${value}, not ${exact}`);

    test("a closed room that reflects half of what it emits is twice as bright", async () => {
        const [red, , blue] = await light("furnace");
        console.log(`furnace: ${red}`);
        isNear(red, 2, 0.05);
        isNear(blue, red, 0.001);
    });

    test("a mirrored room ignores unused vertex colours", async () => {
        isNear((await light("mirrored"))[0], 2, 0.05);
    });

    test("a lamp in a ball has the candela of three.js", async () => {
        const [red] = await light("ball");
        console.log(`ball: ${red}`);
        isNear(red, 1, 0.06);
    });

    test("a wall has the radiance of the sky that it faces, which turns as three.js turns it", async () => {
        isNear(await light("sky"), 3, 0.04);
        const { toX, toZ, turnedToX, turnedToZ } = await light("turnedSky");
        console.log(`half a sky: ${toX} ${toZ}; turned: ${turnedToX} ${turnedToZ}`);
        isNear(toX, 1, 0.05);
        isNear(toZ, 0.5, 0.1);
        isNear(turnedToX, 0.5, 0.1);
        assert.ok((await light("background")) > 0.99, "three.js turns +x to -z");
        isNear(turnedToZ, 1, 0.05);
        const { before, after } = await light("drawnSky");
        console.log(`drawn in place: ${before}, ${after}`);
        isNear(before, 1, 0.04);
        isNear(after, 3, 0.04);
    });

    test("light follows a skinned mesh", async () => {
        const { before, after } = await light("bone");
        console.log(`before ${before}, after ${after}`);
        // The sheet is now nearer, and above.
        assert.ok(after > 1.6 * before, `${before}, then ${after}`);
    });

    test("an emissive image updates the light when redrawn", async () => {
        const { before, after } = await light("image");
        assert.ok(before[0] > 0.3 && before[1] < 0.01 * before[0], `${before}`);
        assert.ok(after[1] > 0.3 && after[0] < 0.05 * after[1], `${after}`);
    });

    test("transparent things are drawn, and a map of a material's own is mirrored", async () => {
        const [, green, blue] = await light("sheet");
        assert.ok(blue > 0.9 && green < 0.1, `${green} ${blue}`);
        isNear((await light("ownMap"))[0], 1, 0.1);
    });

    test("probes light transparent things from all sides", async () => {
        const { first, room, toX, toZ, fromX } = await light("air");
        console.log(`in the air: room ${first}, then ${room}; half a sky: ${toX} ${toZ} ${fromX}`);
        isNear(first, 1, 0.15);
        isNear(room, 1, 0.06);
        isNear(toX, 0.5, 0.06);
        isNear(toZ, 0.25, 0.1);
        assert.ok(fromX < 0.02, `${fromX}`);
    });

    test("the page's own velocity stays", async () => {
        const [x] = await light("velocity");
        console.log(`velocity: ${x}`);
        assert.ok(x > 0.02, `${x}`);
    });

    test("bad options throw errors with code and remedy", async () => {
        const said = await light("wrong");
        assert.match(said.scene, /^value: .*createGi\(renderer, \{ scene, camera \}\)/);
        assert.match(said.empty, /^value: .*options\.bounds/);
        assert.match(said.resolution, /^value: .*multiple of 8/);
        assert.match(said.option, /^value: there is no option "glow"/);
        assert.match(said.webgl, /^no-webgpu: /);
        const map = "a material's own envMap is seen on it as three.js draws it; cones see scene.environment";
        assert.deepEqual(await light("notes"), [map]);
    });

    test("the console stays silent", () => app.check());

    test("a frame error is reported once and recoverable", async () => {
        assert.deepEqual(await light("misuse"), ["a frame has no new light: number 7 of a material is NaN"]);
        assert.match(app.messages.take().join(), /number 7 of a material is NaN/);
        isNear((await light("furnace"))[0], 2, 0.05);
        // A second dispose does nothing, and glass is black after it.
        assert.equal(await light("free"), 0);
        app.messages.check();
    });
});

test("the example shows its hall", async () => {
    const app = await App.open(session, { path: "hall/index.html", context: { viewport: { width: 96, height: 54 } } });
    await app.page.locator("p").getByText(/voxels, /).waitFor({ timeout: COMPILED_MS });
    assert.match(await app.page.locator("p").innerText(), /ms a frame; \d{4,} voxels/);
    await app.check();
    await app.close();
});

test("LumivoxGi lights a canvas of react-three-fiber, follows its props, and can be taken away", async () => {
    const app = await App.open(session, { path: "react/index.html" });
    await app.page.waitForFunction(() => document.documentElement.dataset.state, undefined, { timeout: COMPILED_MS });
    assert.equal(await app.page.evaluate(() => document.documentElement.dataset.state), "ready");
    // Fiber itself uses what three.js has deprecated.
    assert.deepEqual(app.messages.take().filter((text) => !/THREE\.Clock|PCFSoftShadowMap/.test(text)), []);
    /** Waits until the middle of the canvas has a radiance. @param {number} exact */
    const shows = async (exact) => {
        let red = Number.NaN;
        for (let tries = 0; tries < 40; tries += 1) {
            red = await middle(app);
            if (Math.abs(red / exact - 1) < 0.08) return;
            await app.page.waitForTimeout(250);
        }
        assert.fail(`the room has a radiance of ${red}, not ${exact}`);
    };
    /** @param {string} name @param {unknown} value */
    const set = (name, value) => app.page.evaluate(([name, value]) => /** @type {any} */ (globalThis)[String(name)](value), [name, value]);
    await shows(0.8);
    await set("setBright", false);
    await shows(0.2);
    await app.page.evaluate(() => void Object.assign(globalThis, { first: /** @type {any} */ (globalThis).gi }));
    await set("setCones", 12);
    await shows(0.2);
    assert.ok(await app.page.evaluate(() => /** @type {any} */ (globalThis).first === /** @type {any} */ (globalThis).gi), "a setting of the cones made the light again");
    await set("setThere", false);
    await shows(0.1);
    await app.check();
    await app.close();
});

/** Linear red in the middle of a page's canvas. @param {App} app */
async function middle(app) {
    const file = await app.page.locator("canvas").screenshot();
    return app.page.evaluate(async (base64) => {
        const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
        const context = new OffscreenCanvas(1, 1).getContext("2d");
        context?.drawImage(image, -(image.width >> 1), -(image.height >> 1));
        const value = (context?.getImageData(0, 0, 1, 1).data[0] ?? 0) / 255;
        return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
    }, file.toString("base64"));
}
