/** An error with a code, like those of the WebAssembly. */
export function failure(code, message) {
    return Object.assign(new Error(message), { code });
}
