import type { InitOutput } from "./inlined/lumivox.js";

export * from "./inlined/lumivox.js";

/** Starts the module, whose WebAssembly is in it: no address, and no settings of a bundler. */
export default function init(): Promise<InitOutput>;
