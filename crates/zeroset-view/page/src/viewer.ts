/** The scene, the camera and the tools, and how they act on one another. Panels show it and change it; it knows nothing of them. */

import { Controls, type Place } from './camera/controls';
import { OrbitCamera } from './camera/orbit';
import { rayThrough } from './camera/viewpoint';
import { formatDegrees, formatLength } from './format';
import type { LayerInfo, SceneInfo, Vec3 } from './protocol';
import { DetailChooser } from './scene/detail';
import { WorldFrame } from './scene/frame';
import { LIFT_REL, type Found, type SceneLayer } from './scene/layer';
import { LineLayer } from './scene/lines';
import type { HalfSpace } from './scene/materials';
import { Pace } from './scene/pace';
import { PointLayer } from './scene/points';
import { Stage } from './scene/stage';
import { SurfaceLayer } from './scene/surface';
import { Signal } from './signal';
import type { Theme } from './theme';
import { ClipPlane } from './tools/clip';
import { angleOf, headline, legsOf, type Measure } from './tools/measure';
import { Overlay, type Trace } from './tools/overlay';
import { describe, findFirst, type Picked } from './tools/pick';
import { Section } from './tools/section';
import { Toolbox } from './tools/toolbox';
import { boxAround, diagonalOf, type Box } from './vector';

/** Pixels around the cursor within which points and lines are found. */
const PICK_RADIUS = 6;
const EMPTY: Box = { low: [-1, -1, -1], high: [1, 1, 1] };
const NO_SCENE: SceneInfo = {
  zeroset: '', title: '', revision: -1, work: null, problems: [], origin: [0, 0, 0], up: 'z', unit: null, crs: null, layers: [], planes: [],
};

export class Viewer {
  readonly sceneChanged = new Signal();
  /** A layer's eye, colour or state, or which one is active. */
  readonly layersChanged = new Signal();
  readonly pickedChanged = new Signal();
  /** The size of points, their budget, or the depth shading. */
  readonly displayChanged = new Signal();
  readonly noticed = new Signal<string>();
  readonly camera: OrbitCamera;
  readonly stage: Stage;
  readonly controls: Controls;
  readonly clip: ClipPlane;
  readonly section: Section;
  readonly detail = new DetailChooser();
  private readonly pace = new Pace(() => this.stage.invalidate());
  readonly toolbox = new Toolbox();
  readonly overlay: Overlay;
  scene = NO_SCENE;
  frame = WorldFrame.of(NO_SCENE);
  layers: SceneLayer[] = [];
  active: SceneLayer | null = null;
  picked: Picked | null = null;
  private cursor: Place | null = null;
  private isFitted = false;

  constructor(canvas: HTMLCanvasElement, overlay: HTMLCanvasElement, readonly theme: Theme) {
    this.camera = new OrbitCamera(this.frame);
    this.stage = new Stage(canvas, this.camera);
    this.clip = new ClipPlane(this.frame, EMPTY);
    this.section = new Section(this.frame);
    this.overlay = new Overlay(overlay, theme);
    this.controls = new Controls(canvas, this.camera, (at) => this.find(at)?.position ?? null);
    this.connect();
  }

  private connect(): void {
    const redraw = () => this.stage.invalidate();
    this.stage.setBackground(this.theme.stage);
    this.theme.changed.listen(() => this.stage.setBackground(this.theme.stage));
    this.stage.framing.listen((view) => {
      const clouds = this.layers.filter((layer) => layer instanceof PointLayer);
      this.stage.shared.setClips(this.halfSpaces());
      this.detail.choose(clouds, view, this.halfSpaces(), this.pace.shareOf(this.stage.waited));
    });
    this.camera.changed.listen(() => this.pace.move());
    this.stage.framed.listen(() => this.drawOverlay());
    this.clip.changed.listen(redraw);
    this.section.changed.listen(redraw);
    this.toolbox.changed.listen(() => this.drawOverlay());
    this.toolbox.sectionDrawn.listen(([from, to]) => {
      if (!this.section.setLine({ from, to })) {
        this.noticed.emit('The two ends lie one above the other: a section needs a direction in plan.');
      }
    });
    this.controls.clicked.listen((at) => this.click(at));
    this.controls.doubleClicked.listen((at) => this.doubleClick(at));
    this.controls.hovered.listen((at) => {
      this.cursor = at;
      if (this.toolbox.draft || this.toolbox.sectionStart) {
        this.drawOverlay();
      }
    });
  }

  /** Shows what the server has now; layers that are the same stay as they are. */
  accept(scene: SceneInfo): void {
    const isNew = scene.revision !== this.scene.revision;
    const frame = WorldFrame.of(scene);
    const isMoved = !frame.equals(this.frame);
    const planesChanged = JSON.stringify(scene.planes) !== JSON.stringify(this.scene.planes);
    this.scene = scene;
    if (isNew) {
      if (isMoved) {
        this.move(frame);
      }
      this.keepLayers(isMoved || planesChanged ? () => false : sameLayer);
      this.fitOnce();
    }
    this.sceneChanged.emit();
  }

  /** Positions of the old frame mean nothing in the new one, except those in world coordinates. */
  private move(frame: WorldFrame): void {
    this.frame = frame;
    this.camera.setFrame(frame);
    this.section.setFrame(frame);
    this.setPicked(null);
    this.isFitted = false;
  }

