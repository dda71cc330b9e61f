// The module with its WebAssembly in it. The same calls as `lumivox`; `init` needs no address and no bundler's help.

import start from "./inlined/lumivox.js";

export * from "./inlined/lumivox.js";

/** Starts the module. */
export default async function init() {
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return start({ module_or_path: await new Response(unpacked).arrayBuffer() });
}
