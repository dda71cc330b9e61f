// @ts-check
// Dropped files on their way from one page to another: a database of the browser has them until the
// viewer takes them. They never leave the machine.

/** @typedef {import("./types.js").SourceFile} SourceFile */

const [DATABASE, STORE] = ["lumivox", "dropped"];
/** The part of the viewer's address that makes it take them. */
export const DROPPED = "?dropped";

/** @template T @param {IDBRequest<T>} request @returns {Promise<T>} */
const done = (request) => new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
});

/** Runs a request on the store.
 * @template T @param {(store: IDBObjectStore) => IDBRequest<T>} ask @returns {Promise<T>} */
async function within(ask) {
    const opening = indexedDB.open(DATABASE, 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore(STORE);
    const database = await done(opening);
    try {
        const transaction = database.transaction(STORE, "readwrite");
        const result = done(ask(transaction.objectStore(STORE)));
        await new Promise((resolve, reject) => {
            transaction.oncomplete = resolve;
            transaction.onabort = () => reject(transaction.error);
        });
        return await result;
    } finally {
        database.close();
    }
}

/** Keeps files for the viewer. @param {SourceFile[]} files */
export async function keep(files) {
    await within((store) => store.put(files, STORE));
}

/** Takes the kept files; they are not kept longer. @returns {Promise<SourceFile[]>} */
export async function take() {
    /** @type {SourceFile[] | undefined} */
    const files = await within((store) => store.get(STORE));
    await within((store) => store.delete(STORE));
    return files ?? [];
}
