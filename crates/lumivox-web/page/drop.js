// @ts-check
// Dropped or chosen files and their paths. Folders are searched, so a .gltf finds its buffers.

import { byId } from "./dom.js";

/** @typedef {import("./types.js").SourceFile} SourceFile */

/** The most files of a dropped folder: a scene has fewer. */
const MOST_FILES = 5000;

/** Listens for files on the whole page and from the file dialog.
 * @param {(files: SourceFile[]) => void} open @param {(text: string) => void} refuse */
export function listenForFiles(open, refuse) {
    const hint = byId("drop");
    let depth = 0;
    /** Resolves when all earlier drops have been read: drops open in their order. */
    let earlier = Promise.resolve();
    const hasFiles = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes("Files") ?? false;
    const show = (/** @type {number} */ by) => {
        depth = Math.max(0, depth + by);
        hint.hidden = depth === 0;
    };
    addEventListener("dragenter", (event) => hasFiles(event) && show(1));
    addEventListener("dragleave", (event) => hasFiles(event) && show(-1));
    addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault());
    addEventListener("drop", async (event) => {
        if (!event.dataTransfer || !hasFiles(event)) return;
        event.preventDefault();
        show(-Infinity);
        const files = dropped(event.dataTransfer);
        earlier = earlier.then(async () => {
            try {
                offer(await files);
            } catch (error) {
                refuse(error instanceof Error ? error.message : String(error));
            }
        });
        await earlier;
    });
    const input = byId("files", HTMLInputElement);
    input.addEventListener("change", () => {
        offer([...(input.files ?? [])].map((file) => ({ file, path: file.webkitRelativePath || file.name })));
        // Allow choosing the same file again.
        input.value = "";
    });
    /** @param {SourceFile[]} files */
    const offer = (files) => {
        if (files.length > 0) open(files);
        else refuse("There is no file in what was dropped: drop a .glb, a .gltf with its files, an .obj with its .mtl, or an .hdr or .exr panorama");
    };
}

/** All files of a drop. Request them synchronously: later they are gone.
 * @param {DataTransfer} transfer @returns {Promise<SourceFile[]>} */
async function dropped(transfer) {
    const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.() ?? null);
    const plain = [...transfer.files].map((file) => ({ file, path: file.name }));
    if (entries.every((entry) => entry === null)) return plain;
    /** @type {SourceFile[]} */
    const found = [];
    for (const entry of entries) if (entry) await search(entry, found);
    return found;
}

/** @param {FileSystemEntry} entry @param {SourceFile[]} found */
async function search(entry, found) {
    if (found.length > MOST_FILES) {
        throw new Error(`The folder has more than ${MOST_FILES} files: drop the one that holds only the scene`);
    }
    if (isFile(entry)) {
        const file = await new Promise((/** @type {(file: File) => void} */ resolve, reject) => entry.file(resolve, reject));
        found.push({ file, path: entry.fullPath.replace(/^\//, "") });
    } else if (isFolder(entry)) {
        const reader = entry.createReader();
        // A reader returns entries in batches; an empty batch is the end.
        for (;;) {
            const part = await new Promise((/** @type {(part: FileSystemEntry[]) => void} */ resolve, reject) => reader.readEntries(resolve, reject));
            if (part.length === 0) break;
            for (const child of part) await search(child, found);
        }
    }
}

/** @param {FileSystemEntry} entry @returns {entry is FileSystemFileEntry} */
const isFile = (entry) => entry.isFile;
/** @param {FileSystemEntry} entry @returns {entry is FileSystemDirectoryEntry} */
const isFolder = (entry) => entry.isDirectory;
