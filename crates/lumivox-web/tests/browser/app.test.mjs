// The viewer, in one tab. Each subject begins with a scene of its own, in this order.

// Opens the viewer.
import "./app/gallery.mjs";
// Measures memory before other tests have grown it.
import "./app/memory.mjs";
import "./app/page.mjs";
import "./app/editing.mjs";
import "./app/console.mjs";
import "./app/animation.mjs";
// Opens links, which reset settings.
import "./app/links.mjs";
import "./app/panorama.mjs";
// These expect messages on the console, which are then ignored in later tests.
import "./app/files.mjs";
import "./app/calls.mjs";
// Loses the device.
import "./app/device.mjs";
