/** What the server sends: the types of its JSON, and how to ask for it. All addresses are relative, since the token is part of the page's own. */

export type Vec3 = [number, number, number];
export type Rgb = [number, number, number];
export type UpAxis = 'x' | 'y' | 'z' | '-x' | '-y' | '-z';
export type LayerKind = 'points' | 'surface' | 'lines' | 'planes';

interface ChannelBase {
  name: string;
  title: string;
}

/** Numbers on a scale of colours. Those of source `position` are not sent but follow from the positions. */
export interface ValueChannel extends ChannelBase {
  kind: 'value';
  low: number;
  high: number;
  signed: boolean;
  source: 'position' | 'data';
  /** The values of the first and the last code; only with source `data`. */
  from?: number;
  to?: number;
}

export interface ClassEntry {
  value: number;
  name: string;
  color: Rgb;
}

export interface ClassChannel extends ChannelBase {
  kind: 'class';
  entries: ClassEntry[];
}

export interface ColorChannel extends ChannelBase {
  kind: 'color';
}

export interface PlaneChannel extends ChannelBase {
  kind: 'plane';
}

export type Channel = ValueChannel | ClassChannel | ColorChannel | PlaneChannel;

export interface LayerInfo {
  id: number;
  name: string;
  kind: LayerKind;
  count: number;
  /** Lowest and highest corner, local. */
  bounds: [Vec3, Vec3];
  plain: Rgb;
  /** Drawn a little nearer than it is, for lines and corners that lie on a surface. */
  lifted: boolean;
  /** Pixels across a point; `null`: as large as the gaps between points. */
  diameter: number | null;
  channels: Channel[];
  /** Name of the channel shown at first; `null`: the plain colour. */
  color: string | null;
}

export interface PlaneInfo {
  normal: Vec3;
  /** In world coordinates: a point x of the plane has normal . x = offset. */
  offset: number;
  area: number;
  rms: number | null;
  points: number;
  color: Rgb;
}

export interface Work {
  what: string;
  /** From 0 to 1. */
  share: number;
}

export interface SceneInfo {
  zeroset: string;
  title: string;
  revision: number;
  work: Work | null;
  problems: string[];
  /** World position = origin + local position. */
  origin: Vec3;
  up: UpAxis;
  unit: string | null;
  crs: string | null;
  layers: LayerInfo[];
  planes: PlaneInfo[];
}

export interface NodeInfo {
  id: number;
  parent: number | null;
  /** Lowest corner of the node's cube, local. */
  low: Vec3;
  side: number;
  count: number;
  /** About the distance between neighbouring points of the node. */
  spacing: number;
}

/** The server refused, with a reason for the user. */
export class Refused extends Error {}

/** Nobody answers at the server's address. */
export class Unreachable extends Error {
  constructor() {
    super('The server does not answer. Is `zeroset view` still running?');
  }
}

async function ask(address: string, options: RequestInit = {}): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(address, { cache: 'no-store', ...options });
  } catch (error) {
    if (options.signal?.aborted) {
      throw error;
    }
    throw new Unreachable();
  }
  if (response.ok) {
    return response;
  }
  throw new Refused(await reasonOf(response));
}

async function reasonOf(response: Response): Promise<string> {
  try {
    const body = (await response.json()) as { error?: unknown };
    if (typeof body.error === 'string') {
      return body.error;
    }
  } catch {
    // Not JSON: the status has to do.
  }
  return `The server answered ${response.status} ${response.statusText}`.trim();
}

export async function fetchScene(): Promise<SceneInfo> {
  return (await ask('scene.json')).json() as Promise<SceneInfo>;
}

export async function fetchNodes(layer: number): Promise<NodeInfo[]> {
  const answer = (await (await ask(`layers/${layer}/nodes.json`)).json()) as { nodes: NodeInfo[] };
  return answer.nodes;
}

export async function fetchNode(layer: number, node: number, signal: AbortSignal): Promise<ArrayBuffer> {
  return (await ask(`layers/${layer}/nodes/${node}.bin`, { signal })).arrayBuffer();
}

export async function fetchMesh(layer: number, signal: AbortSignal): Promise<ArrayBuffer> {
  return (await ask(`layers/${layer}/mesh.bin`, { signal })).arrayBuffer();
}

/** Hands a file to the server, which reads it and then shows it as layers of the scene. */
export async function sendFile(file: File): Promise<void> {
  await ask(`files?name=${encodeURIComponent(file.name)}`, { method: 'POST', body: file });
}
