// TypeScript: the package's declarations fit its uses, and the page's own modules are sound.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readdir, rm, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { pageFolder } from "./harness/environment.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const compiler = createRequire(import.meta.url).resolve("typescript/bin/tsc");

/** Compiles; returns the compiler's errors.
 * @param {Record<string, unknown>} options @param {string[]} files */
async function compile(options, files) {
    const folder = await mkdtemp(join(tmpdir(), "lumivox-types-"));
    const project = join(folder, "tsconfig.json");
    const strict = {
        strict: true, noEmit: true, target: "es2022", module: "esnext", moduleResolution: "bundler",
        typeRoots: [join(here, "node_modules/@types")],
    };
    await writeFile(project, JSON.stringify({ compilerOptions: { ...strict, ...options }, files }));
    const complaints = await new Promise((done) => execFile(process.execPath, [compiler, "-p", project], (error, stdout) => done(error ? stdout || error.message : "")));
    await rm(folder, { recursive: true });
    return complaints;
}

const webgpu = join(here, "node_modules/@webgpu/types");
const page = () => resolve(pageFolder());

test("right uses of the package compile, and wrong ones do not", async () => {
    const paths = { lumivox: [join(page(), "lumivox/lumivox.d.ts")] };
    const options = { lib: ["esnext", "dom", "dom.iterable"], types: [webgpu], paths };
    assert.equal(await compile(options, [join(here, "types/uses.ts")]), "");
});

test("right uses of lumivox/three compile, and wrong ones do not", async () => {
    const three = (/** @type {string} */ name) => join(here, "node_modules/@types/three/build", name);
    const paths = { "lumivox/three": [join(page(), "lumivox/three/index.d.ts")], "lumivox/react": [join(page(), "lumivox/three/react.d.ts")], react: [join(here, "node_modules/@types/react/index.d.ts")], "three/webgpu": [three("three.webgpu.d.ts")], "three/tsl": [three("three.tsl.d.ts")] };
    const options = { lib: ["esnext", "dom", "dom.iterable"], types: [webgpu], paths, skipLibCheck: true };
    assert.equal(await compile(options, [join(here, "types/three.ts")]), "");
});

test("the page's modules compile", async () => {
    const modules = (await readdir(page())).filter((name) => name.endsWith(".js")).map((name) => join(page(), name));
    assert.ok(modules.length > 10);
    const options = { lib: ["esnext", "dom", "dom.iterable"], types: [webgpu], allowJs: true, checkJs: true };
    assert.equal(await compile(options, modules), "");
});

test("these tests compile", async () => {
    const modules = ["", "app", "harness"].map((name) => join(here, name)).map(async (folder) =>
        (await readdir(folder)).filter((name) => name.endsWith(".mjs")).map((name) => join(folder, name)));
    const options = { lib: ["esnext", "dom", "dom.iterable"], types: [webgpu, "node"], allowJs: true, checkJs: true };
    assert.equal(await compile(options, (await Promise.all(modules)).flat()), "");
});
