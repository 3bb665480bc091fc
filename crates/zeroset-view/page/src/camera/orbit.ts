/** A camera that turns around a target, with the sky always up. */

import { Camera, Matrix4, Vector3, WebGLCoordinateSystem } from 'three';

import type { Vec3 } from '../protocol';
import type { WorldFrame } from '../scene/frame';
import { Signal } from '../signal';
import { add, along, centerOf, cornersOf, cross, diagonalOf, dot, scale, subtract, type Box } from '../vector';
import { depthOf, positionAt, type Viewpoint } from './viewpoint';

export const PRESETS = ['iso', 'top', 'front', 'back', 'left', 'right'] as const;
export type Preset = (typeof PRESETS)[number];

const QUARTER = Math.PI / 2;
/** Where the camera stands: from north to east, and above the horizon. The same as those of `zeroset render`. */
const DIRECTIONS: Record<Preset, [number, number]> = {
  iso: [2.5 * QUARTER, Math.atan(Math.SQRT1_2)],
  top: [2 * QUARTER, QUARTER],
  front: [2 * QUARTER, 0],
  back: [0, 0],
  left: [3 * QUARTER, 0],
  right: [QUARTER, 0],
};

/** Half the angle between the lower and the upper side of the picture: its tangent. */
const TANGENT = Math.tan((15 * Math.PI) / 180);
/** A fitted scene takes so much of the picture. */
const FILLED = 0.92;
/** The near plane is never nearer than this share of the far one: 24 bits of depth do not tell more apart. */
const NEAREST_REL = 1 / 4000;
/** Bounds of the distance, in diagonals of the scene. */
const DISTANCES_REL = [1e-5, 40];

export class OrbitCamera {
  readonly changed = new Signal();
  readonly three = new Camera();
  target: Vec3 = [0, 0, 0];
  azimuth = DIRECTIONS.iso[0];
  elevation = DIRECTIONS.iso[1];
  distance = 1;
  isParallel = false;
  private width = 1;
  private height = 1;
  /** All that is to be seen: for the near and far planes. */
  private reach: Box = { low: [-1, -1, -1], high: [1, 1, 1] };

  constructor(private frame: WorldFrame) {
    this.three.matrixAutoUpdate = false;
  }

  setFrame(frame: WorldFrame): void {
    this.frame = frame;
    this.changed.emit();
  }

  setReach(box: Box): void {
    this.reach = box;
    this.changed.emit();
  }

  resize(width: number, height: number): void {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    this.changed.emit();
  }

  /** Half the height of what is seen at the target. */
  get halfHeight(): number {
    return this.distance * TANGENT;
  }

  view(): Viewpoint {
    const [east, north] = [Math.sin(this.azimuth), Math.cos(this.azimuth)];
    const [rise, level] = [Math.sin(this.elevation), Math.cos(this.elevation)];
    const back = this.frame.restored([east * level, north * level, rise]);
    const up = this.frame.restored([-east * rise, -north * rise, level]);
    const into = scale(back, -1);
    const center = centerOf(this.reach);
    const radius = 0.5 * diagonalOf(this.reach);
    // In parallel the distance only sets the scale: stand far enough away for nothing to be behind the camera.
    const away = this.isParallel ? Math.max(this.distance, radius + dot(into, subtract(this.target, center))) : this.distance;
    const eye = along(this.target, back, away);
    const middle = dot(into, subtract(center, eye));
    const far = Math.max(middle + radius * 1.01, away * 1.01);
    const near = this.isParallel ? middle - radius * 1.01 : Math.max((middle - radius) * 0.99, far * NEAREST_REL);
    return {
      eye,
      right: cross(into, up),
      up,
      into,
      isParallel: this.isParallel,
      pixelsPerUnit: this.height / 2 / (this.isParallel ? this.halfHeight : TANGENT),
      width: this.width,
      height: this.height,
      near,
      far,
    };
  }

  /** Brings the camera of three.js to the present viewpoint. */
  apply(view: Viewpoint): void {
    const vector = (v: Vec3) => new Vector3(...v);
    const { three } = this;
    three.matrix = new Matrix4().makeBasis(vector(view.right), vector(view.up), vector(scale(view.into, -1)));
    three.matrix.setPosition(vector(view.eye));
    three.updateMatrixWorld(true);
    const top = view.height / 2 / view.pixelsPerUnit;
    const right = view.width / 2 / view.pixelsPerUnit;
    const { near, far } = view;
    if (view.isParallel) {
      three.projectionMatrix.makeOrthographic(-right, right, top, -top, near, far, WebGLCoordinateSystem);
    } else {
      three.projectionMatrix.makePerspective(
        -right * near, right * near, top * near, -top * near, near, far, WebGLCoordinateSystem,
      );
    }
    three.projectionMatrixInverse.copy(three.projectionMatrix).invert();
  }

  /** Angles in radians: to the east of north, and above the horizon. */
  turnTo(azimuth: number, elevation: number): void {
    this.azimuth = azimuth % (4 * QUARTER);
    this.elevation = Math.max(-QUARTER, Math.min(QUARTER, elevation));
    this.changed.emit();
  }

  orbit(azimuth: number, elevation: number): void {
    this.turnTo(this.azimuth + azimuth, this.elevation + elevation);
  }

  look(preset: Preset): void {
    this.turnTo(...DIRECTIONS[preset]);
  }

  /** Moves what is at the target by pixels to the right and down. */
  pan(right: number, down: number): void {
    const view = this.view();
    const unit = (2 * this.halfHeight) / this.height;
    this.target = add(this.target, add(scale(view.right, -right * unit), scale(view.up, down * unit)));
    this.changed.emit();
  }

  /** Scales the distance; `anchor`, a position, stays where it is on the picture. */
  zoom(factor: number, anchor: Vec3 | null): void {
    const diagonal = diagonalOf(this.reach) || 1;
    const [least, most] = DISTANCES_REL.map((share) => share * diagonal);
    if (anchor && !this.isParallel) {
      // The target comes to the depth of the anchor, so that the next turn is around what is looked at.
      const view = this.view();
      const depth = depthOf(view, anchor);
      if (depth > view.near) {
        this.target = positionAt(view, this.width / 2, this.height / 2, depth);
        this.distance = depth;
      }
    }
    const distance = Math.max(least, Math.min(most, this.distance * factor));
    if (anchor) {
      this.target = along(anchor, subtract(this.target, anchor), distance / this.distance);
    }
    this.distance = distance;
    this.changed.emit();
  }

  center(position: Vec3): void {
    this.target = position;
    this.changed.emit();
  }

  setParallel(isParallel: boolean): void {
    this.isParallel = isParallel;
    this.changed.emit();
  }

  /** Steps back or near until the box fills the picture. */
  fit(box: Box): void {
    const center = centerOf(box);
    const { right, up, into } = this.view();
    const tangents = [(FILLED * TANGENT * this.width) / this.height, FILLED * TANGENT];
    let distance = 0;
    for (const corner of cornersOf(box)) {
      const from = subtract(corner, center);
      const depth = this.isParallel ? 0 : dot(into, from);
      [right, up].forEach((axis, i) => {
        distance = Math.max(distance, Math.abs(dot(axis, from)) / tangents[i] - depth);
      });
    }
    this.target = center;
    this.distance = distance > 0 ? distance : 1;
    this.changed.emit();
  }
}
