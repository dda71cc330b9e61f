// The gallery: its pictures exist, and the viewer can read its links. It opens the viewer.

import assert from "node:assert/strict";
import { test } from "node:test";
import { LINK, VIEWPORT } from "../harness/app.mjs";
import { app } from "../harness/viewer.mjs";

/** Addresses of its pictures. @type {string[]} */
let links;

test("the gallery has its pictures", async () => {
    const figures = await app.page.locator("figure").evaluateAll((figures) => Promise.all(figures.map(async (figure) => {
        const [picture, anchor] = [figure.querySelector("img"), figure.querySelector("a")];
        if (!picture || !anchor) throw new Error(`${figure.id} has no picture or no link`);
        picture.loading = "eager";
        await picture.decode();
        const ratio = (picture.naturalWidth * picture.height) / (picture.naturalHeight * picture.width);
        return { id: figure.id, ratio, link: anchor.href };
    })));
    assert.equal(figures.length, 11);
    for (const { id, ratio } of figures) assert.ok(Math.abs(ratio - 1) < 0.01, `${id} has another shape than the page says`);
    links = figures.map(({ link }) => link);
});

test("a picture opens its scene, and the viewer leads back", async () => {
    const anchor = app.page.locator("figure#glow a");
    // Small and quick.
    await anchor.evaluate((/** @type {HTMLAnchorElement} */ anchor, quick) => void (anchor.href += `&${quick}`), LINK);
    await app.page.setViewportSize({ width: 360, height: 640 });
    await anchor.click();
    await app.complete();
    assert.ok(await app.page.locator("#panel").isHidden(), "a phone shows the picture first");
    assert.equal(await app.page.locator("#scene").inputValue(), "builtin:glow");
    assert.match(await app.page.locator("#gallery").getAttribute("href") ?? "", /^gallery\.html$/);
    await app.page.setViewportSize(VIEWPORT);
});

test("the viewer can read the links", async () => {
    // Decodes each, without rendering. The gallery may not compile WebAssembly.
    const problems = await app.page.evaluate(async (links) => {
        /** @type {any} */
        const lumivox = await import(new URL("lumivox/lumivox.js", location.href).href);
        const { decode } = await import(new URL("link.js", location.href).href);
        await lumivox.default();
        const scenes = lumivox.builtinScenes().map((/** @type {{ name: string }} */ { name }) => `builtin:${name}`);
        const known = { parameters: lumivox.parameters(), presets: lumivox.presets() };
        return links.flatMap((link) => {
            const { state, problems } = decode(new URL(link).hash, known);
            return scenes.includes(state.scene) ? problems : [...problems, `there is no scene "${state.scene}"`];
        });
    }, links);
    assert.deepEqual(problems, []);
});
