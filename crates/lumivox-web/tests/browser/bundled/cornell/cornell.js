/** Runs the package's example with a module; if the address ends with #init, counts its scenes.
 * @param {typeof import("lumivox")} lumivox */
export async function show({ default: init, builtinScenes, createRenderer }) {
    const say = (text) => (document.querySelector("p").textContent = text);
    try {
        await init();
        if (location.hash === "#init") return say(`${builtinScenes().length} scenes`);
        const renderer = await createRenderer(document.querySelector("canvas"));
        await renderer.set({ resolution: 32, frames: 2 });
        const scene = await renderer.loadScene("builtin:cornell");
        while (!(await renderer.render()).complete) await new Promise(requestAnimationFrame);
        say(`${scene.name}: ${scene.triangles} triangles`);
    } catch (error) {
        say(`failed: ${error.message}`);
    }
}
