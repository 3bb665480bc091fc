/** Vectors of doubles. */

import type { Vec3 } from './protocol';

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, factor: number): Vec3 => [a[0] * factor, a[1] * factor, a[2] * factor];
/** a + factor * b */
export const along = (a: Vec3, b: Vec3, factor: number): Vec3 => add(a, scale(b, factor));
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const distance = (a: Vec3, b: Vec3): number => norm(subtract(a, b));
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

export function normalized(a: Vec3): Vec3 {
  const length = norm(a);
  return length > 0 ? scale(a, 1 / length) : [0, 0, 0];
}

/** A box along the axes. */
export interface Box {
  low: Vec3;
  high: Vec3;
}

export function boxAround(boxes: Box[]): Box | null {
  if (boxes.length === 0) {
    return null;
  }
  const pick = (choose: (...values: number[]) => number, side: 'low' | 'high'): Vec3 =>
    [0, 1, 2].map((axis) => choose(...boxes.map((box) => box[side][axis]))) as Vec3;
  return { low: pick(Math.min, 'low'), high: pick(Math.max, 'high') };
}

export const centerOf = (box: Box): Vec3 => scale(add(box.low, box.high), 0.5);
export const diagonalOf = (box: Box): number => distance(box.low, box.high);

export function cornersOf({ low, high }: Box): Vec3[] {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [
    i & 1 ? high[0] : low[0],
    i & 2 ? high[1] : low[1],
    i & 4 ? high[2] : low[2],
  ]);
}
