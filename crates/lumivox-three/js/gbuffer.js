// The G-buffer: depth, normals, specular reflectance and motion, drawn by three.js for our cones
// (`src/gbuffer.wgsl`).

import { DepthTexture, FloatType, HalfFloatType, Lighting, LightsNode, NearestFilter, RenderTarget, RendererUtils, VelocityNode } from "three/webgpu";
import {
    Fn, abs, cameraViewMatrix, clearcoat, clearcoatRoughness, context, mrt, normalFlat, normalWorld, roughness, select, specularColorBlended,
    vec2, vec4, velocity,
} from "three/tsl";

const NAMES = ["output", "specular", "motion"];
/** Bytes per pixel: three textures of half floats, and depth. */
const PIXEL = 3 * 8 + 4;

/** Unit vectors as two numbers: Meyer et al. 2010, "On floating-point normal vectors". */
const octahedral = /*@__PURE__*/ Fn(([normal]) => {
    const flat = normal.xy.div(abs(normal.x).add(abs(normal.y)).add(abs(normal.z))).toConst();
    const side = (number) => select(number.greaterThanEqual(0), 1, -1);
    const folded = abs(flat.yx).oneMinus().mul(vec2(side(flat.x), side(flat.y)));
    return select(normal.z.greaterThanEqual(0), flat, folded);
});

const neutral = /*@__PURE__*/ context();

/** No lights: the G-buffer needs neither colours nor shadows. */
class NoLights extends LightsNode {
    static get type() {
        return "LumivoxNoLights";
    }

    setLights() {
        return this;
    }
}

/**
  * The motion of surfaces. three.js's node replaces an object's previous matrix once the object is
  * drawn. The G-buffer is drawn before the page's pass, so with that node the page would get no
  * motion.
 */
class Motion extends VelocityNode {
    static get type() {
        return "LumivoxMotion";
    }

    #before = new WeakMap();

    update(frame) {
        this.projectionMatrix = velocity.projectionMatrix;
        super.update(frame);
        this.previousModelWorldMatrix.value.copy(this.#before.get(frame.object) ?? frame.object.matrixWorld);
    }

    updateAfter({ object }) {
        const before = this.#before.get(object);
        if (before === undefined) this.#before.set(object, object.matrixWorld.clone());
        else before.copy(object.matrixWorld);
    }
}

class Darkness extends Lighting {
    createNode() {
        return new NoLights();
    }
}

export class GBuffer {
    #target = null;
    #rendererState;
    #sceneState;
    #darkness = new Darkness();
    #mrt = mrt({
        output: vec4(octahedral(normalWorld), octahedral(normalFlat.transformDirection(cameraViewMatrix.transpose()))),
        specular: vec4(specularColorBlended, roughness),
        motion: vec4(new Motion(), clearcoat, clearcoatRoughness),
    });

    get memory() {
        return this.#target === null ? 0 : this.#target.width * this.#target.height * PIXEL;
    }

    /** Makes the textures of a size; `true` if there are new ones. */
    setSize(renderer, width, height) {
        if (this.#target?.width === width && this.#target.height === height) return false;
        this.dispose();
        const depthTexture = new DepthTexture(width, height, FloatType);
        const target = new RenderTarget(width, height, { count: NAMES.length, type: HalfFloatType, depthTexture, samples: 0 });
        target.textures.forEach((texture, at) => {
            texture.name = NAMES[at];
            texture.minFilter = texture.magFilter = NearestFilter;
            texture.generateMipmaps = false;
        });
        this.#target = target;
        renderer.initRenderTarget(target);
        return true;
    }

    /** The `GPUTexture`s, depth first. */
    textures(renderer) {
        const { depthTexture, textures } = this.#target;
        return [depthTexture, ...textures].map((texture) => renderer.backend.get(texture).texture);
    }

    render(renderer, scene, camera) {
        const { contextNode, lighting, transparent } = renderer;
        this.#rendererState = RendererUtils.resetRendererState(renderer, this.#rendererState);
        this.#sceneState = RendererUtils.resetSceneState(scene, this.#sceneState);
        try {
            // Without this, materials would request our light during this pass. three.js caches
            // render lists by lighting, so the page's list stays.
            renderer.contextNode = neutral;
            renderer.lighting = this.#darkness;
            renderer.setClearColor(0x000000, 0);
            renderer.transparent = false;
            renderer.setRenderTarget(this.#target);
            renderer.setMRT(this.#mrt);
            renderer.render(scene, camera);
        } finally {
            RendererUtils.restoreSceneState(scene, this.#sceneState);
            RendererUtils.restoreRendererState(renderer, this.#rendererState);
            Object.assign(renderer, { contextNode, lighting, transparent });
        }
    }

    dispose() {
        this.#target?.depthTexture.dispose();
        this.#target?.dispose();
        this.#target = null;
    }
}
