/** From the channels of a layer to the colours of its points or vertices. */

import { NO_PLANE, NO_VALUE_CODE, valueOfCode, type ChannelArrays } from '../decode';
import type { Channel, LayerInfo, PlaneInfo, Rgb } from '../protocol';
import { NO_VALUE_COLOR, Scale } from './colors';
import type { WorldFrame } from './frame';

/** What is to be painted. */
export interface Painted {
  count: number;
  channels: ChannelArrays;
  /** One coordinate of a position, local. */
  coordinate(index: number, axis: number): number;
}

/** What the colours of all layers depend on. */
export interface PaintContext {
  frame: WorldFrame;
  planes: PlaneInfo[];
}

/** Red, green, blue and 255 for each position. `color` is the name of a channel, or `null` for the layer's plain colour. */
export function paint(layer: LayerInfo, color: string | null, painted: Painted, context: PaintContext): Uint8Array {
  const colors = new Uint8Array(4 * painted.count).fill(255);
  const place = layer.channels.findIndex((channel) => channel.name === color);
  if (place < 0) {
    for (let i = 0; i < painted.count; i++) {
      put(colors, i, layer.plain);
    }
  } else {
    paintChannel(colors, layer.channels[place], painted, painted.channels[place], context);
  }
  return colors;
}

function put(colors: Uint8Array, index: number, color: Rgb): void {
  colors[4 * index] = color[0];
  colors[4 * index + 1] = color[1];
  colors[4 * index + 2] = color[2];
}

function paintChannel(
  colors: Uint8Array,
  channel: Channel,
  painted: Painted,
  codes: ChannelArrays[number],
  { frame, planes }: PaintContext,
): void {
  const { count } = painted;
  switch (channel.kind) {
    case 'value': {
      const scale = new Scale(channel.low, channel.high, channel.signed);
      if (codes === null) {
        const { axis, sign, shift } = frame.height();
        for (let i = 0; i < count; i++) {
          scale.write(shift + sign * painted.coordinate(i, axis), colors, 4 * i);
        }
        return;
      }
      for (let i = 0; i < count; i++) {
        if (codes[i] === NO_VALUE_CODE) {
          put(colors, i, NO_VALUE_COLOR);
        } else {
          scale.write(valueOfCode(codes[i], channel.from ?? 0, channel.to ?? 1) as number, colors, 4 * i);
        }
      }
      return;
    }
    case 'class': {
      const byValue = new Map(channel.entries.map((entry) => [entry.value, entry.color]));
      for (let i = 0; i < count; i++) {
        put(colors, i, byValue.get((codes as Uint8Array)[i]) ?? NO_VALUE_COLOR);
      }
      return;
    }
    case 'color':
      for (let i = 0; i < count; i++) {
        colors.set((codes as Uint8Array).subarray(3 * i, 3 * i + 3), 4 * i);
      }
      return;
    case 'plane':
      for (let i = 0; i < count; i++) {
        const plane = (codes as Uint32Array)[i];
        put(colors, i, (plane === NO_PLANE ? undefined : planes[plane]?.color) ?? NO_VALUE_COLOR);
      }
  }
}
