// Errors of the package's calls.

import assert from "node:assert/strict";
import { test } from "node:test";
import { app } from "../harness/viewer.mjs";

test("bad calls throw an Error and change nothing", async (t) => {
    await app.load("builtin:panel");
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
});

test("an abort signal cancels loading and keeps the scene", async () => {
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
});
