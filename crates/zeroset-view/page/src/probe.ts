/**
 * `window.zeroset`: what the page shows, to be read by tests. Each read gives the present state as plain data; nothing can be changed by it.
 *
 * - `frame`: how many frames were drawn so far, draw calls, points and nodes of the last one, nodes still loading
 * - `camera`: target (world), azimuth and elevation in degrees, distance, and whether it is parallel
 * - `picked`: layer, world position, readings and plane of what was clicked last, or `null`
 * - `measures`: kind and points (world) of each
 * - `layers`: id, name, kind, count, whether visible, and colour channel
 * - `clips`: how many half spaces cut the scene
 * - `scene`: revision, whether the server works, problems
 * - `project(world)`: where a world position is, in pixels of the window, or `null` if it is behind the camera
 */

import { project } from './camera/viewpoint';
import type { Vec3 } from './protocol';
import type { Viewer } from './viewer';

function stateOf(viewer: Viewer) {
  const degrees = 180 / Math.PI;
  return {
    get frame() {
      const { points, nodes, of, loading } = viewer.detail.report;
      return { drawn: viewer.stage.framesDrawn, drawCalls: viewer.stage.drawCalls, points, of, nodes, loading };
    },
    get camera() {
      const { target, azimuth, elevation, distance, isParallel } = viewer.camera;
      return {
        target: viewer.frame.world(target),
        azimuth: azimuth * degrees,
        elevation: elevation * degrees,
        distance,
        isParallel,
      };
    },
    get picked() {
      const { picked } = viewer;
      return picked && { layer: picked.layer, world: [...picked.world], readings: [...picked.readings], plane: picked.plane };
    },
    get measures() {
      return viewer.toolbox.measures.map(({ kind, points }) => ({ kind, points: points.map((p) => [...p]) }));
    },
    get layers() {
      return viewer.layers.map(({ info, isVisible, color }) => {
        const { id, name, kind, count } = info;
        return { id, name, kind, count, isVisible, color };
      });
    },
    get clips() {
      return viewer.halfSpaces().length;
    },
    get scene() {
      const { revision, work, problems } = viewer.scene;
      return { revision, isWorking: work !== null, problems: [...problems] };
    },
    project(world: Vec3): [number, number] | null {
      const place = project(viewer.camera.view(), viewer.frame.local(world));
      const { left, top } = viewer.stage.canvas.getBoundingClientRect();
      return place && [place[0] + left, place[1] + top];
    },
  };
}

export type Probe = ReturnType<typeof stateOf>;

declare global {
  interface Window {
    readonly zeroset: Probe;
  }
}

export function expose(viewer: Viewer): void {
  Object.defineProperty(window, 'zeroset', { value: Object.freeze(stateOf(viewer)) });
}
