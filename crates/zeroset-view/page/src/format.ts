/** Numbers for people. */

import type { Vec3 } from './protocol';

/** A count of things: 849 k, 2.1 M. */
export function formatCount(count: number): string {
  if (count < 1000) {
    return String(count);
  }
  const [scaled, letter] = count < 999_500 ? [count / 1e3, 'k'] : [count / 1e6, 'M'];
  return `${scaled.toFixed(scaled < 10 ? 1 : 0)} ${letter}`;
}

/** A value with about four digits that matter. */
export function formatValue(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) {
    return value.toExponential(3);
  }
  return String(Number(value.toPrecision(size >= 1000 ? 6 : 4)));
}

/** A length or coordinate, to three decimals. */
export function formatLength(value: number): string {
  return value.toFixed(3);
}

export function formatPosition(position: Vec3): string {
  return position.map(formatLength).join('  ');
}

export function formatDegrees(degrees: number): string {
  return `${degrees.toFixed(1)}°`;
}

/** A short word after a number, if the unit is known. */
export function withUnit(text: string, unit: string | null): string {
  return unit ? `${text} ${unit}` : text;
}
