/** Which colour stands for what value. */

import type { Rgb } from '../protocol';

/** What has no value. */
export const NO_VALUE_COLOR: Rgb = [150, 150, 150];

/** Viridis: dark blue to yellow, alike to all eyes. */
const VIRIDIS = [0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725];
/** Blue below, white at the middle, red above: for values with a sign. */
const BLUE_RED = [
  0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b, 0x67001f,
];

const STEPS = 256;

function table(anchors: number[]): Uint8Array {
  const colors = new Uint8Array(3 * STEPS);
  for (let step = 0; step < STEPS; step++) {
    const place = (step / (STEPS - 1)) * (anchors.length - 1);
    const first = Math.min(Math.floor(place), anchors.length - 2);
    const share = place - first;
    for (let channel = 0; channel < 3; channel++) {
      const shift = 16 - 8 * channel;
      const from = (anchors[first] >> shift) & 255;
      const to = (anchors[first + 1] >> shift) & 255;
      colors[3 * step + channel] = Math.round(from + share * (to - from));
    }
  }
  return colors;
}

const TABLES = { plain: table(VIRIDIS), signed: table(BLUE_RED) };

/** From values to colours; what lies beyond the ends gets their colours. */
export class Scale {
  private readonly colors: Uint8Array;

  constructor(
    readonly low: number,
    readonly high: number,
    signed: boolean,
  ) {
    this.colors = signed ? TABLES.signed : TABLES.plain;
  }

  /** Writes the colour of a value. */
  write(value: number, into: Uint8Array, at: number): void {
    const share = (value - this.low) / (this.high - this.low || 1);
    const step = 3 * Math.round(Math.min(1, Math.max(0, share)) * (STEPS - 1));
    into[at] = this.colors[step];
    into[at + 1] = this.colors[step + 1];
    into[at + 2] = this.colors[step + 2];
  }

  at(value: number): Rgb {
    const color = new Uint8Array(3);
    this.write(value, color, 0);
    return [color[0], color[1], color[2]];
  }

  /** Round values along the scale, at most about `most`. */
  ticks(most: number): number[] {
    const width = this.high - this.low;
    if (!(width > 0) || !Number.isFinite(width)) {
      return [this.low];
    }
    const power = 10 ** Math.floor(Math.log10(width / most));
    const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => width / size <= most) ?? width;
    const first = Math.ceil(this.low / step - 1e-9);
    const last = Math.floor(this.high / step + 1e-9);
    return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
  }
}

export const cssColor = ([r, g, b]: Rgb): string => `rgb(${r} ${g} ${b})`;
