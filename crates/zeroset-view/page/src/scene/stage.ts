/** The picture: draws the scene when something has changed, and never otherwise. */

import {
  BufferAttribute,
  BufferGeometry,
  Camera,
  ColorManagement,
  DepthTexture,
  GLSL3,
  Mesh,
  NearestFilter,
  NoBlending,
  RawShaderMaterial,
  Scene,
  UnsignedIntType,
  Vector2,
  WebGLRenderer,
  WebGLRenderTarget,
} from 'three';

import type { OrbitCamera } from '../camera/orbit';
import type { Viewpoint } from '../camera/viewpoint';
import type { Rgb } from '../protocol';
import { Signal } from '../signal';
import { SharedUniforms } from './materials';
import { SCREEN_FRAGMENT, SCREEN_VERTEX } from './shaders';

/** How much darker what lies behind its surroundings gets; the same as in `zeroset render`. */
const CUE_STRENGTH = 160;
/** Finer displays would only cost time. */
const FINEST_PIXELS = 2;
/** Samples of a pixel where pixels are large enough to be seen. */
const SAMPLES = 4;
/** Names of processors that draw in the place of a graphics card: smooth edges would double their time. */
const SLOW = /swiftshader|llvmpipe|software|basic render/i;

export class Stage {
  readonly scene = new Scene();
  readonly shared = new SharedUniforms();
  /** Before a frame: the time to choose what it shows. */
  readonly framing = new Signal<Viewpoint>();
  /** After a frame. */
  readonly framed = new Signal<Viewpoint>();
  framesDrawn = 0;
  drawCalls = 0;
  /** Milliseconds from asking for the present frame to its start: the browser lets it wait while the last one is still being drawn. */
  waited = 0;
  hasDepthCue = true;
  /** The largest distance in the scene: the unit of depth in a parallel view. */
  reach = 1;
  private readonly renderer: WebGLRenderer;
  private readonly target: WebGLRenderTarget;
  private readonly screen: { scene: Scene; camera: Camera; material: RawShaderMaterial };
  private askedAt: number | null = null;

  constructor(
    readonly canvas: HTMLCanvasElement,
    readonly camera: OrbitCamera,
  ) {
    // Colours are shown as they are sent, and alpha is no share of them.
    ColorManagement.enabled = false;
    this.renderer = new WebGLRenderer({
      canvas,
      antialias: false,
      depth: false,
      premultipliedAlpha: false,
      powerPreference: 'high-performance',
    });
    this.renderer.info.autoReset = false;
    this.target = new WebGLRenderTarget(1, 1, {
      minFilter: NearestFilter,
      magFilter: NearestFilter,
      samples: window.devicePixelRatio < 2 && !SLOW.test(this.rendererName()) ? SAMPLES : 0,
      depthTexture: new DepthTexture(1, 1, UnsignedIntType),
    });
    this.screen = screenPass(this.target);
    this.scene.matrixAutoUpdate = false;
    camera.changed.listen(() => this.invalidate());
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement as HTMLElement);
    canvas.addEventListener('webglcontextrestored', () => this.invalidate());
    this.resize();
  }

  private rendererName(): string {
    const context = this.renderer.getContext();
    const name = String(context.getParameter(context.RENDERER));
    // Some browsers tell the real name only on request, and others warn of that request.
    const details = name.startsWith('WebKit') ? context.getExtension('WEBGL_debug_renderer_info') : null;
    return details ? String(context.getParameter(details.UNMASKED_RENDERER_WEBGL)) : name;
  }

  get pixelRatio(): number {
    return Math.min(window.devicePixelRatio, FINEST_PIXELS);
  }

  setBackground([r, g, b]: Rgb): void {
    // The alpha of 0 keeps the depth cue away from the background.
    this.renderer.setClearColor((r << 16) | (g << 8) | b, 0);
    this.invalidate();
  }

  /** Asks for a frame, soon. */
  invalidate(): void {
    if (this.askedAt === null) {
      this.askedAt = performance.now();
      requestAnimationFrame(() => this.draw());
    }
  }

  /** Draws at once. */
  draw(): void {
    this.waited = this.askedAt === null ? 0 : performance.now() - this.askedAt;
    this.askedAt = null;
    const view = this.camera.view();
    this.camera.apply(view);
    this.framing.emit(view);
    this.shared.setView(view, this.pixelRatio);
    this.renderer.info.reset();
    this.renderer.setRenderTarget(this.target);
    this.renderer.render(this.scene, this.camera.three);
    this.drawCalls = this.renderer.info.render.calls;
    this.drawScreen(view);
    this.framesDrawn += 1;
    this.framed.emit(view);
  }

  private drawScreen(view: Viewpoint): void {
    const { uniforms } = this.screen.material;
    uniforms.near_far.value.set(view.near, view.far);
    uniforms.is_parallel.value = view.isParallel;
    uniforms.reach.value = this.reach;
    uniforms.strength.value = this.hasDepthCue ? CUE_STRENGTH : 0;
    uniforms.step_size.value.set(1 / view.width, 1 / view.height);
    this.renderer.setRenderTarget(null);
    this.renderer.render(this.screen.scene, this.screen.camera);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement as HTMLElement;
    if (width === 0 || height === 0) {
      return;
    }
    this.renderer.setPixelRatio(this.pixelRatio);
    this.renderer.setSize(width, height, false);
    const pixels = this.renderer.getDrawingBufferSize(new Vector2());
    this.target.setSize(pixels.x, pixels.y);
    this.camera.resize(width, height);
    // A canvas is blank after a change of its size: waiting for the next frame would flicker.
    this.draw();
  }
}

/** One triangle that covers the picture. */
function screenPass(target: WebGLRenderTarget): { scene: Scene; camera: Camera; material: RawShaderMaterial } {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: SCREEN_VERTEX,
    fragmentShader: SCREEN_FRAGMENT,
    blending: NoBlending,
    depthTest: false,
    depthWrite: false,
    uniforms: {
      colors: { value: target.texture },
      depths: { value: target.depthTexture },
      step_size: { value: new Vector2() },
      near_far: { value: new Vector2() },
      is_parallel: { value: false },
      reach: { value: 1 },
      strength: { value: 0 },
    },
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  const scene = new Scene();
  scene.add(mesh);
  return { scene, camera: new Camera(), material };
}
