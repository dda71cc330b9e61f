// Scene files that tests drop and break.

import { readFile } from "node:fs/promises";
import { freshPath, native } from "./picture.mjs";

/** A built-in scene as a GLB file. @param {string} name @returns {Promise<Buffer>} */
export async function glb(name) {
    const file = await freshPath(`${name}.glb`);
    await native("convert", `builtin:${name}`, "-o", file);
    return readFile(file);
}

/** A GLB file as a .gltf and the .bin that it names (Khronos, glTF 2.0, section 4).
 * @param {Buffer} glb @param {string} name @param {string} [bin] the .bin's name in the .gltf */
export function separate(glb, name, bin = name) {
    const length = glb.readUInt32LE(12);
    const json = JSON.parse(glb.toString("utf8", 20, 20 + length));
    json.buffers[0].uri = `${bin}.bin`;
    const gltf = Buffer.from(JSON.stringify(json));
    return [
        { name: `${name}.gltf`, bytes: gltf },
        { name: `${name}.bin`, bytes: glb.subarray(20 + length + 8) },
    ];
}

/** A red floor and a white wall that shines. */
export const OBJ = [
    {
        name: "corner.obj",
        bytes: `mtllib corner.mtl
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -1 2 -1
v 1 2 -1
usemtl floor
f 1 4 3 2
usemtl lamp
f 1 2 6 5
`,
    },
    { name: "corner.mtl", bytes: "newmtl floor\nKd 0.8 0.1 0.1\nnewmtl lamp\nKd 0.8 0.8 0.8\nKe 5 5 5\n" },
];
