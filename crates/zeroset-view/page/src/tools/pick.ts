/** What is at a place of the picture, and what is known about it. */

import { NO_PLANE, valueOfCode } from '../decode';
import { formatDegrees, formatValue, withUnit } from '../format';
import type { Channel, PlaneInfo, Rgb, SceneInfo, Vec3 } from '../protocol';
import type { WorldFrame } from '../scene/frame';
import type { Found, SceneLayer, Search } from '../scene/layer';

/** Something known about a position. */
export interface Reading {
  title: string;
  text: string;
  color?: Rgb;
}

export interface Picked {
  layer: string;
  /** Local. */
  position: Vec3;
  world: Vec3;
  readings: Reading[];
  plane: { number: number; readings: Reading[] } | null;
}

/** The first thing on the ray; points and lines go before a surface that they lie on. */
export function findFirst(layers: SceneLayer[], search: Search, tolerance: number): Found | null {
  const nearness = (found: Found) =>
    found.distance - (found.layer.info.kind === 'points' || found.layer.info.kind === 'lines' ? tolerance : 0);
  let best: Found | null = null;
  for (const layer of layers) {
    const found = layer.isVisible ? layer.find(search) : null;
    if (found && (!best || nearness(found) < nearness(best))) {
      best = found;
    }
  }
  return best;
}

export function describe(found: Found, scene: SceneInfo, frame: WorldFrame): Picked {
  const { info } = found.layer;
  const readings: Reading[] = [];
  let plane: Picked['plane'] = null;
  info.channels.forEach((channel, place) => {
    const number = channel.kind === 'plane' ? planeOf(found, place) : null;
    const known = number === null ? undefined : scene.planes[number];
    if (number !== null && known) {
      plane = { number, readings: readPlane(known, frame, scene.unit) };
    }
    const reading = read(channel, found, place);
    if (reading) {
      readings.push({ title: channel.title, ...reading });
    }
  });
  return { layer: info.name, position: found.position, world: frame.world(found.position), readings, plane };
}

function planeOf(found: Found, place: number): number | null {
  const number = found.channels[place]?.[found.corners[0].index];
  return number === undefined || number === NO_PLANE ? null : number;
}

/** Heights are not read: they are among the coordinates. */
function read(channel: Channel, found: Found, place: number): Omit<Reading, 'title'> | null {
  const codes = found.channels[place];
  if (!codes) {
    return null;
  }
  const nearest = found.corners[0].index;
  switch (channel.kind) {
    case 'value': {
      const value = meanOf(channel.from ?? 0, channel.to ?? 1, found, codes);
      return { text: value === null ? 'no value' : formatValue(value) };
    }
    case 'class': {
      const entry = channel.entries.find(({ value }) => value === codes[nearest]);
      return entry ? { text: entry.name, color: entry.color } : { text: String(codes[nearest]) };
    }
    case 'color': {
      const color: Rgb = [codes[3 * nearest], codes[3 * nearest + 1], codes[3 * nearest + 2]];
      return { text: color.join(' '), color };
    }
    case 'plane':
      return planeOf(found, place) === null ? { text: 'none' } : null;
  }
}

/** Between corners that have a value, the value in between. */
function meanOf(from: number, to: number, found: Found, codes: ArrayLike<number>): number | null {
  let sum = 0;
  for (const { index, share } of found.corners) {
    const value = valueOfCode(codes[index], from, to);
    if (value === null) {
      return valueOfCode(codes[found.corners[0].index], from, to);
    }
    sum += share * value;
  }
  return sum;
}

/** Below this slope, in degrees, a plane is level and looks nowhere. */
const LEVEL = 0.05;

/** The slope of a plane, and where it looks: degrees above the horizon and to the east of north; the strike is to the left of the aspect. */
export function orientationOf(normal: Vec3, frame: WorldFrame): { slope: number; aspect: number | null; strike: number | null } {
  const [east, north, up] = frame.upright(normal);
  const degrees = 180 / Math.PI;
  const slope = Math.atan2(Math.hypot(east, north), Math.abs(up)) * degrees;
  if (slope < LEVEL) {
    return { slope, aspect: null, strike: null };
  }
  const side = up < 0 ? -1 : 1;
  const aspect = (Math.atan2(side * east, side * north) * degrees + 360) % 360;
  return { slope, aspect, strike: (aspect + 270) % 360 };
}

function readPlane(plane: PlaneInfo, frame: WorldFrame, unit: string | null): Reading[] {
  const { slope, aspect, strike } = orientationOf(plane.normal, frame);
  return [
    { title: 'normal', text: plane.normal.map((c) => c.toFixed(4)).join('  ') },
    { title: 'slope', text: formatDegrees(slope) },
    { title: 'aspect', text: aspect === null ? 'level' : formatDegrees(aspect) },
    { title: 'strike', text: strike === null ? 'level' : formatDegrees(strike) },
    { title: 'offset', text: withUnit(plane.offset.toFixed(3), unit) },
    { title: 'area', text: withUnit(formatValue(plane.area), unit === null ? null : `${unit}²`) },
    { title: 'rms', text: plane.rms === null ? 'unknown' : withUnit(formatValue(plane.rms), unit) },
    { title: 'points', text: String(plane.points) },
  ];
}
