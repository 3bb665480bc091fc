/** What all layers have in common. */

import { Group } from 'three';

import type { Viewpoint, Ray } from '../camera/viewpoint';
import type { ChannelArrays } from '../decode';
import type { LayerInfo, Vec3 } from '../protocol';
import { Signal } from '../signal';
import { dot, type Box } from '../vector';
import type { HalfSpace, SharedUniforms } from './materials';
import type { PaintContext } from './paint';

/** How far a lifted layer comes nearer, as a share of the diagonal of the scene; as in `zeroset render`. */
export const LIFT_REL = 0.002;

/** What the layers of one scene share. */
export interface LayerContext {
  paint: PaintContext;
  shared: SharedUniforms;
  /** The diagonal of the scene. */
  diagonal: number;
}

/** Where to look for something. */
export interface Search {
  view: Viewpoint;
  ray: Ray;
  /** Pixels around the ray within which points and lines are found. */
  radius: number;
  /** What lies outside of any of these is not seen. */
  halfSpaces: HalfSpace[];
}

/** Something found on a ray. */
export interface Found {
  layer: SceneLayer;
  /** Local. */
  position: Vec3;
  /** Along the ray; what is lifted counts as nearer. */
  distance: number;
  /** The vertices or points it lies between, with their shares; the largest first. */
  corners: { index: number; share: number }[];
  channels: ChannelArrays;
}

export function isClipped(position: Vec3, halfSpaces: HalfSpace[]): boolean {
  return halfSpaces.some(({ normal, offset }) => dot(normal, position) + offset < 0);
}

export abstract class SceneLayer {
  readonly group = new Group();
  /** More of the layer can be drawn than before. */
  readonly grew = new Signal();
  /** A line for the user. */
  readonly failed = new Signal<string>();
  protected readonly leaving = new AbortController();
  private shownColor: string | null;

  constructor(
    readonly info: LayerInfo,
    protected readonly context: LayerContext,
  ) {
    this.shownColor = info.color;
    this.group.matrixAutoUpdate = false;
  }

  /** Name of the channel by which the layer is coloured; `null`: its plain colour. */
  get color(): string | null {
    return this.shownColor;
  }

  set color(color: string | null) {
    if (color !== this.shownColor) {
      this.shownColor = color;
      this.repaint();
    }
  }

  get isVisible(): boolean {
    return this.group.visible;
  }

  set isVisible(isVisible: boolean) {
    this.group.visible = isVisible;
  }

  get bounds(): Box {
    return { low: this.info.bounds[0], high: this.info.bounds[1] };
  }

  /** Asks for the layer's data; `grew` tells when some is there. */
  abstract load(): Promise<void>;
  abstract find(search: Search): Found | null;
  protected abstract repaint(): void;

  /** Frees what the graphics card holds, and stops loading. */
  dispose(): void {
    this.leaving.abort();
    this.group.removeFromParent();
  }

  protected get lift(): number {
    return this.info.lifted ? LIFT_REL * this.context.diagonal : 0;
  }

  /** What goes wrong while the layer leaves is of no interest. */
  protected fail(error: unknown): void {
    if (!this.leaving.signal.aborted) {
      this.failed.emit(`${this.info.name}: ${error instanceof Error ? error.message : String(error)}`);
    }
  }
}
