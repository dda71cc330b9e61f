// Editable code: each run gets a new document, so that nothing remains of the run before.

const EXAMPLE = `import init, { createRenderer } from "lumivox";

const canvas = document.querySelector("canvas");
const say = (text) => (document.querySelector("p").textContent = text);

await init();
const renderer = await createRenderer(canvas);
await renderer.set({ resolution: 64, frames: 32 });
const scene = await renderer.loadScene("builtin:cornell", ({ stage, done, total }) =>
  say(\`\${stage} \${done} of \${total}\`),
);

// Change anything: "builtin:atrium", { view: "voxels" }, await renderer.run("lights 0 intensity 500") ...
while (!(await renderer.render()).complete) await new Promise(requestAnimationFrame);
say(\`\${scene.name}: \${scene.triangles} triangles\`);
`;

const code = /** @type {HTMLTextAreaElement} */ (document.querySelector("textarea"));
const frame = /** @type {HTMLIFrameElement} */ (document.querySelector("iframe"));
const errors = /** @type {HTMLElement} */ (document.querySelector("[role=alert]"));

/** The document that runs a text; it posts errors to this page. @param {string} text */
function pageOf(text) {
    const imports = JSON.stringify({ imports: { lumivox: new URL("lumivox/lumivox.js", location.href).href } });
    // Only `</script` could end the script early.
    const safe = text.replaceAll("</script", "<\\/script");
    return `<!doctype html><meta charset="utf-8">
<style>body { margin: 0.75rem; color: #e8e8ea; font: 15px system-ui; } canvas { max-width: 100%; }</style>
<canvas width="640" height="360"></canvas><p></p>
<script>
const tell = (message) => parent.postMessage({ lumivox: String(message) }, "*");
addEventListener("error", (event) => tell(event.message));
addEventListener("unhandledrejection", (event) => tell(event.reason?.message ?? event.reason));
</script>
<script type="importmap">${imports}</script>
<script type="module">
${safe}
</script>`;
}

function run() {
    errors.textContent = "";
    // Keep changed code in the address, for reloads.
    history.replaceState(null, "", code.value === EXAMPLE ? location.pathname : `#${encodeURIComponent(code.value)}`);
    frame.srcdoc = pageOf(code.value);
}

addEventListener("message", ({ data, source }) => {
    if (source === frame.contentWindow && typeof data?.lumivox === "string") errors.textContent = data.lumivox;
});
document.querySelector("#run")?.addEventListener("click", run);
code.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && event.ctrlKey) run();
});

let given = "";
try {
    given = decodeURIComponent(location.hash.slice(1));
} catch {
    errors.textContent = "The code in this address cannot be read; this is the example.";
}
code.value = given || EXAMPLE;
// Code from a link runs only when the user asks for it.
if (!given) run();

// Makes this file a module.
export {};
