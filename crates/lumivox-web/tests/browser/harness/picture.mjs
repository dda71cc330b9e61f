// Pictures and their differences.

import { execFile } from "node:child_process";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import { deflateSync } from "node:zlib";
import { program } from "./environment.mjs";

/** @typedef {{ width: number, height: number, data: Buffer }} Picture four bytes a pixel, row by
 * row from the top */

const run = promisify(execFile);
/** @type {Promise<string> | undefined} */
let folder;
let count = 0;

/** A path that does not exist yet. @param {string} name */
export async function freshPath(name) {
    folder ??= process.env.LUMIVOX_PICTURES ? Promise.resolve(process.env.LUMIVOX_PICTURES) : mkdtemp(join(tmpdir(), "lumivox-"));
    count += 1;
    return join(await folder, `${process.pid}-${count}-${name}`);
}

/** Runs the native program. @param {string[]} args @returns {Promise<string>} what it prints */
export async function native(...args) {
    const { stdout } = await run(program(), args, { maxBuffer: 1 << 24 });
    return stdout;
}

/** Files of native pictures by scene and options. @type {Map<string, Promise<string>>} */
const natives = new Map();

/** The native picture of a scene, which is rendered once.
 * @param {string} scene @param {string[]} options @returns {Promise<string>} its file */
export function nativePicture(scene, ...options) {
    const key = JSON.stringify([scene, ...options]);
    const render = async () => {
        const file = await freshPath("native.png");
        await native("render", scene, "-o", file, ...options);
        return file;
    };
    if (!natives.has(key)) natives.set(key, render());
    return /** @type {Promise<string>} */ (natives.get(key));
}

/** Mean FLIP of a picture against a file, from 0 (the same) to 1.
 * @param {string} reference @param {Picture} picture @param {string} [name] */
export async function flip(reference, picture, name = "browser.png") {
    const file = await freshPath(name);
    await writeFile(file, png(picture));
    return flipOfFiles(reference, file);
}

/** @param {string} reference @param {string} ours @returns {Promise<number>} */
export async function flipOfFiles(reference, ours) {
    return JSON.parse(await native("compare", "--json", "--images", reference, ours)).final.flip;
}

/** The number of pixels that differ. @param {Picture} a @param {Picture} b */
export function different(a, b) {
    if (a.width !== b.width || a.height !== b.height) return Infinity;
    let pixels = 0;
    for (let at = 0; at < a.data.length; at += 4) if (a.data.readUInt32LE(at) !== b.data.readUInt32LE(at)) pixels += 1;
    return pixels;
}

/** The number of colours: 1 if nothing is shown. @param {Picture} picture */
export function colors({ data }) {
    const seen = new Set();
    for (let at = 0; at < data.length; at += 4) seen.add(data.readUInt32LE(at));
    return seen.size;
}

/** Columns of a picture.
 * @param {Picture} picture @param {number} from @param {number} to @returns {Picture} */
export function columns({ width, height, data }, from, to) {
    const rows = Array.from({ length: height }, (_, y) => data.subarray(4 * (y * width + from), 4 * (y * width + to)));
    return { width: to - from, height, data: Buffer.concat(rows) };
}

const CRC = Uint32Array.from({ length: 256 }, (_, byte) => {
    for (let bit = 0; bit < 8; bit += 1) byte = byte & 1 ? 0xedb88320 ^ (byte >>> 1) : byte >>> 1;
    return byte;
});

/** A PNG file of 8 bits a channel (ISO/IEC 15948). @param {Picture} picture */
export function png({ width, height, data }) {
    const header = Buffer.alloc(13);
    header.writeUInt32BE(width, 0);
    header.writeUInt32BE(height, 4);
    header.set([8, 6], 8);
    // Every row begins with the number of its filter: none.
    const rows = Array.from({ length: height }, (_, y) => [Buffer.of(0), data.subarray(4 * width * y, 4 * width * (y + 1))]);
    const chunk = (/** @type {string} */ type, /** @type {Buffer} */ body) => {
        const checked = Buffer.concat([Buffer.from(type, "latin1"), body]);
        const framed = Buffer.alloc(checked.length + 8);
        framed.writeUInt32BE(body.length, 0);
        framed.set(checked, 4);
        const crc = checked.reduce((sum, byte) => CRC[(sum ^ byte) & 255] ^ (sum >>> 8), 0xffffffff);
        framed.writeUInt32BE((crc ^ 0xffffffff) >>> 0, framed.length - 4);
        return framed;
    };
    const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
    const pixels = deflateSync(Buffer.concat(rows.flat()));
    return Buffer.concat([signature, chunk("IHDR", header), chunk("IDAT", pixels), chunk("IEND", Buffer.alloc(0))]);
}
