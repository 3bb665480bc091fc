/** Which nodes of the clouds to draw: those whose points lie farthest apart on the picture first, under a budget. */

import { depthOf, pixelsAt, project, seesSphere, type Viewpoint } from '../camera/viewpoint';
import { dot } from '../vector';
import type { HalfSpace } from './materials';
import type { OctreeNode, PointLayer } from './points';

/** A node whose points are nearer to one another on the picture, in pixels, needs no finer ones. */
const FINEST = 1.2;
/** No frame draws more nodes than this. */
export const MOST_NODES = 500;
/** So many nodes are asked for at a time. */
const PARALLEL_LOADS = 6;
/** Points are kept in memory up to this multiple of the budget. */
const KEPT = 2;

export interface DetailReport {
  points: number;
  nodes: number;
  /** Points that are hidden by no layer's eye. */
  of: number;
  /** Nodes that are wanted and not there yet. */
  loading: number;
}

interface Wanted {
  node: OctreeNode;
  urgency: number;
}

export class DetailChooser {
  /** Points of a frame, at most. */
  budget = 3_000_000;
  report: DetailReport = { points: 0, nodes: 0, of: 0, loading: 0 };
  private frame = 0;

  /** Shows the nodes that matter from here, and asks for those that are missing. `share`: how much of the budget may be used now. */
  choose(layers: PointLayer[], view: Viewpoint, halfSpaces: HalfSpace[], share: number): void {
    this.frame += 1;
    const before = layers.flatMap((layer) => layer.drawn);
    before.forEach((node) => (node.isDrawn = false));
    const visible = layers.filter((layer) => layer.isVisible);
    const { drawn, missing } = this.select(visible, view, halfSpaces, share * this.budget);
    drawn.forEach((node) => {
      node.lastDrawn = this.frame;
      node.layer.show(node, true);
    });
    before.filter((node) => !node.isDrawn).forEach((node) => node.layer.show(node, false));
    visible.forEach((layer) => layer.root?.spread());
    this.request(layers, missing);
    this.evict(layers);
    this.report = {
      points: drawn.reduce((sum, node) => sum + node.info.count, 0),
      nodes: drawn.length,
      of: visible.reduce((sum, layer) => sum + layer.info.count, 0),
      loading: missing.length + layers.reduce((sum, layer) => sum + layer.loading, 0),
    };
  }

  private select(layers: PointLayer[], view: Viewpoint, halfSpaces: HalfSpace[], budget: number) {
    const heap = new Heap();
    const drawn: OctreeNode[] = [];
    const missing: OctreeNode[] = [];
    let points = 0;
    const consider = (node: OctreeNode) => {
      if (seesSphere(view, node.center, node.radius) && !isOutside(node, halfSpaces)) {
        heap.push({ node, urgency: urgencyOf(node, view) });
      }
    };
    layers.forEach((layer) => layer.root && consider(layer.root));
    for (let next = heap.pop(); next !== null; next = heap.pop()) {
      const { node } = next;
      const isTooMuch = points > 0 && points + node.info.count > budget;
      if (isTooMuch || drawn.length + missing.length >= MOST_NODES) {
        break;
      }
      points += node.info.count;
      if (node.state === 'loaded') {
        drawn.push(node);
        if (spacingOnPicture(node, view) > FINEST) {
          node.children.forEach(consider);
        }
      } else if (node.state === 'absent') {
        missing.push(node);
      }
    }
    return { drawn, missing };
  }

  private request(layers: PointLayer[], missing: OctreeNode[]): void {
    const free = PARALLEL_LOADS - layers.reduce((sum, layer) => sum + layer.loading, 0);
    missing.slice(0, Math.max(0, free)).forEach((node) => void node.layer.loadNode(node));
  }

  /** Forgets what was not drawn for the longest time. */
  private evict(layers: PointLayer[]): void {
    const loaded = layers.flatMap((layer) => layer.loaded);
    let points = loaded.reduce((sum, node) => sum + node.info.count, 0);
    if (points <= KEPT * this.budget) {
      return;
    }
    const idle = loaded.filter((node) => !node.isDrawn);
    idle.sort((a, b) => a.lastDrawn - b.lastDrawn || b.depth - a.depth);
    for (const node of idle) {
      if (points <= KEPT * this.budget) {
        return;
      }
      points -= node.info.count;
      node.layer.unload(node);
    }
  }
}

/** Pixels between neighbouring points, where the node is nearest to the camera. */
function spacingOnPicture(node: OctreeNode, view: Viewpoint): number {
  return node.info.spacing * pixelsAt(view, depthOf(view, node.center) - node.radius);
}

/** What is large on the picture and near to its middle comes first. */
function urgencyOf(node: OctreeNode, view: Viewpoint): number {
  const place = project(view, node.center);
  const aside = place ? Math.hypot(place[0] / view.width - 0.5, place[1] / view.height - 0.5) : 1;
  return spacingOnPicture(node, view) / (1 + Math.min(1, aside));
}

function isOutside(node: OctreeNode, halfSpaces: HalfSpace[]): boolean {
  return halfSpaces.some(({ normal, offset }) => dot(normal, node.center) + offset < -node.radius);
}

/** The most urgent first. */
class Heap {
  private readonly items: Wanted[] = [];

  push(item: Wanted): void {
    const { items } = this;
    let place = items.push(item) - 1;
    while (place > 0) {
      const parent = (place - 1) >> 1;
      if (items[parent].urgency >= item.urgency) {
        break;
      }
      items[place] = items[parent];
      place = parent;
    }
    items[place] = item;
  }

  pop(): Wanted | null {
    const { items } = this;
    const first = items[0];
    const last = items.pop();
    if (first === undefined || last === undefined) {
      return null;
    }
    if (items.length > 0) {
      let place = 0;
      for (;;) {
        let child = 2 * place + 1;
        if (child >= items.length) {
          break;
        }
        if (child + 1 < items.length && items[child + 1].urgency > items[child].urgency) {
          child += 1;
        }
        if (items[child].urgency <= last.urgency) {
          break;
        }
        items[place] = items[child];
        place = child;
      }
      items[place] = last;
    }
    return first;
  }
}
