// `lumivox` with its WebAssembly inlined: the same API, but `init` needs no address and no support
// from a bundler.

import start from "./inlined/lumivox.js";

export * from "./inlined/lumivox.js";

/** Starts the module. */
export default async function init() {
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return start({ module_or_path: await new Response(unpacked).arrayBuffer() });
}
