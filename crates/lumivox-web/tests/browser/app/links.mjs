// Links to the viewer, and views that the browser keeps.

import assert from "node:assert/strict";
import { join } from "node:path";
import { before, test } from "node:test";
import { BOUND, HELD, LINK, NATIVE } from "../harness/app.mjs";
import { glb, separate } from "../harness/files.mjs";
import { panorama } from "../harness/panorama.mjs";
import { different, flip, nativePicture } from "../harness/picture.mjs";
import { app, session } from "../harness/viewer.mjs";

const HALL = panorama();
before(async () => {
    await session.serve([...separate(await glb("cornell"), "scenes/box of cornell", "box of cornell"), { name: "skies/hall.hdr", bytes: HALL }]);
});

/** Opens an address as a new page: the viewer keeps only what is in the link, or stored.
 * @param {string} address */
async function visit(address) {
    await app.page.goto("about:blank");
    await app.page.goto(address);
    await app.complete();
}

const camera = () => app.call("camera");

/** @param {any} one @param {any} other @param {number} error */
function sameView(one, other, error) {
    for (const part of ["position", "target"]) {
        for (const axis of [0, 1, 2]) assert.ok(Math.abs(one[part][axis] - other[part][axis]) < error, `${part} ${one[part]} and ${other[part]}`);
    }
}

test("a link carries camera, settings, split and picture, and views are kept under names", async () => {
    await app.load("builtin:cornell");
    await app.page.locator("#canvas").focus();
    await app.page.keyboard.press("ArrowLeft", HELD);
    await app.settled();
    const corner = await camera();
    await app.inPanel("Scene", async () => {
        await app.page.locator("#camera-name").fill("corner");
        await app.page.locator("#camera-name").press("Enter");
    });
    await app.page.locator("#canvas").focus();
    await app.page.keyboard.press("d", HELD);
    await app.settled();
    const from = await camera();
    assert.notDeepEqual(from, corner);
    await app.inPanel("View", () => app.page.locator("#compare").selectOption("albedo"));
    await app.inPanel("Volume", () => app.page.locator("#set-volume").selectOption("octree"));
    await app.page.locator("#link").click();
    await app.note("link is copied");
    const address = await app.page.evaluate(() => navigator.clipboard.readText());
    assert.equal(address, app.page.url());
    assert.ok(!/grid_offset|tone_map/.test(address), `what is as usual needs no place in a link: ${address}`);
    const [settings, picture] = [await app.call("settings"), await app.pixels()];
    await visit(address);
    assert.deepEqual(await app.call("settings"), settings);
    assert.equal(settings.volume, "octree");
    sameView(await camera(), from, 1e-5);
    assert.equal(different(await app.pixels(), picture), 0);
    await app.inPanel("Scene", () => app.page.locator("#camera").selectOption({ label: "corner" }));
    sameView(await camera(), corner, 1e-4);
    await app.inPanel("Scene", () => app.page.getByLabel("Forget this view").click());
    assert.equal(await app.page.locator("#camera option", { hasText: "corner" }).count(), 0);
});

test("a link fetches a scene and a panorama beside the page, and tells its errors", async () => {
    const around = "environment=skies/hall.hdr&environment_rotation=90&environment_intensity=2";
    await visit(new URL(`#scene=scenes/box%20of%20cornell.gltf&${LINK}&${around}&bounces=many&nonsense=1&camera=1,2`, session.address).href);
    const text = await app.error();
    for (const part of ["bounces", "nonsense", "camera"]) assert.match(text, new RegExp(part));
    const { panorama: name, rotation_deg, radiance } = await app.call("environment");
    assert.deepEqual([name, Math.round(rotation_deg), radiance], ["hall", 90, [2, 2, 2]]);
    const native = await nativePicture(join(session.folder, "scenes/box of cornell.gltf"), ...NATIVE,
        "--environment", join(session.folder, "skies/hall.hdr"), "--environment-rotation", "90", "--environment-intensity", "2");
    const difference = await flip(native, await app.pixels(), "linked.png");
    console.log(`linked: FLIP ${difference.toFixed(5)}`);
    assert.ok(difference <= BOUND, `FLIP ${difference} is above ${BOUND}`);
    await app.page.locator("#link").click();
    await app.note("link is copied");
    assert.match(app.page.url(), /environment=skies\/hall\.hdr&environment_intensity=2&environment_rotation=90/);
});

