// The page's console: the program's own commands and help, applied to the page.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { before, beforeEach, describe, test } from "node:test";
import { promisify } from "node:util";
import { program } from "../harness/environment.mjs";
import { different } from "../harness/picture.mjs";
import { app, session } from "../harness/viewer.mjs";

/** @type {import("playwright-core").Locator} */
let line;

/** Enters a line; returns what is printed. @param {string} text */
async function enter(text) {
    const log = app.page.locator("#console-log");
    const count = await log.locator("p").count();
    await line.fill(text);
    await line.press("Enter");
    await app.page.locator("#loading").waitFor({ state: "hidden" });
    await app.settled();
    const lines = await log.locator("p").allTextContents();
    return lines.slice(count + 1).join("\n");
}

describe("the console", () => {
    before(async () => {
        await session.serve([{ name: "evening.txt", bytes: "echo dusk; add_light point lamp intensity 5\nwait 2\nlight lamp\n" }]);
        await app.page.locator("#canvas").focus();
        await app.page.keyboard.press("c");
        line = app.page.locator("#console-line");
        await line.waitFor();
    });
    // Each test begins as in a new tab, without compiling for one.
    beforeEach(async () => void (await enter("load builtin:cornell; view final; lod 0; resolution 32")));

    test("the commands and their help are the program's", async () => {
        const { stdout } = await promisify(execFile)(program(), ["commands"], { maxBuffer: 1 << 22 });
        assert.equal(await enter("commands"), stdout.trimEnd());
        assert.match(await enter("help translate"), /^translate .*\n.*In VXCT:/s);
    });

    test("console lines change the picture and the panel", async () => {
        const plain = await app.pixels();
        assert.equal(await enter("light lamp color 1 0 0"), "");
        const red = await app.pixels();
        assert.ok(different(plain, red) > 1000);
        const panel = await app.page.locator("#lights input[type=color]").first().inputValue();
        assert.equal(panel, "#ff0000");
        assert.equal(await enter("undo"), 'undone: light "lamp"');
        assert.equal(different(plain, await app.pixels()), 0);
        // VXCT's own syntax, and both names of a setting.
        await enter(`translate 'short block' y 0.1; lod 2`);
        assert.equal((await app.call("settings")).level, 2);
        await enter("camera 0; view albedo");
        assert.equal((await app.call("settings")).view, "albedo");
        assert.equal(await app.page.locator("input[name=view]:checked").inputValue(), "albedo");
        const voxels = (await app.call("scene")).voxels;
        await enter("resolution 16");
        assert.ok((await app.call("scene")).voxels < voxels);
    });

    test("console commands load scenes, run scripts, save files", async () => {
        await enter("load builtin:panel --surroundings none; resolution 32");
        assert.equal(await app.page.locator("#title").textContent(), "panel");
        assert.equal(await enter("load"), "load builtin:panel --surroundings none");
        assert.match(await enter("run evening.txt"), /^dusk\n.*strength 5/s);
        const download = app.page.waitForEvent("download");
        assert.match(await enter("screenshot view.png"), /^view\.png: 96x72, 2 frames$/);
        assert.equal((await download).suggestedFilename(), "view.png");
        assert.match(await enter("script"), /^size 96x72\n.*load builtin:panel/s);
    });

    test("the console shows errors and runs preceding commands", async () => {
        assert.equal(await enter("echo one; lodd 1; echo two"), 'one\nthere is no command "lodd"; did you mean "lod"?');
        assert.match(await enter("load nowhere"), /there is no scene "nowhere"/);
        assert.match(await enter("resolution 17"), /resolution is .* got "17"/);
        assert.match(await enter("quit"), /closing its tab/);
        // The error of a script names the line that failed.
        const { message } = await app.call("run", "echo one\nlod 99").catch((error) => error);
        assert.match(message, /^script:2: level is a whole number/);
        // Tab completes a word; arrow keys recall lines.
        await line.fill("reso");
        await line.press("Tab");
        await app.page.waitForFunction(() => /** @type {HTMLInputElement} */ (document.getElementById("console-line")).value === "resolution ");
        await line.press("ArrowUp");
        assert.equal(await line.inputValue(), "quit");
        await line.press("Escape");
        assert.ok(await app.page.locator("#console").isHidden());
    });
});
