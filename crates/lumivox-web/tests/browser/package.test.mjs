// The npm package without the page: its example, and errors of its calls.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { join } from "node:path";
import { App } from "./harness/app.mjs";
import { Session } from "./harness/browser.mjs";
import { pageFolder } from "./harness/environment.mjs";
import { colors } from "./harness/picture.mjs";

/** @type {Session} */
let session;
before(async () => {
    session = await Session.start();
});
after(() => session?.end());

/** The example with a picture that a software GPU renders quickly. */
async function example() {
    let text = await readFile(join(pageFolder(), "lumivox/example.html"), "utf8");
    for (const [from, to] of [['width="640" height="360"', 'width="64" height="36"'], ["frames: 32", "frames: 2"], ["resolution: 64", "resolution: 32"]]) {
        assert.ok(text.includes(from), `the example has no ${from} any more`);
        text = text.replace(from, to);
    }
    return text;
}

test("the example shows its picture", async () => {
    const body = await example();
    const app = await App.open(session, {
        path: "lumivox/example.html",
        before: (page) => page.route("**/example.html", (route) => route.fulfill({ body, contentType: "text/html" })),
    });
    app.messages.expect(/favicon/);
    await app.page.getByText("cornell: 40 triangles").waitFor();
    const file = await app.page.locator("canvas").screenshot();
    const shown = await app.page.evaluate(async (base64) => {
        const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
        const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
        context?.drawImage(image, 0, 0);
        return [...(context?.getImageData(0, 0, image.width, image.height).data ?? [])];
    }, file.toString("base64"));
    assert.ok(colors({ width: 64, height: 36, data: Buffer.from(shown) }) > 100, "the canvas shows no picture");
    await app.check();
    await app.close();
});

test("the example is the one of the package's page", async () => {
    const [readme, file] = await Promise.all(["README.md", "example.html"].map((name) => readFile(join(pageFolder(), "lumivox", name), "utf8")));
    assert.ok(readme.includes(file.trim()), "README.md and example.html must have the same example");
    const script = file.slice(file.indexOf("<script"));
    assert.ok(script.trim().split("\n").length <= 20, "the example has at most 20 lines");
});

