/** A cloud of points: an octree, of which the nodes that matter are drawn. */

import { BufferAttribute, BufferGeometry, Points, Vector3, type RawShaderMaterial } from 'three';

import { depthOf, pixelsAt } from '../camera/viewpoint';
import { decodeNode, type NodeData } from '../decode';
import { fetchNode, fetchNodes, Unreachable, type NodeInfo, type Vec3 } from '../protocol';
import { along, dot, norm, subtract } from '../vector';
import { isClipped, SceneLayer, type Found, type Search } from './layer';
import { pointMaterial } from './materials';
import { paint, type Painted } from './paint';

const LAST_CODE = 65535;
/** Points are found within a disc as large as they are drawn, but not larger than this, in pixels. */
const WIDEST_SEARCH = 11;

export class OctreeNode {
  readonly children: OctreeNode[] = [];
  readonly center: Vec3;
  readonly radius: number;
  state: 'absent' | 'loading' | 'loaded' | 'failed' = 'absent';
  data: NodeData | null = null;
  object: Points | null = null;
  paintedBy: string | null | undefined = undefined;
  /** Number of the last frame that drew it. */
  lastDrawn = 0;
  isDrawn = false;
  /** About the distance between the points that are drawn in each eighth of the cube. */
  spacings = new Array<number>(8).fill(0);

  constructor(
    readonly layer: PointLayer,
    readonly info: NodeInfo,
    readonly depth: number,
  ) {
    const half = info.side / 2;
    this.center = info.low.map((c) => c + half) as Vec3;
    this.radius = half * Math.sqrt(3);
  }

  /** Which eighth of this cube a child fills. */
  octantOf(child: OctreeNode): number {
    return child.center.reduce((octant, c, axis) => octant + (c >= this.center[axis] ? 1 << axis : 0), 0);
  }

  /** Points of the node, and those of the children drawn into it: sets how large its points have to be, and tells the mean spacing. */
  spread(): number {
    const { spacing } = this.info;
    this.spacings.fill(spacing);
    if (this.children.length === 0) {
      return spacing;
    }
    let sum = 0;
    for (const child of this.children) {
      const finer = child.isDrawn ? child.spread() : spacing;
      this.spacings[this.octantOf(child)] = finer;
      sum += finer;
    }
    return sum / this.children.length;
  }
}

export class PointLayer extends SceneLayer {
  root: OctreeNode | null = null;
  private material: RawShaderMaterial | null = null;
  private nodes: OctreeNode[] = [];

  override async load(): Promise<void> {
    try {
      const infos = await fetchNodes(this.info.id);
      this.nodes = this.tree(infos);
      this.root = this.nodes[0] ?? null;
      this.grew.emit();
    } catch (error) {
      this.fail(error);
    }
  }

  private tree(infos: NodeInfo[]): OctreeNode[] {
    const byId = new Map<number, OctreeNode>();
    // Parents have to be known before their children.
    const sorted = [...infos].sort((a, b) => b.side - a.side);
    for (const info of sorted) {
      const parent = info.parent === null ? undefined : byId.get(info.parent);
      const node = new OctreeNode(this, info, parent ? parent.depth + 1 : 0);
      byId.set(info.id, node);
      parent?.children.push(node);
    }
    return sorted.map((info) => byId.get(info.id) as OctreeNode);
  }

  /** Asks for a node's points. */
  async loadNode(node: OctreeNode): Promise<void> {
    node.state = 'loading';
    try {
      const bytes = await fetchNode(this.info.id, node.info.id, this.leaving.signal);
      node.data = decodeNode(bytes, this.info.channels);
      node.object = this.build(node, node.data);
      node.state = 'loaded';
      this.grew.emit();
    } catch (error) {
      // A server that is gone may come back; bytes that are wrong stay wrong, and leave their place to the next node.
      node.state = error instanceof Unreachable ? 'absent' : 'failed';
      this.fail(error);
      if (node.state === 'failed') {
        this.grew.emit();
      }
    }
  }

