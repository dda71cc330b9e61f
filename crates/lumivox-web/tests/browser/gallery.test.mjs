// The gallery: its pictures exist, and the viewer can read its links.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { App, LINK } from "./harness/app.mjs";
import { Session } from "./harness/browser.mjs";

/** @type {Session} */
let session;
before(async () => void (session = await Session.start()));
after(() => session?.end());

test("the gallery has its pictures, and links to scenes", async () => {
    const app = await App.open(session, { path: "gallery.html" });
    const figures = await app.page.locator("figure").evaluateAll((figures) => Promise.all(figures.map(async (figure) => {
        const [picture, anchor] = [figure.querySelector("img"), figure.querySelector("a")];
        if (!picture || !anchor) throw new Error(`${figure.id} has no picture or no link`);
        picture.loading = "eager";
        await picture.decode();
        const ratio = (picture.naturalWidth * picture.height) / (picture.naturalHeight * picture.width);
        return { id: figure.id, ratio, link: anchor.href };
    })));
    assert.equal(figures.length, 10);
    for (const { id, ratio } of figures) assert.ok(Math.abs(ratio - 1) < 0.01, `${id} has another shape than the page says`);

    await app.check();
    await app.close();

    // Decodes each link, without rendering, on the viewer: the gallery may not compile WebAssembly.
    const viewer = await App.open(session);
    const problems = await viewer.page.evaluate(async (links) => {
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
    }, figures.map(({ link }) => link));
    assert.deepEqual(problems, []);
    await viewer.close();
});

test("a picture opens its scene, and the viewer leads back", async () => {
    const app = await App.open(session, { path: "gallery.html" });
    const anchor = app.page.locator("figure#glow a");
    // Small and quick.
    await anchor.evaluate((/** @type {HTMLAnchorElement} */ anchor, quick) => void (anchor.href += `&${quick}`), LINK);
    await anchor.click();
    await app.complete();
    assert.equal(await app.page.locator("#scene").inputValue(), "builtin:glow");
    assert.match(await app.page.locator("#gallery").getAttribute("href") ?? "", /^gallery\.html$/);
    await app.check();
    await app.close();
});
