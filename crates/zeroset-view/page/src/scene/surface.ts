/** A surface of triangles. */

import { BufferAttribute, BufferGeometry, Mesh } from 'three';

import { decodeMesh, type MeshData } from '../decode';
import { fetchMesh, type Vec3 } from '../protocol';
import { along, cross, dot, subtract } from '../vector';
import { splitCreases } from './creases';
import { isClipped, SceneLayer, type Found, type Search } from './layer';
import { surfaceMaterial } from './materials';
import { paint } from './paint';

interface Built {
  data: MeshData;
  /** For each vertex that is drawn the one of the data. */
  sources: Uint32Array;
  mesh: Mesh;
}

interface Hit {
  triangle: number;
  distance: number;
  shares: Vec3;
}

export class SurfaceLayer extends SceneLayer {
  private built: Built | null = null;

  override async load(): Promise<void> {
    try {
      const bytes = await fetchMesh(this.info.id, this.leaving.signal);
      this.build(decodeMesh(bytes, 3, this.info.channels));
      this.grew.emit();
    } catch (error) {
      this.fail(error);
    }
  }

  private build(data: MeshData): void {
    const { sources, indices, normals } = splitCreases(data.positions, data.indices);
    const positions = new Float32Array(3 * sources.length);
    sources.forEach((source, i) => {
      positions[3 * i] = data.positions[3 * source];
      positions[3 * i + 1] = data.positions[3 * source + 1];
      positions[3 * i + 2] = data.positions[3 * source + 2];
    });
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setAttribute('normal', new BufferAttribute(normals, 4, true));
    geometry.setIndex(new BufferAttribute(indices, 1));
    const mesh = new Mesh(geometry, surfaceMaterial(this.context.shared, this.lift));
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    this.built = { data, sources, mesh };
    this.repaint();
    this.group.add(mesh);
  }

  protected override repaint(): void {
    if (!this.built) {
      return;
    }
    const { data, sources, mesh } = this.built;
    const coordinate = (i: number, axis: number) => data.positions[3 * i + axis];
    const painted = { count: data.vertices, channels: data.channels, coordinate };
    const own = new Uint32Array(paint(this.info, this.color, painted, this.context.paint).buffer);
    const drawn = sources.map((source) => own[source]);
    mesh.geometry.setAttribute('color', new BufferAttribute(new Uint8Array(drawn.buffer), 4, true));
  }

  override find(search: Search): Found | null {
    if (!this.built) {
      return null;
    }
    const { data } = this.built;
    const hit = nearestHit(data, search);
    if (!hit) {
      return null;
    }
    const corners = hit.shares.map((share, k) => ({ index: data.indices[3 * hit.triangle + k], share }));
    return {
      layer: this,
      position: along(search.ray.origin, search.ray.direction, hit.distance),
      distance: hit.distance - this.lift,
      corners: corners.sort((a, b) => b.share - a.share),
      channels: data.channels,
    };
  }

  override dispose(): void {
    super.dispose();
    if (this.built) {
      this.built.mesh.geometry.dispose();
      (this.built.mesh.material as { dispose(): void }).dispose();
    }
  }
}

/** The first triangle on the ray that is not clipped there, by the method of Moeller and Trumbore (1997). */
function nearestHit(data: MeshData, { view, ray, halfSpaces }: Search): Hit | null {
  const { positions, indices } = data;
  const corner = (at: number): Vec3 => {
    const vertex = 3 * indices[at];
    return [positions[vertex], positions[vertex + 1], positions[vertex + 2]];
  };
  const nearest = view.near / dot(ray.direction, view.into);
  let best: Hit | null = null;
  for (let at = 0; at < indices.length; at += 3) {
    const a = corner(at);
    const u = subtract(corner(at + 1), a);
    const v = subtract(corner(at + 2), a);
    const p = cross(ray.direction, v);
    const determinant = dot(u, p);
    if (determinant === 0) {
      continue;
    }
    const s = subtract(ray.origin, a);
    const shareU = dot(s, p) / determinant;
    if (shareU < 0 || shareU > 1) {
      continue;
    }
    const q = cross(s, u);
    const shareV = dot(ray.direction, q) / determinant;
    if (shareV < 0 || shareU + shareV > 1) {
      continue;
    }
    const distance = dot(v, q) / determinant;
    if (distance < nearest || (best && distance >= best.distance)) {
      continue;
    }
    if (!isClipped(along(ray.origin, ray.direction, distance), halfSpaces)) {
      best = { triangle: at / 3, distance, shares: [1 - shareU - shareV, shareU, shareV] };
    }
  }
  return best;
}