  private build(node: OctreeNode, data: NodeData): Points {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(data.positions, 3, true));
    geometry.setAttribute('color', new BufferAttribute(new Uint8Array(4 * data.count), 4, true));
    this.material ??= pointMaterial(this.context.shared, this.info.diameter, this.lift);
    const { material } = this;
    const object = new Points(geometry, material);
    object.frustumCulled = false;
    object.matrixAutoUpdate = false;
    const { low, side } = node.info;
    object.matrix.makeScale(side, side, side).setPosition(new Vector3(...low));
    object.matrixWorldNeedsUpdate = true;
    object.onBeforeRender = () => {
      material.uniforms.spacings.value = node.spacings;
      material.uniformsNeedUpdate = true;
    };
    object.visible = false;
    this.group.add(object);
    return object;
  }

  /** Draws a node from now on, or no longer. */
  show(node: OctreeNode, isDrawn: boolean): void {
    node.isDrawn = isDrawn;
    if (!node.object || !node.data) {
      return;
    }
    node.object.visible = isDrawn;
    if (isDrawn && node.paintedBy !== this.color) {
      node.paintedBy = this.color;
      const attribute = node.object.geometry.getAttribute('color') as BufferAttribute;
      attribute.array = paint(this.info, this.color, this.painted(node, node.data), this.context.paint);
      attribute.needsUpdate = true;
    }
  }

  private painted(node: OctreeNode, data: NodeData): Painted {
    const { low, side } = node.info;
    const { positions, count, channels } = data;
    return { count, channels, coordinate: (i, axis) => low[axis] + (side * positions[3 * i + axis]) / LAST_CODE };
  }

  /** Forgets a node's points. */
  unload(node: OctreeNode): void {
    if (node.object) {
      node.object.geometry.dispose();
      node.object.removeFromParent();
    }
    node.object = null;
    node.data = null;
    node.paintedBy = undefined;
    node.isDrawn = false;
    node.state = 'absent';
  }

  get loaded(): OctreeNode[] {
    return this.nodes.filter((node) => node.state === 'loaded');
  }

  /** Nodes that are on their way. */
  get loading(): number {
    return this.nodes.reduce((sum, node) => sum + (node.state === 'loading' ? 1 : 0), 0);
  }

  get drawn(): OctreeNode[] {
    return this.nodes.filter((node) => node.isDrawn);
  }

  /** Nodes are painted when they are drawn next. */
  protected override repaint(): void {}

  /** Of the points about the ray, the one that is seen: among the nearest to the camera, the nearest to the ray. */
  override find(search: Search): Found | null {
    let best: { node: OctreeNode; index: number; distance: number; aside: number } | null = null;
    for (const node of this.drawn) {
      const near = this.nearRay(node, search);
      for (const hit of near) {
        const gap = best ? hit.distance - best.distance : -Infinity;
        const tolerance = hit.tolerance;
        if (!best || gap < -tolerance || (gap < tolerance && hit.aside < best.aside)) {
          best = { node, ...hit };
        }
      }
    }
    if (!best) {
      return null;
    }
    const { node, index, distance } = best;
    const data = node.data as NodeData;
    return {
      layer: this,
      position: positionOf(node, data, index),
      distance: distance - this.lift,
      corners: [{ index, share: 1 }],
      channels: data.channels,
    };
  }

  private nearRay(node: OctreeNode, { view, ray, radius, halfSpaces }: Search) {
    const hits: { index: number; distance: number; aside: number; tolerance: number }[] = [];
    const { data } = node;
    const toCenter = subtract(node.center, ray.origin);
    const reach = dot(toCenter, ray.direction);
    const widest = WIDEST_SEARCH / pixelsAt(view, Math.max(depthOf(view, node.center) + node.radius, view.near));
    const aside = norm(along(toCenter, ray.direction, -reach));
    if (!data || aside > node.radius + widest) {
      return hits;
    }
    const spacing = Math.min(...node.spacings);
    const { side, low } = node.info;
    const { positions, count } = data;
    const unit = side / LAST_CODE;
    const [ox, oy, oz] = subtract(low, ray.origin);
    const [dx, dy, dz] = ray.direction;
    const slope = dot(ray.direction, view.into);
    for (let i = 0; i < count; i++) {
      const x = ox + unit * positions[3 * i];
      const y = oy + unit * positions[3 * i + 1];
      const z = oz + unit * positions[3 * i + 2];
      const t = x * dx + y * dy + z * dz;
      if (t * slope < view.near) {
        continue;
      }
      const perUnit = view.isParallel ? view.pixelsPerUnit : view.pixelsPerUnit / (t * slope);
      const away = Math.sqrt(Math.max(0, x * x + y * y + z * z - t * t)) * perUnit;
      const disc = this.info.diameter ?? spacing * perUnit;
      const limit = Math.min(WIDEST_SEARCH, Math.max(radius, 0.7 * disc));
      if (away <= limit && !isClipped(positionOf(node, data, i), halfSpaces)) {
        hits.push({ index: i, distance: t, aside: away, tolerance: (2 * limit) / perUnit });
      }
    }
    return hits;
  }

  override dispose(): void {
    super.dispose();
    this.nodes.forEach((node) => this.unload(node));
    this.material?.dispose();
  }
}

/** Where a point is, in doubles. */
function positionOf(node: OctreeNode, data: NodeData, index: number): Vec3 {
  const { low, side } = node.info;
  return low.map((c, axis) => c + (side * data.positions[3 * index + axis]) / LAST_CODE) as Vec3;
}
