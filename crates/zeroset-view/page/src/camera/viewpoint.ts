/** From where a picture is seen: all that picking, choosing nodes and drawing over the picture need to know of a camera. Pixels are those of CSS. */

import type { Vec3 } from '../protocol';
import { add, along, dot, normalized, scale, subtract } from '../vector';

export interface Ray {
  origin: Vec3;
  /** Of length 1. */
  direction: Vec3;
}

export interface Viewpoint {
  eye: Vec3;
  right: Vec3;
  up: Vec3;
  /** Into the picture. */
  into: Vec3;
  isParallel: boolean;
  /** Pixels of a unit: at distance 1, or, in parallel, anywhere. */
  pixelsPerUnit: number;
  width: number;
  height: number;
  near: number;
  far: number;
}

export function depthOf(view: Viewpoint, position: Vec3): number {
  return dot(view.into, subtract(position, view.eye));
}

/** Pixels of a unit at a depth. */
export function pixelsAt(view: Viewpoint, depth: number): number {
  return view.isParallel ? view.pixelsPerUnit : view.pixelsPerUnit / Math.max(depth, view.near);
}

/** Where a position is on the picture; `null` behind the camera. */
export function project(view: Viewpoint, position: Vec3): [number, number] | null {
  const from = subtract(position, view.eye);
  const depth = dot(view.into, from);
  if (!view.isParallel && depth < view.near) {
    return null;
  }
  const pixels = pixelsAt(view, depth);
  return [view.width / 2 + pixels * dot(view.right, from), view.height / 2 - pixels * dot(view.up, from)];
}

/** What a pixel shows. */
export function rayThrough(view: Viewpoint, x: number, y: number): Ray {
  const right = (x - view.width / 2) / view.pixelsPerUnit;
  const up = (view.height / 2 - y) / view.pixelsPerUnit;
  const aside = add(scale(view.right, right), scale(view.up, up));
  return view.isParallel
    ? { origin: add(view.eye, aside), direction: view.into }
    : { origin: view.eye, direction: normalized(add(view.into, aside)) };
}

/** The position at a pixel and a depth. */
export function positionAt(view: Viewpoint, x: number, y: number, depth: number): Vec3 {
  const { origin, direction } = rayThrough(view, x, y);
  return along(origin, direction, depth / dot(direction, view.into));
}

/** Whether a sphere can be seen between the sides of the picture. */
export function seesSphere(view: Viewpoint, center: Vec3, radius: number): boolean {
  const from = subtract(center, view.eye);
  const depth = dot(view.into, from);
  if (depth < view.near - radius || depth > view.far + radius) {
    return false;
  }
  const sides: [number, number][] = [
    [Math.abs(dot(view.right, from)), view.width / 2 / view.pixelsPerUnit],
    [Math.abs(dot(view.up, from)), view.height / 2 / view.pixelsPerUnit],
  ];
  return sides.every(([aside, half]) =>
    view.isParallel ? aside <= half + radius : aside - depth * half <= radius * Math.hypot(1, half),
  );
}
