// Bundles pages with the package as npm would install it: packed, with only its listed files.

import { execFile } from "node:child_process";
import { cp, mkdir, mkdtemp, readFile, readdir, symlink, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import bundler from "webpack";
import { pageFolder } from "./environment.mjs";

const run = promisify(execFile);
const here = dirname(dirname(fileURLToPath(import.meta.url)));
const installed = join(here, "node_modules");
const example = resolve(here, "../../../lumivox-three/example");

/** A project with the package installed, three.js beside it, and the pages to bundle.
 * @returns {Promise<string>} its folder */
export async function project() {
    const folder = await mkdtemp(join(tmpdir(), "lumivox-bundled-"));
    const { stdout } = await run("npm", ["pack", "--json", "--ignore-scripts", "--pack-destination", folder], { cwd: join(pageFolder(), "lumivox") });
    const [{ filename }] = JSON.parse(stdout);
    await mkdir(join(folder, "node_modules/lumivox"), { recursive: true });
    await run("tar", ["-xzf", join(folder, filename), "-C", join(folder, "node_modules/lumivox"), "--strip-components=1"]);
    for (const name of ["three", "react", "react-dom", "@react-three"]) await symlink(join(installed, name), join(folder, "node_modules", name), "junction");
    await cp(join(here, "bundled"), folder, { recursive: true });
    await cp(example, join(folder, "example"), { recursive: true });
    await writeFile(join(folder, "package.json"), JSON.stringify({ private: true, type: "module" }));
    return folder;
}

/** Bundles a page with Vite, without settings.
 * @param {string} root @returns {Promise<string>} the folder of the bundle */
export async function vite(root) {
    const out = join(root, "dist");
    await run(process.execPath, [join(installed, "vite/bin/vite.js"), "build", root, "--base", "./", "--outDir", out, "--logLevel", "warn"], { cwd: root });
    return out;
}

/** Bundles a module with webpack, without settings, and puts it into a page.
 * @param {string} root @param {string} entry
 * @param {"production" | "development"} [mode] production minifies; three.js takes 15 s
 * @returns {Promise<string>} the folder of the bundle */
export async function webpack(root, entry, mode = "production") {
    const out = join(root, "webpack", entry);
    /** @type {import("webpack").Stats | undefined} */
    const stats = await new Promise((resolve, reject) => {
        bundler({ mode, context: root, entry: join(root, entry), output: { path: out } }, (error, stats) => (error ? reject(error) : resolve(stats)));
    });
    // Warnings are ignored: advice on sizes does not apply to WebAssembly.
    const { errors = [] } = stats?.toJson({ all: false, errors: true }) ?? {};
    if (errors.length > 0) throw new Error(errors.map((error) => error.message).join("\n"));
    await writeFile(join(out, "index.html"), '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><canvas width="64" height="36"></canvas><p></p><script type="module" src="main.js"></script>');
    return out;
}

/** The files of a folder, to be served beside the page. @param {string} folder @param {string} name
 * @returns {Promise<{ name: string, bytes: Buffer }[]>} */
export async function filesOf(folder, name) {
    const entries = await readdir(folder, { recursive: true, withFileTypes: true });
    const files = entries.filter((entry) => entry.isFile()).map((entry) => join(entry.parentPath, entry.name));
    return Promise.all(files.map(async (file) => ({ name: `${name}/${file.slice(folder.length + 1)}`, bytes: await readFile(file) })));
}
