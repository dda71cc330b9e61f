// Pictures of the browser agree with the native program's.
//
// A pair takes seconds on a software GPU. Each kind of light, volume and view is tested once; a
// release tests all.

import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { App, BOUND, NATIVE, QUICK } from "./harness/app.mjs";
import { Session } from "./harness/browser.mjs";
import { isRelease } from "./harness/environment.mjs";
import { panorama } from "./harness/panorama.mjs";
import { colors, different, flip, freshPath, nativePicture } from "./harness/picture.mjs";

/** @type {Session} */
let session;
/** @type {App} */
let app;
const HALL = panorama();
before(async () => {
    session = await Session.start();
    await session.serve([{ name: "hall.hdr", bytes: HALL }]);
    app = await App.show(session, "builtin:cornell");
});
after(() => session?.end());

/** One of the package's lists.
 * @param {"builtinScenes" | "parameters" | "presets"} list @returns {Promise<any[]>} */
const known = (list) => app.worker.evaluate(async (list) => {
    const lumivox = await import(new URL("lumivox/lumivox.js", self.location.href).href);
    return lumivox[list]();
}, list);

const agrees = async (/** @type {string} */ scene, /** @type {string[]} */ options, /** @type {string} */ what) => {
    const difference = await flip(await nativePicture(scene, ...NATIVE, ...options), await app.pixels(), `${what.replace(/\W/g, "-")}.png`);
    console.log(`${what}: FLIP ${difference.toFixed(5)}`);
    assert.ok(difference <= BOUND, `${what}: FLIP ${difference} against the native picture is above ${BOUND}`);
};

// Automatic exposure of emissive surfaces differs by a tenth of a stop between drivers.
const STOPS = new Map([["glow", -5.4], ["cornell-area", -1.65]]);

test("built-in scenes agree with the native picture", async (t) => {
    const names = (await known("builtinScenes")).map(({ name }) => name);
    assert.equal(names.length, 20);
    // A lamp; sun, sky and textures; emissive surfaces; mirrors and rough surfaces.
    const shown = ["cornell", "atrium", "glow", "spheres"];
    // Scenes of a kilometre have millions of triangles and take minutes here; by hand they agree as
    // well (FLIP 0.03 to 0.043).
    for (const name of isRelease() ? names.filter((name) => !/^(city|interior)/.test(name)) : shown) {
        await t.test(name, async () => {
            // The page's link has opened the first.
            if (name !== "cornell") await app.call("loadScene", `builtin:${name}`);
            const exposure = STOPS.get(name) ?? "auto";
            await app.call("set", { exposure });
            await app.render();
            await agrees(`builtin:${name}`, [`--exposure=${exposure}`], name);
            await app.check();
        });
    }
});

test("a panorama and the computed sky agree with the native picture", async (t) => {
    const scene = "builtin:cornell";
    await t.test("sky", async () => {
        await app.call("loadScene", scene, null, { surroundings: "sky" });
        await app.render();
        await agrees(scene, ["--surroundings", "sky"], "sky");
    });
    await t.test("panorama", async () => {
        const file = await freshPath("hall.hdr");
        await writeFile(file, HALL);
        await app.call("loadScene", scene);
        await app.call("loadPanorama", new URL("hall.hdr", session.address).href);
        await app.render();
        await agrees(scene, ["--environment", file], "panorama");
    });
    await app.check();
});

test("all volumes and the presets agree with the native picture", async (t) => {
    await app.call("loadScene", "builtin:cornell");
    const usual = await app.call("settings");
    // The tests of scenes use the dense one.
    for (const volume of ["octree", "cascades"]) {
        await t.test(volume, async () => {
            await app.pictureWith({ volume });
            await agrees("builtin:cornell", ["--volume", volume], volume);
        });
    }
    for (const preset of ["realtime", "vxct", "report"]) {
        await t.test(preset, async () => {
            await app.call("setPreset", preset);
            await app.pictureWith(QUICK);
            await agrees("builtin:cornell", ["--preset", preset], preset);
        });
    }
    await app.call("setPreset", "balanced");
    await app.call("set", usual);
    await app.check();
});

test("every view is a picture of its own, and all volumes have views", async (t) => {
    const views = (await known("parameters")).find(({ name }) => name === "view").choices;
    assert.ok(views.length >= 15, `${views.length} views`);
    const octrees = new Set(["nodes", "bricks"]);
    const pasts = new Set(["history", "disocclusion"]);
    // This scene has reflections.
    await app.call("loadScene", "builtin:spheres");
    /** @type {Map<string, import("./harness/picture.mjs").Picture>} */
    const seen = new Map();
    // Other volumes differ only in look-ups: test light, voxels, and the views that only they have.
    const inOthers = new Set(["final", "voxels", "lit", ...octrees]);
    for (const volume of ["dense", "octree", "cascades"]) {
        // Without a limit everything in a closed room is occluded.
        await app.call("set", { volume, view: "final", occlusion_distance: 0.5 });
        for (const view of views.filter((/** @type {string} */ view) => isRelease() || volume === "dense" || inOthers.has(view))) {
            await t.test(`${view}, ${volume}`, async () => {
                if (octrees.has(view) && volume !== "octree") {
                    await assert.rejects(app.call("set", { view }), /octree/);
                    return;
                }
                if (pasts.has(view)) {
                    await assert.rejects(app.call("set", { view }), /temporal/);
                    return;
                }
                const picture = await app.pictureWith({ view });
                assert.ok(colors(picture) > 1, `${view} shows nothing`);
                for (const [other, earlier] of seen) {
                    if (other.startsWith(volume)) assert.ok(different(picture, earlier) > 0, `${view} looks like ${other}`);
                }
                seen.set(`${volume} ${view}`, picture);
            });
        }
    }
    await app.call("set", { volume: "dense", view: "final", occlusion_distance: "unlimited" });
    await app.check();
});

test("the path-traced reference agrees with the native one", async () => {
    await app.call("loadScene", "builtin:cornell");
    // Beside a view without light it is exposed automatically, like the native one.
    await app.call("set", { view: "albedo" });
    await app.call("setSplit", { right: "reference", at: 0, samples: 8 });
    const report = await app.render();
    assert.equal(report.reference_samples, 8);
    const file = await nativeReference("--samples", "8");
    const difference = await flip(file, await app.pixels(), "reference.png");
    console.log(`reference: FLIP ${difference.toFixed(5)}`);
    assert.ok(difference <= BOUND, `FLIP ${difference} is above ${BOUND}`);
    await app.call("setSplit", null);
    await app.call("set", { view: "final" });
    await app.check();
});

async function nativeReference(/** @type {string[]} */ ...options) {
    const { freshPath, native } = await import("./harness/picture.mjs");
    const file = await freshPath("reference.png");
    await native("reference", "builtin:cornell", "-o", file, "--size", "96x72", ...options);
    return file;
}

test("rendering twice gives equal bits", async () => {
    const first = await app.pictureWith({ resolution: 32 });
    await app.pictureWith({ resolution: 40 });
    const again = await app.pictureWith({ resolution: 32 });
    assert.equal(different(first, again), 0);
    await app.check();
});
