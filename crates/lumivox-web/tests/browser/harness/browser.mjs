// A browser with WebGPU on a software GPU, and the page on a server.

import { spawn } from "node:child_process";
import { cp, mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { chromium } from "playwright-core";
import * as environment from "./environment.mjs";

/** Chromium has WebGPU only on trusted GPUs; SwiftShader, its software GPU, must be named. */
const WEBGPU = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--ignore-gpu-blocklist"];

/** @param {string[]} gpu */
function launch(gpu) {
    return chromium.launch({
        executablePath: environment.chromium(),
        // The new headless mode is the whole browser; Playwright's own one has no GPU process.
        headless: false,
        // Containers do not permit Chromium's sandbox.
        args: ["--headless=new", "--no-sandbox", "--use-angle=gl-egl", "--js-flags=--expose-gc", ...gpu],
    });
}

/** Serves a folder; returns its address and a function that ends it.
 * @param {string} folder @returns {Promise<{ address: string, end: () => void }>} */
export async function serve(folder) {
    const server = spawn(environment.server(), [folder, "--port", "0"], { stdio: ["ignore", "pipe", "inherit"] });
    for await (const line of createInterface(server.stdout)) {
        return { address: new URL(line.trim()).href, end: () => void server.kill() };
    }
    throw new Error(`${environment.server()} ended before it told its address`);
}

/** A browser and the page's address. */
export class Session {
    /** @param {import("playwright-core").Browser} browser
     * @param {{ address: string, end: () => void }} server @param {string} folder */
    constructor(browser, server, folder) {
        this.browser = browser;
        this.server = server;
        this.folder = folder;
    }

    /** @param {{ webgpu?: boolean }} options whether the browser has WebGPU */
    static async start({ webgpu = true } = {}) {
        const folder = await mkdtemp(join(tmpdir(), "lumivox-page-"));
        await cp(environment.pageFolder(), folder, { recursive: true });
        const server = await serve(folder);
        try {
            return new Session(await launch(webgpu ? WEBGPU : []), server, folder);
        } catch (error) {
            server.end();
            throw error;
        }
    }

    /** Serves files beside the page. @param {{ name: string, bytes: Buffer | string }[]} files */
    async serve(files) {
        for (const { name, bytes } of files) {
            await mkdir(dirname(join(this.folder, name)), { recursive: true });
            await writeFile(join(this.folder, name), bytes);
        }
    }

    get address() {
        return this.server.address;
    }

    async end() {
        await this.browser.close();
        this.server.end();
        await rm(this.folder, { recursive: true });
    }

    /** Ends the browser's GPU process, as a driver's crash would. */
    async crashGpu() {
        const devtools = await this.browser.newBrowserCDPSession();
        await devtools.send("Browser.crashGpuProcess");
        await devtools.detach();
    }

    /** Private memory of the browser's processes of a kind, bytes.
     * @param {"GPU" | "renderer"} type */
    async memory(type) {
        const devtools = await this.browser.newBrowserCDPSession();
        const { processInfo } = await devtools.send("SystemInfo.getProcessInfo");
        await devtools.detach();
        let bytes = 0;
        for (const process of processInfo.filter((process) => process.type === type)) {
            const status = await readFile(`/proc/${process.id}/status`, "utf8");
            const kibibytes = /^RssAnon:\s+(\d+) kB$/m.exec(status);
            if (kibibytes) bytes += Number(kibibytes[1]) * 1024;
        }
        return bytes;
    }
}
