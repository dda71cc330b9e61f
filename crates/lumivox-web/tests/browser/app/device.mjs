// Devices that are lost, refuse a request, or do not exist.

import assert from "node:assert/strict";
import { test } from "node:test";
import { App, LINK } from "../harness/app.mjs";
import { Session } from "../harness/browser.mjs";
import { different } from "../harness/picture.mjs";
import { app, session } from "../harness/viewer.mjs";

test("WebGPU validation messages reach the test harness", async () => {
    await app.worker.evaluate(async () => {
        const adapter = await navigator.gpu.requestAdapter();
        const device = await adapter?.requestDevice();
        device?.createBuffer({ size: 16, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.MAP_WRITE });
        await device?.queue.onSubmittedWorkDone();
        device?.destroy();
    });
    // The browser's messages are asynchronous.
    assert.match(await app.messages.next(), /warning \(rendering\): .*MapRead/);
    // The message may be repeated.
    app.messages.expect(/MapRead/);
});

test("requests beyond device limits are refused with alternatives", async (t) => {
    const before = await app.pixels();
    const settings = await app.call("settings");
    /** @type {[string, () => Promise<unknown>, RegExp][]} */
    const refused = [
        ["a volume", () => app.call("set", { resolution: 1024, view: "lod" }), /max_texture_dimension_3d.*set the resolution to at most 680/],
        ["an octree", () => app.call("set", { resolution: 128, volume: "octree", volume_memory: 1 }), /octree.*allow more, or set the resolution to/],
        ["a picture's width", () => app.call("resize", 20000, 16), /max_texture_dimension_2d.*ask for at most 8192x8192/],
        ["shadow maps", () => app.call("set", { shadow_resolution: 16384 }), /must be at most 8192/],
    ];
    for (const [what, ask, remedy] of refused) {
        await t.test(what, async () => {
            await assert.rejects(ask(), (/** @type {any} */ error) => {
                console.log(`${what}: ${error.code}: ${error.message}`);
                assert.equal(error.code, what === "shadow maps" ? "value" : "limit");
                assert.match(error.message, remedy);
                return true;
            });
            assert.deepEqual(await app.call("settings"), settings);
            await app.render();
            assert.equal(different(before, await app.pixels()), 0);
            await app.check();
        });
    }
    await t.test("by hand", async () => {
        const field = app.page.locator("#set-resolution");
        // A view of cells has this limit; others allow any resolution that fits memory.
        await app.call("set", { view: "lod" });
        await app.render();
        const cells = await app.pixels();
        await app.inPanel("Volume", async () => {
            await field.fill("1024");
            await field.press("Enter");
            const text = await app.error();
            assert.match(text, /set the resolution to at most 680/);
            assert.ok(!text.includes("--"), `a page has no command line: ${text}`);
        });
        assert.equal(await field.inputValue(), "32");
        assert.equal(different(cells, await app.pixels()), 0);
        await app.check();
        await app.call("set", { view: settings.view });
        await app.render();
        assert.equal(different(before, await app.pixels()), 0);
        await app.check();
    });
});

test("a browser without WebGPU is told which ones have it", async () => {
    const before = (/** @type {import("playwright-core").Page} */ page) =>
        page.addInitScript(() => Reflect.deleteProperty(Navigator.prototype, "gpu"));
    const without = await App.open(session, { link: `scene=builtin:cornell&${LINK}`, before });
    await without.state("unsupported");
    const text = await without.page.locator("#unsupported").innerText();
    for (const word of ["no WebGPU", "Chrome", "Edge", "Safari", "Firefox"]) assert.ok(text.includes(word), text);
    assert.ok(await without.page.locator("#stage").isHidden());
    await without.check();
    await without.close();
});

test("a browser without an adapter shows a message", async () => {
    const plain = await Session.start({ webgpu: false });
    try {
        const without = await App.open(plain, { link: `scene=builtin:cornell&${LINK}` });
        without.messages.expect(/No available adapters|WebGPU/);
        await without.state("unsupported");
        const text = await without.page.locator("#unsupported").innerText();
        assert.match(text, /Firefox 141/);
        console.log(text.split("\n").slice(0, 6).join(" | "));
        await without.check();
    } finally {
        await plain.end();
    }
});

/** Loses the device, and waits for the picture on a new one.
 * @param {() => Promise<unknown>} lose */
async function survives(lose) {
    const before = await app.pixels();
    await lose();
    await app.note("was lost");
    await app.page.locator("#live", { hasText: "is restored" }).waitFor({ state: "attached" });
    await app.complete();
    assert.equal(different(before, await app.pixels()), 0);
    assert.equal(await app.call("isLost"), false);
    await app.page.locator("#live").evaluate((live) => (live.textContent = ""));
    await app.check();
}

test("a lost device is replaced as often as needed, and the picture is the same", async (t) => {
    await t.test("a device that is destroyed", () => survives(() => app.worker.evaluate(async () => {
        // @ts-ignore: the page leaves it there
        (await self.renderer.device()).destroy();
    })));
    await t.test("a GPU process that crashes, with a split", async () => {
        // The browser's own message.
        app.messages.expect(/external Instance reference no longer exists/);
        await app.inPanel("View", () => app.page.locator("#compare").selectOption("albedo"));
        await survives(() => session.crashGpu());
    });
});
