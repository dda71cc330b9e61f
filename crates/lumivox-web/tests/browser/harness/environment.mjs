// Environment variables of the tests:
//
// LUMIVOX_PAGE   the built page, from `./lumivox web --no-serve`
// LUMIVOX_SERVE  the program lumivox-serve, which serves the page
// LUMIVOX        the native program, whose pictures are compared with the browser's
// CHROMIUM       the browser [default: the first of chromium, chromium-browser and google-chrome on
//                the PATH]
// LUMIVOX_RELEASE  if set, also tests what only a release needs
//
// A missing variable is an error: a skipped test would look like one that passes.

import { existsSync } from "node:fs";
import { delimiter, join } from "node:path";

/** @param {string} name @param {string} remedy @returns {string} */
function path(name, remedy) {
    const value = process.env[name];
    if (!value) throw new Error(`${name} is not set: ${remedy}`);
    if (!existsSync(value)) throw new Error(`${name} is ${value}, which is not there: ${remedy}`);
    return value;
}

export const pageFolder = () => path("LUMIVOX_PAGE", "./lumivox web --no-serve builds the page into target/page");
export const server = () => path("LUMIVOX_SERVE", "cargo build -p lumivox-serve builds it into target/debug");
export const program = () => path("LUMIVOX", "cargo build -p lumivox-app builds it into target/debug");

export const isRelease = () => Boolean(process.env.LUMIVOX_RELEASE);

export function chromium() {
    if (process.env.CHROMIUM) return path("CHROMIUM", "it must be the program of a Chromium or Chrome");
    const folders = (process.env.PATH ?? "").split(delimiter);
    for (const name of ["chromium", "chromium-browser", "google-chrome"]) {
        for (const folder of folders) if (existsSync(join(folder, name))) return join(folder, name);
    }
    throw new Error("there is no Chromium on the PATH: install one (Debian: apt-get install chromium), or set CHROMIUM");
}
