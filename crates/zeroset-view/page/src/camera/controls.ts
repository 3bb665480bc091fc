/** Mouse, touch and pen: drag turns, the right button or Shift pans, the wheel zooms towards what is under the cursor. */

import type { Vec3 } from '../protocol';
import { Signal } from '../signal';
import type { OrbitCamera } from './orbit';

export type Place = [number, number];

/** Radians for a pixel. */
const TURN = 0.006;
/** A press that moves no farther than so many pixels is a click. */
const CLICK_REACH = 4;
/** Milliseconds after which the wheel looks anew for what is under the cursor. */
const WHEEL_PAUSE = 300;
/** Logarithm of the zoom for a pixel of the wheel. */
const WHEEL_ZOOM = 0.0016;
/** Two clicks within so many milliseconds are a double click, and the second is not a click of its own. */
const DOUBLE_CLICK = 350;

interface Pressed {
  at: Place;
  button: number;
}

export class Controls {
  readonly clicked = new Signal<Place>();
  readonly doubleClicked = new Signal<Place>();
  /** The cursor moved without a button; `null`: it left. */
  readonly hovered = new Signal<Place | null>();
  private readonly pressed = new Map<number, Pressed>();
  private travelled = 0;
  private lastClick: { time: number; at: Place } | null = null;
  private wheel: { time: number; at: Place; anchor: Vec3 | null } | null = null;

  constructor(
    private readonly element: HTMLElement,
    private readonly camera: OrbitCamera,
    /** What is at a place of the picture. */
    private readonly positionAt: (at: Place) => Vec3 | null,
  ) {
    element.addEventListener('pointerdown', this.press);
    element.addEventListener('pointermove', this.move);
    element.addEventListener('pointerup', this.release);
    element.addEventListener('pointercancel', (event) => this.pressed.delete(event.pointerId));
    element.addEventListener('pointerleave', () => this.hovered.emit(null));
    element.addEventListener('wheel', this.roll, { passive: false });
    element.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  private place(event: MouseEvent): Place {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  private readonly press = (event: PointerEvent): void => {
    if (this.pressed.size === 0) {
      this.travelled = 0;
    }
    this.pressed.set(event.pointerId, { at: this.place(event), button: event.button });
    this.element.setPointerCapture(event.pointerId);
  };

  private readonly move = (event: PointerEvent): void => {
    const own = this.pressed.get(event.pointerId);
    const at = this.place(event);
    if (!own) {
      this.hovered.emit(at);
      return;
    }
    const [right, down] = [at[0] - own.at[0], at[1] - own.at[1]];
    this.travelled += Math.hypot(right, down);
    if (this.travelled > CLICK_REACH) {
      if (this.pressed.size > 1) {
        this.pinch(event.pointerId, own.at, at);
      } else if (own.button !== 0 || event.shiftKey || event.ctrlKey || event.metaKey) {
        this.camera.pan(right, down);
      } else {
        this.camera.orbit(right * TURN, down * TURN);
      }
    }
    own.at = at;
  };

  /** Of two fingers one moved: their distance zooms, their middle pans. */
  private pinch(moved: number, from: Place, to: Place): void {
    const other = [...this.pressed].find(([id]) => id !== moved)?.[1].at;
    if (!other) {
      return;
    }
    const gap = (place: Place) => Math.max(1, Math.hypot(place[0] - other[0], place[1] - other[1]));
    this.camera.zoom(gap(from) / gap(to), null);
    this.camera.pan((to[0] - from[0]) / 2, (to[1] - from[1]) / 2);
  }

  private readonly release = (event: PointerEvent): void => {
    const own = this.pressed.get(event.pointerId);
    this.pressed.delete(event.pointerId);
    if (!own || own.button !== 0 || this.travelled > CLICK_REACH) {
      return;
    }
    const at = this.place(event);
    const last = this.lastClick;
    const isDouble =
      last !== null &&
      event.timeStamp - last.time < DOUBLE_CLICK &&
      Math.hypot(at[0] - last.at[0], at[1] - last.at[1]) <= CLICK_REACH;
    this.lastClick = isDouble ? null : { time: event.timeStamp, at };
    (isDouble ? this.doubleClicked : this.clicked).emit(at);
  };

  private readonly roll = (event: WheelEvent): void => {
    event.preventDefault();
    const at = this.place(event);
    const last = this.wheel;
    // While the wheel rolls on, the anchor stays: a new search at each step would let the zoom jump from thing to thing.
    const isSame =
      last !== null &&
      event.timeStamp - last.time < WHEEL_PAUSE &&
      Math.hypot(at[0] - last.at[0], at[1] - last.at[1]) <= CLICK_REACH;
    const anchor = isSame ? last.anchor : this.positionAt(at);
    this.wheel = { time: event.timeStamp, at, anchor };
    const pixels = event.deltaY * [1, 16, 100][event.deltaMode];
    this.camera.zoom(Math.exp(Math.max(-240, Math.min(240, pixels)) * WHEEL_ZOOM), anchor);
  };
}
