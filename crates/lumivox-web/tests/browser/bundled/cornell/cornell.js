/** The package's example, with the module that it is given. @param {typeof import("lumivox")} lumivox */
export async function show({ default: init, createRenderer }) {
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
}