  private keepLayers(isSame: (layer: LayerInfo, other: LayerInfo) => boolean): void {
    const old = new Map(this.layers.map((layer) => [layer.info.id, layer]));
    const bounds = boxAround(this.scene.layers.map(({ bounds: [low, high] }) => ({ low, high }))) ?? EMPTY;
    const diagonal = diagonalOf(bounds) || 1;
    this.layers = this.scene.layers.map((info) => {
      const before = old.get(info.id);
      if (before && isSame(before.info, info)) {
        old.delete(info.id);
        return before;
      }
      return this.add(info, diagonal, before);
    });
    old.forEach((layer) => layer.dispose());
    const active = this.layers.find((layer) => layer.info.id === this.active?.info.id);
    this.active = active ?? this.layers[0] ?? null;
    this.stage.reach = 2 * diagonal;
    this.stage.shared.sky.value.set(...this.frame.sky);
    this.camera.setReach(bounds);
    this.clip.setScene(this.frame, bounds);
    this.layersChanged.emit();
  }

  private add(info: LayerInfo, diagonal: number, before: SceneLayer | undefined): SceneLayer {
    const context = { paint: { frame: this.frame, planes: this.scene.planes }, shared: this.stage.shared, diagonal };
    const kinds = { points: PointLayer, surface: SurfaceLayer, planes: SurfaceLayer, lines: LineLayer };
    const layer = new kinds[info.kind](info, context);
    if (before) {
      layer.isVisible = before.isVisible;
      if (before.color === null || info.channels.some(({ name }) => name === before.color)) {
        layer.color = before.color;
      }
    }
    layer.grew.listen(() => this.stage.invalidate());
    layer.failed.listen((text) => this.noticed.emit(text));
    this.stage.scene.add(layer.group);
    void layer.load();
    return layer;
  }

  private fitOnce(): void {
    if (!this.isFitted && this.layers.length > 0) {
      this.isFitted = true;
      this.fit(null);
    }
  }

  get bounds(): Box {
    return boxAround(this.layers.map((layer) => layer.bounds)) ?? EMPTY;
  }

  /** Everything that is visible, or one layer, fills the picture. */
  fit(layer: SceneLayer | null): void {
    const visible = this.layers.filter((other) => other.isVisible).map((other) => other.bounds);
    this.camera.fit(layer ? layer.bounds : (boxAround(visible) ?? this.bounds));
  }

  /** Stands square to the section, and sees all of it. */
  lookAtSection(): void {
    this.camera.setParallel(true);
    this.camera.turnTo(this.section.azimuth, 0);
    this.camera.fit(this.section.within(this.bounds));
  }

  halfSpaces(): HalfSpace[] {
    return [...this.clip.halfSpaces(), ...this.section.halfSpaces()];
  }

  setVisible(layer: SceneLayer, isVisible: boolean): void {
    layer.isVisible = isVisible;
    this.changedLayers();
  }

  setColor(layer: SceneLayer, color: string | null): void {
    layer.color = color;
    this.activate(layer);
  }

  activate(layer: SceneLayer): void {
    this.active = layer;
    this.changedLayers();
  }

  private changedLayers(): void {
    this.layersChanged.emit();
    this.stage.invalidate();
  }

  find(at: Place): Found | null {
    const view = this.camera.view();
    const search = { view, ray: rayThrough(view, ...at), radius: PICK_RADIUS, halfSpaces: this.halfSpaces() };
    return findFirst(this.layers, search, LIFT_REL * diagonalOf(this.bounds));
  }

  /** Uses the present tool at a place of the picture. */
  click(at: Place): void {
    const found = this.find(at);
    if (this.toolbox.tool === 'inspect') {
      this.setPicked(found ? describe(found, this.scene, this.frame) : null);
    } else if (found) {
      this.toolbox.take(found.position, this.frame);
    } else {
      this.noticed.emit('There is nothing to click here.');
    }
  }

  private doubleClick(at: Place): void {
    if (this.toolbox.tool !== 'inspect') {
      this.toolbox.finish();
      return;
    }
    const found = this.find(at);
    if (found) {
      this.camera.center(found.position);
    }
  }

  /** Leaves the tool, or else forgets what was clicked. */
  cancel(): void {
    if (this.toolbox.tool === 'inspect') {
      this.setPicked(null);
    } else {
      this.toolbox.choose('inspect');
    }
  }

  setPicked(picked: Picked | null): void {
    this.picked = picked;
    this.pickedChanged.emit();
    this.drawOverlay();
  }

  drawOverlay(): void {
    const traces = this.toolbox.measures.map((measure) => this.traceOf(measure));
    const sectionEnds: Vec3[] = this.toolbox.sectionStart ? [this.toolbox.sectionStart] : [];
    if (this.section.line) {
      traces.push(plainTrace([this.section.line.from, this.section.line.to], false));
    }
    traces.push(plainTrace(sectionEnds, true));
    this.overlay.draw({ traces, picked: this.picked?.position ?? null, cursor: this.cursor }, this.camera.view());
  }

  private traceOf(measure: Measure): Trace {
    const isOpen = measure === this.toolbox.draft;
    const points = measure.points.map((world) => this.frame.local(world));
    if (measure.kind === 'angle') {
      const angle = angleOf(measure);
      return { points, pointLabels: ['', angle === null ? '' : formatDegrees(angle), ''], legLabels: [], isOpen };
    }
    const legs = legsOf(measure, this.frame);
    const pointLabels = points.map(() => '');
    if (legs.length > 1) {
      pointLabels[legs.length] = `Σ ${headline(measure, this.frame, this.scene.unit)}`;
    }
    return { points, pointLabels, legLabels: legs.map((leg) => formatLength(leg.length)), isOpen };
  }
}

function plainTrace(points: Vec3[], isOpen: boolean): Trace {
  return { points, pointLabels: [], legLabels: [], isOpen };
}

function sameLayer(layer: LayerInfo, other: LayerInfo): boolean {
  return JSON.stringify(layer) === JSON.stringify(other);
}
