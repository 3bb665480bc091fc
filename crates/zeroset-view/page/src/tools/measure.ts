/** Distances and angles between picked positions, in world coordinates. */

import { formatDegrees, formatLength, withUnit } from '../format';
import type { Vec3 } from '../protocol';
import type { WorldFrame } from '../scene/frame';
import { distance, dot, normalized, subtract } from '../vector';

export type MeasureKind = 'distance' | 'angle';

export interface Measure {
  number: number;
  kind: MeasureKind;
  /** In world coordinates. */
  points: Vec3[];
}

export interface Leg {
  length: number;
  horizontal: number;
  /** Upwards positive. */
  rise: number;
}

export function legsOf(measure: Measure, frame: WorldFrame): Leg[] {
  return measure.points.slice(1).map((to, i) => {
    const [east, north, rise] = frame.upright(subtract(to, measure.points[i]));
    return { length: distance(to, measure.points[i]), horizontal: Math.hypot(east, north), rise };
  });
}

export function sumOf(legs: Leg[]): Leg {
  const sum = (of: (leg: Leg) => number) => legs.reduce((total, leg) => total + of(leg), 0);
  return { length: sum((leg) => leg.length), horizontal: sum((leg) => leg.horizontal), rise: sum((leg) => leg.rise) };
}

/** Degrees at the second of three points; `null` before there are three, or if two are the same. */
export function angleOf({ points }: Measure): number | null {
  if (points.length < 3) {
    return null;
  }
  const [a, b] = [points[0], points[2]].map((end) => normalized(subtract(end, points[1])));
  const size = Math.hypot(...a) * Math.hypot(...b);
  return size === 0 ? null : (Math.acos(Math.max(-1, Math.min(1, dot(a, b)))) * 180) / Math.PI;
}

/** The result in a few words. */
export function headline(measure: Measure, frame: WorldFrame, unit: string | null): string {
  if (measure.kind === 'angle') {
    const angle = angleOf(measure);
    return angle === null ? '–' : formatDegrees(angle);
  }
  return withUnit(formatLength(sumOf(legsOf(measure, frame)).length), unit);
}

/** The whole measure as lines of columns with tabs between them, for a table elsewhere. */
export function asTable(measure: Measure, frame: WorldFrame, unit: string | null): string {
  const rows = [['point', 'x', 'y', 'z'], ...measure.points.map((p, i) => [String(i + 1), ...p.map(formatLength)])];
  if (measure.kind === 'angle') {
    rows.push(['angle', headline(measure, frame, unit)]);
  } else {
    const row = (name: string, leg: Leg) => [name, ...[leg.length, leg.horizontal, leg.rise].map(formatLength)];
    const legs = legsOf(measure, frame);
    rows.push(['leg', 'length', 'horizontal', 'height'], ...legs.map((leg, i) => row(`${i + 1}-${i + 2}`, leg)));
    rows.push(row('total', sumOf(legs)));
  }
  return rows.map((row) => row.join('\t')).join('\n');
}
