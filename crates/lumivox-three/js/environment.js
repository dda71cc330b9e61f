// The surroundings: three.js draws `scene.environment` as a panorama, which is read back when the
// texture changes.

import { DirectionalLight, FloatType, Group, NearestFilter, NodeMaterial, QuadMesh, RenderTarget, RendererUtils, Sphere } from "three/webgpu";
import { cubeTexture, equirectUV, float, pmremTexture, screenCoordinate, texture, vec3 } from "three/tsl";

/** The panorama's width, texels: default (no size, or gradients below `LEAST`), least, most. */
const [WIDTH, LEAST, LARGEST] = [512, 16, 2048];
/** three.js only reads back rows of a multiple of this many texels. */
const STEP = 16;
/** Numbers per sun: direction, irradiance, angular radius. */
const SUN = 7;

/** Version of a texture's content, including drawings of a `CubeCamera` (`needsPMREMUpdate`). */
const versionOf = (texture) => (texture === null ? 0 : texture.version + texture.pmremVersion);

export class Environment {
    #shared;
    #renderer;
    #scene;
    #bounds;
    #note;
    #known = { texture: null, version: 0 };
    #isReading = false;
    #isDisposed = false;
    /** The suns of the picture, as lights of three.js: they light surfaces directly. */
    #suns = new Group();

    /** Suns cast shadows in `bounds`; null leaves suns out. */
    constructor(shared, renderer, scene, bounds, note) {
        this.#shared = shared;
        this.#renderer = renderer;
        this.#scene = scene;
        this.#bounds = bounds;
        this.#note = note;
        this.#suns.name = "suns of the environment (lumivox)";
        if (bounds !== null) scene.add(this.#suns);
    }

    /** The factor of the picture's radiance (RGB) and its rotation. Also updates the suns. */
    row() {
        const { environmentIntensity, environmentRotation, environment } = this.#scene;
        const factor = environment === null || this.#known.texture !== environment ? 0 : environmentIntensity;
        this.#suns.visible = factor > 0;
        this.#suns.rotation.y = environmentRotation.y;
        for (const sun of this.#suns.children) if (sun.isLight) sun.intensity = sun.userData.intensity * factor;
        if (environmentRotation.x !== 0 || environmentRotation.z !== 0) this.#note("the environment is turned about the y axis alone");
        return Float32Array.of(factor, factor, factor, environmentRotation.y);
    }

    /** Reads the picture in the background if it has changed. */
    watch() {
        if (this.#isReading || this.#isCurrent()) return;
        this.update().catch((error) => this.#note(`the environment could not be read: ${error.message}`));
    }

    #isCurrent() {
        const { environment } = this.#scene;
        return this.#known.texture === environment && this.#known.version === versionOf(environment);
    }

    async update() {
        if (this.#isCurrent()) return;
        const { environment } = this.#scene;
        if (this.#scene.environmentNode) this.#note("scene.environmentNode is not taken; set scene.environment");
        const known = { texture: environment, version: versionOf(environment) };
        this.#isReading = true;
        try {
            const { width, height, rgb } = environment === null ? { width: 0, height: 0, rgb: new Float32Array() } : await this.#read(environment);
            if (this.#isDisposed) return;
            this.#setSuns(this.#shared.setEnvironment(width, height, rgb));
        } finally {
            this.#known = known;
            this.#isReading = false;
        }
    }

    async #read(environment) {
        const renderer = this.#renderer;
        const isCube = environment.isCubeTexture === true;
        const isPacked = environment.isPMREMTexture === true;
        const own = isCube || isPacked ? 0 : (environment.image?.width ?? 0);
        const width = own >= LEAST ? Math.min(STEP * Math.ceil(own / STEP), LARGEST) : WIDTH;
        const height = width / 2;
        const target = new RenderTarget(width, height, { type: FloatType, depthBuffer: false, minFilter: NearestFilter, magFilter: NearestFilter });
        const direction = directionOf(width, height);
        const material = new NodeMaterial();
        material.name = "environment (lumivox)";
        if (isPacked) material.fragmentNode = pmremTexture(environment, direction, float(0));
        else if (isCube) material.fragmentNode = cubeTexture(environment, direction).level(0);
        else material.fragmentNode = texture(environment, equirectUV(direction)).level(0);
        const state = RendererUtils.resetRendererState(renderer);
        const quad = new QuadMesh(material);
        renderer.setRenderTarget(target);
        quad.render(renderer);
        RendererUtils.restoreRendererState(renderer, state);
        const texels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, width, height);
        target.dispose();
        material.dispose();
        const rgb = new Float32Array(3 * width * height);
        for (let at = 0; at < width * height; at += 1) {
            for (let channel = 0; channel < 3; channel += 1) {
                const value = texels[4 * at + channel];
                rgb[3 * at + channel] = Number.isFinite(value) ? Math.max(value, 0) : 0;
            }
        }
        return { width, height, rgb };
    }

    #setSuns(rows) {
        this.#removeSuns();
        if (this.#bounds === null) return;
        const around = this.#bounds.getBoundingSphere(new Sphere());
        // Suns turn about the middle of the bounds.
        this.#suns.position.copy(around.center);
        for (let at = 0; at + SUN <= rows.length; at += SUN) {
            const [x, y, z, red, green, blue] = rows.subarray(at, at + SUN);
            const brightest = Math.max(red, green, blue);
            if (brightest <= 0) continue;
            const sun = new DirectionalLight();
            sun.color.setRGB(red / brightest, green / brightest, blue / brightest);
            sun.userData = { gi: false, intensity: brightest };
            sun.position.set(x, y, z).multiplyScalar(-2 * around.radius);
            sun.castShadow = true;
            sun.shadow.mapSize.set(2048, 2048);
            const reach = around.radius;
            Object.assign(sun.shadow.camera, { left: -reach, right: reach, bottom: -reach, top: reach, near: 0.5 * reach, far: 3.5 * reach });
            sun.shadow.normalBias = reach / 1000;
            this.#suns.add(sun, sun.target);
        }
    }

    #removeSuns() {
        for (const child of [...this.#suns.children]) {
            this.#suns.remove(child);
            if (child.isLight) child.dispose();
        }
    }

    dispose() {
        this.#isDisposed = true;
        this.#removeSuns();
        this.#suns.removeFromParent();
    }
}

/** The direction that a texel shows: -z in the middle, +x to the right of it, +y at the top. */
function directionOf(width, height) {
    const longitude = screenCoordinate.x.div(width).sub(0.5).mul(2 * Math.PI);
    const latitude = float(0.5).sub(screenCoordinate.y.div(height)).mul(Math.PI);
    const level = latitude.cos();
    return vec3(longitude.sin().mul(level), latitude.sin(), longitude.cos().mul(level).negate());
}
