/** What a click does: look, measure, or draw a section. */

import type { Vec3 } from '../protocol';
import type { WorldFrame } from '../scene/frame';
import { Signal } from '../signal';
import type { Measure, MeasureKind } from './measure';

export const TOOLS = ['inspect', 'distance', 'angle', 'section'] as const;
export type Tool = (typeof TOOLS)[number];

export class Toolbox {
  readonly changed = new Signal();
  /** Both ends of a section, local. */
  readonly sectionDrawn = new Signal<[Vec3, Vec3]>();
  tool: Tool = 'inspect';
  measures: Measure[] = [];
  /** The measure that is being drawn; the last of `measures`. */
  draft: Measure | null = null;
  /** The first end of the section that is being drawn, local. */
  sectionStart: Vec3 | null = null;
  private drawn = 0;

  /** Chooses a tool, and finishes what another one has begun. */
  choose(tool: Tool): void {
    this.finish();
    this.tool = tool;
    this.changed.emit();
  }

  /** A position for the present tool. */
  take(local: Vec3, frame: WorldFrame): void {
    if (this.tool === 'section') {
      this.takeSectionEnd(local);
    } else if (this.tool !== 'inspect') {
      this.takeMeasured(this.tool, frame.world(local));
    }
  }

  private takeSectionEnd(local: Vec3): void {
    if (this.sectionStart) {
      const ends: [Vec3, Vec3] = [this.sectionStart, local];
      this.choose('inspect');
      this.sectionDrawn.emit(ends);
    } else {
      this.sectionStart = local;
      this.changed.emit();
    }
  }

  private takeMeasured(kind: MeasureKind, world: Vec3): void {
    if (!this.draft) {
      this.drawn += 1;
      this.draft = { number: this.drawn, kind, points: [] };
      this.measures.push(this.draft);
    }
    this.draft.points.push(world);
    if (kind === 'angle' && this.draft.points.length === 3) {
      this.draft = null;
    }
    this.changed.emit();
  }

  /** Ends the present measure; one with too few points goes. */
  finish(): void {
    const { draft } = this;
    if (draft && draft.points.length < (draft.kind === 'angle' ? 3 : 2)) {
      this.measures.pop();
    }
    this.draft = null;
    this.sectionStart = null;
    this.changed.emit();
  }

  /** Takes back the last position. */
  undo(): void {
    this.sectionStart = null;
    if (this.draft) {
      this.draft.points.pop();
      if (this.draft.points.length === 0) {
        this.finish();
      }
    }
    this.changed.emit();
  }

  remove(measure: Measure): void {
    this.measures = this.measures.filter((other) => other !== measure);
    if (this.draft === measure) {
      this.draft = null;
    }
    this.changed.emit();
  }

  /** Forgets all positions. */
  clear(): void {
    this.measures = [];
    this.draft = null;
    this.sectionStart = null;
    this.changed.emit();
  }

  /** What a click does now, in a few words. */
  get hint(): string {
    const placed = this.draft?.points.length ?? 0;
    switch (this.tool) {
      case 'inspect':
        return '';
      case 'distance':
        return placed === 0 ? 'Click the first point.' : 'Click the next point; Enter ends, Backspace takes back.';
      case 'angle':
        return ['Click a point on the first leg.', 'Click the corner.', 'Click a point on the second leg.'][placed];
      case 'section':
        return this.sectionStart ? 'Click the end of the section.' : 'Click the start of the section.';
    }
  }
}
