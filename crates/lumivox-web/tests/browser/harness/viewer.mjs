// The viewer in one tab, for all subjects in app/: a new tab would compile all shaders again.

import { after, afterEach } from "node:test";
import { App } from "./app.mjs";
import { Session } from "./browser.mjs";

export const session = await Session.start();
after(() => session.end());

/** The gallery at first; its test opens the viewer. */
export const app = await App.open(session, {
    path: "gallery.html",
    // A phone as wide as a small window, for tests of fingers and of layout.
    context: { acceptDownloads: true, hasTouch: true, isMobile: true, permissions: ["clipboard-read", "clipboard-write"] },
});
afterEach(() => app.check());
