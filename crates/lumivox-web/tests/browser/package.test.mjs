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
before(async () => void (session = await Session.start()));
after(() => session?.end());

/** The example with a picture that a software GPU renders quickly. Its renderer is made global. */
async function example() {
    let text = await readFile(join(pageFolder(), "lumivox/example.html"), "utf8");
    for (const [from, to] of [['width="640" height="360"', 'width="64" height="36"'], ["frames: 32", "frames: 2"], ["resolution: 64", "resolution: 32"], ["const renderer =", "const renderer = globalThis.renderer ="]]) {
        assert.ok(text.includes(from), `the example has no ${from} any more`);
        text = text.replace(from, to);
    }
    return text;
}

test("the example renders, calls overlap, freed renderers throw", async () => {
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
    const seen = await app.page.evaluate(async (module) => {
        // @ts-ignore: the example leaves it there
        const { renderer } = globalThis;
        const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector("canvas"));
        const [, scene, , report, pixels] = await Promise.all([
            renderer.set({ resolution: 32, frames: 1, bounces: 1 }),
            renderer.loadScene("builtin:panel"),
            renderer.resize(48, 36),
            renderer.render(),
            renderer.readPixels(),
        ]);
        const { createRenderer } = await import(module);
        const free = await createRenderer(document.createElement("p")).then(() => "", (/** @type {Error} */ error) => error.message);
        renderer.free();
        const gone = await Promise.resolve().then(() => renderer.render()).then(() => "", (/** @type {Error} */ error) => error.message);
        return { name: scene.name, frame: report.frame, size: [pixels.width, pixels.height, canvas.width, canvas.height], free, gone };
    }, new URL("lumivox/lumivox.js", session.address).href);
    assert.deepEqual({ ...seen, free: "", gone: "" }, { name: "panel", frame: 1, size: [48, 36, 48, 36], free: "", gone: "" });
    assert.match(seen.free, /HTMLCanvasElement/);
    assert.notEqual(seen.gone, "");
    await app.check();
    await app.close();
});

test("README.md contains the example", async () => {
    const [readme, file] = await Promise.all(["README.md", "example.html"].map((name) => readFile(join(pageFolder(), "lumivox", name), "utf8")));
    assert.ok(readme.includes(file.trim()), "README.md and example.html must have the same example");
    const script = file.slice(file.indexOf("<script"));
    assert.ok(script.trim().split("\n").length <= 20, "the example has at most 20 lines");
});

test("the playground runs its code and shows errors", async () => {
    const app = await App.open(session, { path: "playground.html#let" });
    await app.page.evaluate(() => {
        const code = /** @type {HTMLTextAreaElement} */ (document.querySelector("textarea"));
        if (code.value !== "let") throw new Error(`the address gives "${code.value}"`);
        code.value = `import init, { createRenderer } from "lumivox";
            await init();
            const renderer = await createRenderer(document.querySelector("canvas"));
            document.querySelector("p").textContent = (await renderer.settings()).resolution + " voxels";
            await renderer.set({ resolutoin: 64 });`;
    });
    await app.page.getByRole("button", { name: "Run" }).click();
    await app.page.frameLocator("iframe").getByText(/^\d+ voxels$/).waitFor();
    await app.page.getByRole("alert").getByText('did you mean "resolution"').waitFor();
    app.messages.expect(/resolutoin/);
    assert.match(await app.page.evaluate(() => location.hash), /^#import/);
    await app.close();
});
