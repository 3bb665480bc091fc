/** An upright slab along a line in plan: only what lies in it is seen. */

import type { Vec3 } from '../protocol';
import type { WorldFrame } from '../scene/frame';
import type { HalfSpace } from '../scene/materials';
import { Signal } from '../signal';
import { add, boxAround, cornersOf, cross, dot, normalized, scale, subtract, type Box } from '../vector';

/** The thickness at first, as a share of the length of the line. */
const THICKNESS_REL = 0.05;

export interface SectionLine {
  /** Local. */
  from: Vec3;
  to: Vec3;
}

export class Section {
  readonly changed = new Signal();
  line: SectionLine | null = null;
  thickness = 1;

  constructor(private frame: WorldFrame) {}

  setFrame(frame: WorldFrame): void {
    this.frame = frame;
    this.setLine(null);
  }

  /** Lines that stand upright have no direction in plan, and are refused. */
  setLine(line: SectionLine | null): boolean {
    if (line !== null) {
      const length = this.lengthOf(line);
      if (length === 0) {
        return false;
      }
      this.thickness = Number((THICKNESS_REL * length).toPrecision(1));
    }
    this.line = line;
    this.changed.emit();
    return true;
  }

  setThickness(thickness: number): void {
    if (thickness > 0) {
      this.thickness = thickness;
      this.changed.emit();
    }
  }

  get length(): number {
    return this.line ? this.lengthOf(this.line) : 0;
  }

  /** Where to stand, as radians to the east of north, to see the line run from left to right. */
  get azimuth(): number {
    const [east, north] = this.frame.upright(this.along());
    return Math.atan2(north, -east);
  }

  halfSpaces(): HalfSpace[] {
    if (!this.line) {
      return [];
    }
    const { from, to } = this.line;
    const along = this.along();
    const across = cross(this.frame.sky, along);
    const half = this.thickness / 2;
    return [
      { normal: along, offset: -dot(along, from) },
      { normal: scale(along, -1), offset: dot(along, to) },
      { normal: across, offset: half - dot(across, from) },
      { normal: scale(across, -1), offset: half + dot(across, from) },
    ];
  }

  /** The slab within a box. */
  within(box: Box): Box {
    const { from, to } = this.line as SectionLine;
    const { sky } = this.frame;
    const heights = cornersOf(box).map((corner) => dot(sky, corner));
    const ends = [from, to].flatMap((end) =>
      [Math.min(...heights), Math.max(...heights)].map((height) => add(end, scale(sky, height - dot(sky, end)))),
    );
    return boxAround(ends.map((end) => ({ low: end, high: end }))) as Box;
  }

  private along(): Vec3 {
    const { from, to } = this.line as SectionLine;
    return normalized(this.inPlan(subtract(to, from)));
  }

  private inPlan(vector: Vec3): Vec3 {
    const [east, north] = this.frame.upright(vector);
    return this.frame.restored([east, north, 0]);
  }

  private lengthOf({ from, to }: SectionLine): number {
    return Math.hypot(...this.inPlan(subtract(to, from)));
  }
}
