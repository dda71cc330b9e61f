// The package's example, from the entry whose WebAssembly is inlined.
import init, { createRenderer } from "lumivox/inlined";

const say = (text) => (document.querySelector("p").textContent = text);
try {
    await init();
    const renderer = await createRenderer(document.querySelector("canvas"));
    await renderer.set({ resolution: 32, frames: 2 });
    const scene = await renderer.loadScene("builtin:cornell");
    while (!(await renderer.render()).complete) await new Promise(requestAnimationFrame);
    say(`${scene.name}: ${scene.triangles} triangles`);
} catch (error) {
    say(`failed: ${error.message}`);
}
