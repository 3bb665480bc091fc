/** Measures and marks, drawn over the picture. */

import type { Place } from '../camera/controls';
import { project, type Viewpoint } from '../camera/viewpoint';
import type { Vec3 } from '../protocol';
import type { Theme } from '../theme';

/** Positions in a row, with a label at the last one or at the middle of each leg. */
export interface Trace {
  /** Local. */
  points: Vec3[];
  /** One for each point, or '' for none. */
  pointLabels: string[];
  legLabels: string[];
  /** Ends at the cursor. */
  isOpen: boolean;
}

export interface Marks {
  traces: Trace[];
  picked: Vec3 | null;
  cursor: Place | null;
}

const FONT = '12px system-ui, sans-serif';
const DOT = 4;

export class Overlay {
  private readonly context: CanvasRenderingContext2D;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly theme: Theme,
  ) {
    this.context = canvas.getContext('2d') as CanvasRenderingContext2D;
  }

  draw(marks: Marks, view: Viewpoint): void {
    const { canvas, context } = this;
    const ratio = window.devicePixelRatio;
    const [width, height] = [Math.round(view.width * ratio), Math.round(view.height * ratio)];
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, view.width, view.height);
    context.font = FONT;
    context.lineJoin = 'round';
    for (const trace of marks.traces) {
      this.trace(trace, marks.cursor, view);
    }
    const picked = marks.picked ? project(view, marks.picked) : null;
    if (picked) {
      this.target(picked);
    }
  }

  private trace(trace: Trace, cursor: Place | null, view: Viewpoint): void {
    const places = trace.points.map((point) => project(view, point));
    places.slice(1).forEach((place, i) => this.line(places[i], place, false));
    const last = places.at(-1) ?? null;
    if (trace.isOpen && cursor) {
      this.line(last, cursor, true);
    }
    for (const place of places) {
      this.dot(place);
    }
    places.slice(1).forEach((place, i) => this.label(trace.legLabels[i], middle(places[i], place)));
    places.forEach((place, i) => this.label(trace.pointLabels[i], place && [place[0] + 14, place[1] - 14]));
  }

  private line(from: Place | null, to: Place | null, isDashed: boolean): void {
    if (!from || !to) {
      return;
    }
    const { context } = this;
    context.setLineDash(isDashed ? [5, 4] : []);
    // A seam in the colour of the paper, so that the line is seen on anything.
    for (const [color, width] of [[this.theme.paper, 4], [this.theme.accent, 2]] as const) {
      context.strokeStyle = color;
      context.lineWidth = width;
      context.beginPath();
      context.moveTo(...from);
      context.lineTo(...to);
      context.stroke();
    }
    context.setLineDash([]);
  }

  private dot(place: Place | null): void {
    if (!place) {
      return;
    }
    const { context } = this;
    context.beginPath();
    context.arc(...place, DOT, 0, 2 * Math.PI);
    context.fillStyle = this.theme.accent;
    context.fill();
    context.lineWidth = 1.5;
    context.strokeStyle = this.theme.paper;
    context.stroke();
  }

  private target(place: Place): void {
    const { context } = this;
    for (const [color, width] of [[this.theme.paper, 4], [this.theme.accent, 2]] as const) {
      context.strokeStyle = color;
      context.lineWidth = width;
      context.beginPath();
      context.arc(...place, 7, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  private label(text: string | undefined, place: Place | null): void {
    if (!text || !place) {
      return;
    }
    const { context } = this;
    const width = context.measureText(text).width + 10;
    context.beginPath();
    context.roundRect(place[0] - width / 2, place[1] - 9, width, 18, 4);
    context.fillStyle = this.theme.paper;
    context.fill();
    context.lineWidth = 1;
    context.strokeStyle = this.theme.accent;
    context.stroke();
    context.fillStyle = this.theme.ink;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(text, place[0], place[1] + 0.5);
  }
}

function middle(a: Place | null, b: Place | null): Place | null {
  return a && b ? [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] : null;
}
