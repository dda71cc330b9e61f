// Compares Lumivox with three.js's VXGINode, in one run on the same software GPU, and both with the
// path tracer. scripts/figures.sh runs it for docs/three.md; by hand:
//
//   node compare.by_hand.mjs [RESOLUTION [WIDTHxHEIGHT [SAMPLES]]]
//
// with the variables of harness/environment.mjs. It prints a table, and keeps the pictures in
// LUMIVOX_PICTURES, if set.

import { writeFile } from "node:fs/promises";
import { join } from "node:path";
import { Session } from "./harness/browser.mjs";
import { filesOf, project, vite } from "./harness/bundles.mjs";
import { freshPath, native } from "./harness/picture.mjs";

const [resolution = "64", size = "128x72", samples = "256"] = process.argv.slice(2);
const [width, height] = size.split("x").map(Number);

/** A Radiance picture of linear light. @param {Float32Array} texels four numbers each */
function radiance(texels) {
    const bytes = Buffer.alloc(4 * width * height);
    for (let at = 0; at < width * height; at += 1) {
        const rgb = [0, 1, 2].map((channel) => Math.max(0, texels[4 * at + channel]));
        const exponent = Math.ceil(Math.log2(Math.max(...rgb, 1e-30) * (256 / 255.5)));
        rgb.forEach((value, channel) => (bytes[4 * at + channel] = Math.min(255, Math.floor((value * 256) / 2 ** exponent))));
        bytes[4 * at + 3] = exponent + 128;
    }
    return Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`), bytes]);
}

const folder = await project();
const session = await Session.start();
try {
    await session.serve(await filesOf(await vite(join(folder, "compare")), "compare"));
    const page = await (await session.browser.newContext()).newPage();
    page.setDefaultTimeout(0);
    await page.goto(new URL("compare/index.html", session.address).href);
    await page.waitForSelector("html[data-state=ready]", { state: "attached" });
    /** @param {string} call @param {unknown[]} args @returns {Promise<any>} */
    const inPage = (call, ...args) =>
        // @ts-ignore: the page leaves it there
        page.evaluate(([call, args]) => globalThis.compare[call](...args), /** @type {const} */ ([call, args]));
    const { glb, camera } = await inPage("exported", width, height);
    const [scene, reference] = [await freshPath("hall.glb"), await freshPath("reference.exr")];
    await writeFile(scene, Buffer.from(glb, "base64"));
    await native("reference", scene, "-o", reference, "--size", size, "--camera", camera, "--samples", samples, "--surroundings", "none");
    console.log("| | bias | 95 % of pixels within | FLIP | MiB | at rest, ms | lamp moves, ms | objects move, ms |\n| --- | --: | --: | --: | --: | --: | --: | --: |");
    // @ts-ignore
    for (const method of await page.evaluate(() => globalThis.compare.methods)) {
        const { still, lamp, moving, memory, picture } = await inPage("measured", method, Number(resolution), width, height);
        const bytes = Buffer.from(picture, "base64");
        const file = await freshPath("picture.hdr");
        await writeFile(file, radiance(new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4)));
        const { final } = JSON.parse(await native("compare", "--json", "--images", reference, file));
        const errors = [`${final.bias_percent.toFixed(1)} %`, `${final.p95_percent.toFixed(0)} %`, final.flip.toFixed(3)];
        const costs = [memory / 2 ** 20, still, lamp, moving].map((cost) => cost.toFixed(0));
        console.log(`| ${[method, ...errors, ...costs].join(" | ")} |`);
    }
} finally {
    await session.end();
}
