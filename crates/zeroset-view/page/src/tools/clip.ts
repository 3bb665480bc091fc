/** One plane that cuts away what is beyond it. */

import type { Vec3 } from '../protocol';
import type { WorldFrame } from '../scene/frame';
import type { HalfSpace } from '../scene/materials';
import { Signal } from '../signal';
import { add, centerOf, cornersOf, dot, scale, type Box } from '../vector';

export const CLIP_MODES = ['off', 'x', 'y', 'z', 'heading'] as const;
export type ClipMode = (typeof CLIP_MODES)[number];

export class ClipPlane {
  readonly changed = new Signal();
  mode: ClipMode = 'off';
  /** Degrees to the east of north: where the plane's normal points to, with mode `heading`. */
  heading = 45;
  /** World coordinate along the axis; with mode `heading`, distance from the middle of the scene. */
  position = 0;
  /** Keeps what is beyond, instead of what is before. */
  isFlipped = false;

  constructor(
    private frame: WorldFrame,
    private bounds: Box,
  ) {}

  setScene(frame: WorldFrame, bounds: Box): void {
    this.frame = frame;
    this.bounds = bounds;
    this.changed.emit();
  }

  setMode(mode: ClipMode): void {
    this.mode = mode;
    this.toMiddle();
  }

  setHeading(degrees: number): void {
    this.heading = degrees;
    this.changed.emit();
  }

  setPosition(position: number): void {
    this.position = position;
    this.changed.emit();
  }

  flip(): void {
    this.isFlipped = !this.isFlipped;
    this.changed.emit();
  }

  /** The least and the greatest position that cuts the scene. */
  range(): [number, number] {
    const places = cornersOf(this.bounds).map((corner) => this.along(corner));
    return [Math.min(...places), Math.max(...places)];
  }

  halfSpaces(): HalfSpace[] {
    if (this.mode === 'off') {
      return [];
    }
    const sign = this.isFlipped ? 1 : -1;
    return [{ normal: scale(this.normal(), sign), offset: sign * (this.along([0, 0, 0]) - this.position) }];
  }

  private toMiddle(): void {
    const [low, high] = this.range();
    this.setPosition((low + high) / 2);
  }

  private normal(): Vec3 {
    const turn = (this.heading * Math.PI) / 180;
    switch (this.mode) {
      case 'x':
        return [1, 0, 0];
      case 'y':
        return [0, 1, 0];
      case 'heading':
        return this.frame.restored([Math.sin(turn), Math.cos(turn), 0]);
      default:
        return [0, 0, 1];
    }
  }

  /** The coordinate of a local position along the normal. */
  private along(local: Vec3): number {
    const base = this.mode === 'heading' ? scale(centerOf(this.bounds), -1) : this.frame.origin;
    return dot(this.normal(), add(local, base));
  }
}