test("the playground runs what is written there, and tells its errors", async () => {
    const app = await App.open(session, { path: "playground.html#let" });
    await app.page.evaluate(() => {
        const code = /** @type {HTMLTextAreaElement} */ (document.querySelector("textarea"));
        if (code.value !== "let") throw new Error(`the address gives "${code.value}"`);
        code.value = `import init, { createRenderer } from "lumivox";
            await init();
            const canvas = Object.assign(document.querySelector("canvas"), { width: 64, height: 36 });
            const renderer = await createRenderer(canvas);
            await renderer.set({ resolution: 32, frames: 2 });
            const { name } = await renderer.loadScene("builtin:cornell");
            while (!(await renderer.render()).complete);
            document.querySelector("p").textContent = name;
            await renderer.set({ resolutoin: 64 });`;
    });
    await app.page.getByRole("button", { name: "Run" }).click();
    await app.page.frameLocator("iframe").getByText("cornell").waitFor({ timeout: 240_000 });
    await app.page.getByRole("alert").getByText('did you mean "resolution"').waitFor();
    app.messages.expect(/resolutoin/);
    assert.match(await app.page.evaluate(() => location.hash), /^#import/);
    await app.close();
});

test("what is wrong is an Error with a code and a remedy, and nothing has changed", async (t) => {
    const app = await App.show(session, "builtin:panel");
    app.messages.expect(/404/);
    const settings = await app.call("settings");
    /** @type {[string, unknown[], string, RegExp][]} */
    const wrong = [
        ["set", [{ resolutoin: 64 }], "value", /did you mean "resolution"/],
        ["set", [{ resolution: 63 }], "value", /resolution.*8/],
        ["set", [{ bounces: "many" }], "value", /bounces.*0.*to/],
        ["set", [{ frames: 8, view: "inside" }], "value", /final/],
        ["set", ["fast"], "value", /names and values/],
        ["setPreset", ["best"], "value", /balanced/],
        ["setCamera", [{ position: [0, 0, 0], target: [0, 0, 0] }], "value", /target/],
        ["setCamera", [{ position: [0, 0] }], "value", /camera/],
        ["setLight", [99, {}], "value", /99/],
        ["addLight", [{ strength: 3 }], "value", /not a light.*strength/],
        ["addLight", [{ intensity: -1 }], "value", /intensity/],
        ["setHidden", [99, true], "value", /99/],
        ["setMaterial", [99, {}], "value", /no material 99/],
        ["setMaterial", [0, { roughness: 2 }], "value", /roughness of the material.*from 0 to 1/],
        ["setMaterial", [0, { glow: 2 }], "value", /glow/],
        ["setEnvironment", [{ rotation_deg: 1e3 }], "value", /-360 to 360/],
        ["setEnvironment", [{ panorama: "castle" }], "value", /loadPanorama/],
        ["loadPanorama", [3], "value", /a panorama is an address or a File/],
        ["loadPanorama", ["nothing.hdr"], "fetch", /no such file/],
        ["loadPanorama", ["lumivox/package.json"], "scene", /Radiance/],
        ["loadScene", ["builtin:cornell", null, { signal: 3 }], "value", /AbortSignal/],
        ["loadScene", ["builtin:cornell", null, { around: "sky" }], "value", /around/],
        ["pick", [2, 0], "value", /from 0 to 1/],
        ["play", [3], "value", /animation/],
        ["setTime", [-1], "value", /at least 0/],
        ["setSplit", [{ right: "left" }], "value", /reference/],
        ["resize", [0, 0], "value", /0/],
        ["loadScene", ["builtin:castle"], "scene", /cornell/],
        ["loadScene", [3], "value", /builtin:NAME/],
        ["loadScene", ["nothing.glb"], "fetch", /no such file/],
    ];
    for (const [method, args, code, message] of wrong) {
        await t.test(`${method}(${args.map((arg) => JSON.stringify(arg)).join(", ")})`, async () => {
            await assert.rejects(app.call(method, ...args), (/** @type {any} */ error) => {
                console.log(`${error.code}: ${error.message}`);
                assert.ok(error.isError);
                assert.match(error.message, message);
                assert.equal(error.code, code);
                return true;
            });
            assert.deepEqual(await app.call("settings"), settings);
            assert.equal((await app.call("scene")).name, "panel");
        });
    }
    await app.check();
    await t.test("a signal cancels a loading, and the last scene stays", () => cancels(app));
    await app.close();
});

/** @param {App} app with the scene "panel" */
async function cancels(app) {
    const seen = await app.worker.evaluate(async () => {
        // @ts-ignore: the page leaves it there
        const { renderer } = self;
        const outcomes = [];
        const load = async (/** @type {AbortSignal} */ signal, /** @type {() => void} */ hear, source = "builtin:cornell") =>
            renderer.loadScene(source, hear, { signal }).then(() => "loaded", (/** @type {any} */ error) => `${error.name} ${error.message}`);
        outcomes.push(await load(AbortSignal.abort(), () => {}));
        outcomes.push(await load(AbortSignal.abort(new Error("enough")), () => {}));
        // Abort while it reads, before the scene has changed.
        const abort = new AbortController();
        const bytes = new TextEncoder().encode("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        const files = [new File([bytes], "a.obj"), new File([""], "a.mtl")];
        outcomes.push(await renderer.loadScene(files, () => abort.abort(), { signal: abort.signal }).catch((/** @type {any} */ error) => error.name));
        const panorama = await renderer.loadPanorama("x.hdr", null, { signal: AbortSignal.abort() }).catch((/** @type {any} */ error) => error.name);
        return { outcomes, panorama, name: (await renderer.scene()).name };
    });
    const [first, second, third] = seen.outcomes;
    assert.match(first, /^AbortError/);
    assert.equal(second, "Error enough");
    assert.equal(third, "AbortError");
    assert.deepEqual([seen.panorama, seen.name], ["AbortError", "panel"]);
    await app.check();
}

test("calls may overlap, and a renderer that was freed is gone", async () => {
    const app = await App.open(session, { path: "lumivox/package.json" });
    // A bare file has no icon.
    app.messages.expect(/404/);
    const seen = await app.page.evaluate(async (module) => {
        const { default: init, createRenderer } = await import(module);
        await init();
        const canvas = Object.assign(document.createElement("canvas"), { width: 48, height: 36 });
        const renderer = await createRenderer(canvas);
        const [, scene, , report, pixels] = await Promise.all([
            renderer.set({ resolution: 32, frames: 1, bounces: 1 }),
            renderer.loadScene("builtin:cornell"),
            renderer.resize(64, 48),
            renderer.render(),
            renderer.readPixels(),
        ]);
        const free = await createRenderer(document.createElement("p")).then(() => "", (/** @type {Error} */ error) => error.message);
        renderer.free();
        const gone = await Promise.resolve().then(() => renderer.render()).then(() => "", (/** @type {Error} */ error) => error.message);
        return { name: scene.name, frame: report.frame, size: [pixels.width, pixels.height, canvas.width, canvas.height], free, gone };
    }, new URL("lumivox/lumivox.js", session.address).href);
    assert.deepEqual({ ...seen, free: "", gone: "" }, { name: "cornell", frame: 1, size: [64, 48, 64, 48], free: "", gone: "" });
    assert.match(seen.free, /HTMLCanvasElement/);
    assert.notEqual(seen.gone, "");
    await app.check();
    await app.close();
});
