/** Straight lines, such as sharp edges. */

import {
  BufferAttribute,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
} from 'three';

import { depthOf, pixelsAt } from '../camera/viewpoint';
import { decodeMesh, type MeshData } from '../decode';
import { fetchMesh, type Vec3 } from '../protocol';
import { along, distance, dot, subtract } from '../vector';
import { isClipped, SceneLayer, type Found, type Search } from './layer';
import { lineMaterial } from './materials';
import { paint } from './paint';

export class LineLayer extends SceneLayer {
  private built: { data: MeshData; mesh: Mesh } | null = null;

  override async load(): Promise<void> {
    try {
      const bytes = await fetchMesh(this.info.id, this.leaving.signal);
      this.build(decodeMesh(bytes, 2, this.info.channels));
      this.grew.emit();
    } catch (error) {
      this.fail(error);
    }
  }

  private build(data: MeshData): void {
    const geometry = new InstancedBufferGeometry();
    // Along the line, and to its sides.
    geometry.setAttribute('corner', new BufferAttribute(new Float32Array([0, -1, 1, -1, 1, 1, 0, 1]), 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    geometry.instanceCount = data.indices.length / 2;
    for (const [end, name] of ['first', 'second'].entries()) {
      const positions = new Float32Array((3 * data.indices.length) / 2);
      for (let line = 0; 2 * line < data.indices.length; line++) {
        const vertex = 3 * data.indices[2 * line + end];
        positions.set(data.positions.subarray(vertex, vertex + 3), 3 * line);
      }
      geometry.setAttribute(name, new InstancedBufferAttribute(positions, 3));
    }
    const mesh = new Mesh(geometry, lineMaterial(this.context.shared, this.lift));
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    this.built = { data, mesh };
    this.repaint();
    this.group.add(mesh);
  }

  protected override repaint(): void {
    if (!this.built) {
      return;
    }
    const { data, mesh } = this.built;
    const coordinate = (i: number, axis: number) => data.positions[3 * i + axis];
    const painted = { count: data.vertices, channels: data.channels, coordinate };
    const own = new Uint32Array(paint(this.info, this.color, painted, this.context.paint).buffer);
    for (const [end, name] of ['first_color', 'second_color'].entries()) {
      const colors = new Uint32Array(data.indices.length / 2).map((_, line) => own[data.indices[2 * line + end]]);
      mesh.geometry.setAttribute(name, new InstancedBufferAttribute(new Uint8Array(colors.buffer), 4, true));
    }
  }

  override find(search: Search): Found | null {
    if (!this.built) {
      return null;
    }
    const { data } = this.built;
    let best: Found | null = null;
    for (let at = 0; at < data.indices.length; at += 2) {
      const ends = [data.indices[at], data.indices[at + 1]];
      const [a, b] = ends.map((v) => [...data.positions.subarray(3 * v, 3 * v + 3)] as Vec3);
      const near = nearestOnLine(a, b, search);
      if (!near || (best && near.distance - this.lift >= best.distance)) {
        continue;
      }
      const corners = ends.map((index, k) => ({ index, share: k === 0 ? 1 - near.share : near.share }));
      best = {
        layer: this,
        position: near.position,
        distance: near.distance - this.lift,
        corners: corners.sort((p, q) => q.share - p.share),
        channels: data.channels,
      };
    }
    return best;
  }

  override dispose(): void {
    super.dispose();
    if (this.built) {
      this.built.mesh.geometry.dispose();
      (this.built.mesh.material as { dispose(): void }).dispose();
    }
  }
}

/** The position of the line from `a` to `b` that is nearest to the ray, if that is near enough on the picture. */
function nearestOnLine(a: Vec3, b: Vec3, { view, ray, radius, halfSpaces }: Search) {
  const u = subtract(b, a);
  const s = subtract(a, ray.origin);
  const [uu, ud, us, ds] = [dot(u, u), dot(u, ray.direction), dot(u, s), dot(ray.direction, s)];
  const determinant = uu - ud * ud;
  const free = determinant > 1e-12 * uu ? (ud * ds - us) / determinant : 0;
  const share = Math.min(1, Math.max(0, free));
  const position = along(a, u, share);
  const depth = depthOf(view, position);
  const reach = dot(subtract(position, ray.origin), ray.direction);
  const away = distance(position, along(ray.origin, ray.direction, reach)) * pixelsAt(view, depth);
  if (depth < view.near || away > radius || isClipped(position, halfSpaces)) {
    return null;
  }
  return { position, share, distance: reach };
}
