// Scenes from files: dropped, fetched, broken.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { basename, join } from "node:path";
import { before, test } from "node:test";
import { BOUND, NATIVE } from "../harness/app.mjs";
import { serve } from "../harness/browser.mjs";
import { glb, OBJ, separate } from "../harness/files.mjs";
import { different, flip, nativePicture } from "../harness/picture.mjs";
import { app, session } from "../harness/viewer.mjs";

/** @type {Buffer} */
let cornell;
/** A VXCT scene with its model in a folder beside its own, as in the repository.
 * @type {{ name: string, bytes: Buffer }[]} */
const VXCT = ["scenes/cornell.scene", "models/quad.obj"].map((name) => ({
    name, bytes: readFileSync(new URL(`../../../../../${name}`, import.meta.url)),
}));
before(async () => {
    cornell = await glb("cornell");
    await session.serve([{ name: "cornell.glb", bytes: cornell }, ...OBJ, ...separate(cornell, "box of cornell"), ...VXCT]);
});

/** Waits for a scene's picture, and compares it with the native one of a file.
 * @param {string} name @param {string} file */
async function shows(name, file) {
    await app.page.waitForSelector(`#title:text-is("${name}")`, { state: "attached" });
    await app.complete();
    await app.check();
    await agrees(file);
}

/** Compares the picture with the native one of a file. @param {string} file */
async function agrees(file) {
    const difference = await flip(await nativePicture(join(session.folder, file), ...NATIVE), await app.pixels(), "file.png");
    console.log(`${file}: FLIP ${difference.toFixed(5)}`);
    assert.ok(difference <= BOUND, `FLIP ${difference} is above ${BOUND}`);
}

test("a .glb is dropped", async () => {
    await app.drop([{ name: "cornell.glb", bytes: cornell }]);
    await shows("cornell", "cornell.glb");
});

test("invalid scene files show an error, picture unchanged", async (t) => {
    const picture = await app.pixels();
    const [gltf, bin] = separate(cornell, "box");
    /** @type {[string, { name: string, bytes: Buffer | string }[], RegExp][]} */
    const broken = [
        ["a web page", [{ name: "page.glb", bytes: "<!doctype html><title>404</title>" }], /page\.glb/],
        ["nothing", [{ name: "empty.glb", bytes: "" }], /empty\.glb/],
        ["half a file", [{ name: "half.glb", bytes: cornell.subarray(0, cornell.length / 2) }], /half\.glb/],
        ["its first bytes", [{ name: "head.glb", bytes: cornell.subarray(0, 16) }], /head\.glb/],
        ["a .gltf without its .bin", [gltf], /box\.bin/],
        ["a .bin alone", [bin], /\.gltf|\.glb/],
        ["a .gltf with half of its .bin", [gltf, { ...bin, bytes: bin.bytes.subarray(0, 100) }], /box/],
        ["an .obj without faces", [{ name: "points.obj", bytes: "v 0 0 0\n" }], /points\.obj/],
        ["an .obj with numbers of nothing", [{ name: "far.obj", bytes: "v 0 0 0\nf 1 2 3\n" }], /far\.obj/],
        ["something else", [{ name: "notes.txt.zip", bytes: "PK" }], /notes/],
    ];
    for (const [what, files, message] of broken) {
        await t.test(what, async () => {
            await app.drop(files);
            const text = await app.error();
            console.log(`${what}: ${text}`);
            assert.match(text, message);
            assert.ok(text.length > 20 && !/--|panicked|undefined/.test(text), text);
            await app.complete();
            assert.equal(await app.page.locator("#title").textContent(), "cornell");
            assert.equal(different(picture, await app.pixels()), 0);
            await app.check();
        });
    }
});

test("an .obj is dropped with its .mtl", async () => {
    await app.drop(OBJ);
    await shows("corner", "corner.obj");
});

test("a scene of VXCT at an address finds its model in the folder above", async () => {
    await app.call("loadScene", new URL("scenes/cornell.scene", session.address).href);
    await app.render();
    await agrees("scenes/cornell.scene");
});

test("a scene of VXCT is dropped with its model", async () => {
    await app.drop(VXCT.map(({ name, bytes }) => ({ name: basename(name), bytes })));
    await shows("cornell", "scenes/cornell.scene");
});

test("a .gltf is dropped with its files", async () => {
    await app.drop(separate(cornell, "box of cornell"));
    await shows("box of cornell", "box of cornell.gltf");
});

test("files are chosen in the dialog", async () => {
    await app.page.locator("#files").setInputFiles(OBJ.map(({ name, bytes }) => ({ name, mimeType: "", buffer: Buffer.from(bytes) })));
    await shows("corner", "corner.obj");
});

test("files of a folder find each other by their paths", async () => {
    const [gltf, bin] = separate(cornell, "box");
    const text = gltf.bytes.toString().replace('"box.bin"', '"data/box.bin"');
    const info = await app.worker.evaluate(async ([text, base64]) => {
        const at = (/** @type {File} */ file, /** @type {string} */ path) =>
            Object.defineProperty(file, "webkitRelativePath", { value: path });
        const bin = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
        const files = [at(new File([bin], "box.bin"), "models/data/box.bin"), at(new File([text], "box.gltf"), "models/box.gltf")];
        // @ts-ignore
        return self.renderer.loadScene(files);
    }, [text, bin.bytes.toString("base64")]);
    assert.equal(info.name, "box");
    assert.equal(info.triangles, 40);
});

test("loading from another origin needs CORS", async () => {
    app.messages.expect(/blocked by CORS policy|net::ERR_FAILED/);
    const server = await serve(session.folder);
    try {
        const address = new URL("box%20of%20cornell.gltf", server.address).href;
        // Another origin: its server has to allow it, and lumivox-serve does not.
        await assert.rejects(app.call("loadScene", address), /cannot be read: .*allows other sites to read it/);
    } finally {
        server.end();
    }
});

test("a missing address shows an error", async () => {
    // The browser itself reports the 404.
    app.messages.expect(/404/);
    await app.inPanel("Scene", async () => {
        const field = app.page.locator("#address");
        await field.fill("nowhere/at-all.glb");
        await field.press("Enter");
        assert.match(await app.error(), /nowhere\/at-all\.glb.*no such file/);
    });
});
