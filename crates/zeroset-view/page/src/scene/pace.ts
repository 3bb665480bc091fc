/** While the camera moves, fewer points are drawn where all of them would take too long. */

/** Milliseconds without motion after which everything is drawn again. */
const REST = 200;
/** A frame that waits longer than this is too slow, and one that waits less than the other leaves time for more: milliseconds. */
const TOO_LONG = 50;
const SHORT = 25;
const LESS = 0.7;
const MORE = 1.15;
/** Below this share of the points a scene would be hard to know again. */
const LEAST = 0.05;

export class Pace {
  private share = 1;
  private movedAt = -Infinity;
  private timer: number | undefined;

  /** `rested` asks for a frame with all points. */
  constructor(private readonly rested: () => void) {}

  /** The camera moved. */
  move(): void {
    this.movedAt = performance.now();
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.share < 1 && this.rested(), REST);
  }

  /** The share of the points for a frame that was asked for so many milliseconds ago. */
  shareOf(waited: number): number {
    if (performance.now() - this.movedAt >= REST) {
      return 1;
    }
    if (waited > TOO_LONG) {
      this.share = Math.max(LEAST, this.share * LESS);
    } else if (waited < SHORT) {
      this.share = Math.min(1, this.share * MORE);
    }
    return this.share;
  }
}
