/** Where things are: which way is up, and what the world's coordinates are. */

import type { SceneInfo, UpAxis, Vec3 } from '../protocol';
import { add, subtract } from '../vector';

/** For east, north and sky: the axis of the file and its sign. The same choice as the library's, so that presets agree with `zeroset render`. */
const AXES: Record<UpAxis, [number, number][]> = {
  z: [[0, 1], [1, 1], [2, 1]],
  x: [[1, 1], [2, 1], [0, 1]],
  y: [[2, 1], [0, 1], [1, 1]],
  '-z': [[1, 1], [0, 1], [2, -1]],
  '-x': [[2, 1], [1, 1], [0, -1]],
  '-y': [[0, 1], [2, 1], [1, -1]],
};

export class WorldFrame {
  readonly sky: Vec3;
  private readonly axes: [number, number][];

  constructor(
    readonly origin: Vec3,
    up: UpAxis,
  ) {
    this.axes = AXES[up];
    this.sky = this.restored([0, 0, 1]);
  }

  static of(scene: SceneInfo): WorldFrame {
    return new WorldFrame(scene.origin, scene.up);
  }

  equals(other: WorldFrame): boolean {
    return this.origin.every((c, i) => c === other.origin[i]) && this.sky.every((c, i) => c === other.sky[i]);
  }

  /** East, north and height of a vector of the file. */
  upright(vector: Vec3): Vec3 {
    return this.axes.map(([axis, sign]) => sign * vector[axis]) as Vec3;
  }

  /** The file's vector of east, north and height. */
  restored(upright: Vec3): Vec3 {
    const vector: Vec3 = [0, 0, 0];
    this.axes.forEach(([axis, sign], i) => {
      vector[axis] = sign * upright[i];
    });
    return vector;
  }

  world(local: Vec3): Vec3 {
    return add(this.origin, local);
  }

  local(world: Vec3): Vec3 {
    return subtract(world, this.origin);
  }

  /** The axis that is up, its sign, and what to add for the world's height: for loops over many points. */
  height(): { axis: number; sign: number; shift: number } {
    const [axis, sign] = this.axes[2];
    return { axis, sign, shift: sign * this.origin[axis] };
  }
}
