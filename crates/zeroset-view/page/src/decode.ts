/** The binary answers of the server: little endian, every array padded to a multiple of 4 bytes. */

import type { Channel } from './protocol';

/** One array per channel of the layer, in their order; `null` for a channel that follows from the positions. */
export type ChannelArrays = (Uint16Array | Uint8Array | Uint32Array | null)[];

export interface NodeData {
  count: number;
  /** Three codes a point: position = low + side * code / 65535. */
  positions: Uint16Array;
  channels: ChannelArrays;
}

export interface MeshData {
  vertices: number;
  /** Three coordinates a vertex, local. */
  positions: Float32Array;
  /** Three numbers of vertices a triangle, or two a line. */
  indices: Uint32Array;
  channels: ChannelArrays;
}

/** The bytes are not what the protocol says. */
export class Malformed extends Error {}

/** A code that stands for "no value". */
export const NO_VALUE_CODE = 65535;
/** The number of the plane of what lies on none. */
export const NO_PLANE = 0xffffffff;
const LAST_CODE = 65534;

type ArrayType<T> = { new (buffer: ArrayBuffer, offset: number, length: number): T; BYTES_PER_ELEMENT: number };

class Reader {
  private at = 0;

  constructor(private readonly buffer: ArrayBuffer) {}

  magic(expected: string): void {
    const found = String.fromCharCode(...this.take(Uint8Array, 4));
    if (found !== expected) {
      throw new Malformed(`expected ${expected}, found ${JSON.stringify(found)}`);
    }
  }

  number(): number {
    return this.take(Uint32Array, 1)[0];
  }

  take<T>(type: ArrayType<T>, length: number): T {
    const bytes = length * type.BYTES_PER_ELEMENT;
    if (this.at + bytes > this.buffer.byteLength) {
      throw new Malformed(`${this.buffer.byteLength} bytes are too few`);
    }
    const array = new type(this.buffer, this.at, length);
    this.at += Math.ceil(bytes / 4) * 4;
    return array;
  }

  channels(channels: Channel[], count: number): ChannelArrays {
    return channels.map((channel) => {
      switch (channel.kind) {
        case 'value':
          return channel.source === 'data' ? this.take(Uint16Array, count) : null;
        case 'class':
          return this.take(Uint8Array, count);
        case 'color':
          return this.take(Uint8Array, 3 * count);
        case 'plane':
          return this.take(Uint32Array, count);
      }
    });
  }

  end(): void {
    if (this.at < this.buffer.byteLength) {
      throw new Malformed(`${this.buffer.byteLength - this.at} bytes too many`);
    }
  }
}

export function decodeNode(buffer: ArrayBuffer, channels: Channel[]): NodeData {
  const reader = new Reader(buffer);
  reader.magic('ZSN1');
  const count = reader.number();
  const positions = reader.take(Uint16Array, 3 * count);
  const data = { count, positions, channels: reader.channels(channels, count) };
  reader.end();
  return data;
}

/** `corners`: 3 for triangles, 2 for lines. */
export function decodeMesh(buffer: ArrayBuffer, corners: 2 | 3, channels: Channel[]): MeshData {
  const reader = new Reader(buffer);
  reader.magic('ZSM1');
  const vertices = reader.number();
  const items = reader.number();
  const positions = reader.take(Float32Array, 3 * vertices);
  const indices = reader.take(Uint32Array, corners * items);
  for (const index of indices) {
    if (index >= vertices) {
      throw new Malformed(`vertex ${index} of ${vertices}`);
    }
  }
  const data = { vertices, positions, indices, channels: reader.channels(channels, vertices) };
  reader.end();
  return data;
}

/** The value of a code, or `null` if it has none. */
export function valueOfCode(code: number, from: number, to: number): number | null {
  return code === NO_VALUE_CODE ? null : from + ((to - from) * code) / LAST_CODE;
}
