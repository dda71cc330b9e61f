// Browser functions that Rust calls.

/**
 * The bytes at an address; null if the server answers 404.
 * @param {string} address
 * @param {(done: number, total: number) => void} tell gets bytes so far and in all (0: unknown)
 * @param {AbortSignal | undefined} signal cancels the request
 * @returns {Promise<Uint8Array | null>}
 */
export async function fetchBytes(address, tell, signal) {
  const response = await fetch(address, { signal });
  if (response.status === 404) return null;
  if (!response.ok) throw new Error(`the server answers ${response.status} ${response.statusText}`);
  const encoded = response.headers.get("content-encoding");
  const total = encoded ? 0 : Number(response.headers.get("content-length") ?? 0);
  if (!response.body) return new Uint8Array(await response.arrayBuffer());
  const pieces = [];
  let done = 0;
  const reader = response.body.getReader();
  for (;;) {
    const { done: isOver, value } = await reader.read();
    if (isOver) break;
    pieces.push(value);
    done += value.length;
    tell(done, total);
  }
  const bytes = new Uint8Array(done);
  let at = 0;
  for (const piece of pieces) {
    bytes.set(piece, at);
    at += piece.length;
  }
  return bytes;
}

/**
 * The bytes of a file.
 * @param {Blob} file
 * @returns {Promise<Uint8Array>}
 */
export async function readBytes(file) {
  return new Uint8Array(await file.arrayBuffer());
}

/** True if WebGPU is available. Browsers offer it only over https and on localhost. */
export function hasWebGpu() {
  return globalThis.navigator?.gpu != null;
}

/** True if `signal` is an AbortSignal. @param {unknown} signal */
export function isSignal(signal) {
  return signal instanceof AbortSignal;
}

/** True if `signal` has been aborted. @param {AbortSignal | undefined} signal */
export function isAborted(signal) {
  return signal?.aborted === true;
}

/** Yields to the browser. */
export function breathe() {
  return new Promise((resolve) => setTimeout(resolve, 0));
}

/** A file in memory.
 * @param {string} path @param {Uint8Array} bytes a view of WASM's memory */
export function fileOf(path, bytes) {
  return new File([bytes.slice()], path.split("/").pop() ?? path);
}
