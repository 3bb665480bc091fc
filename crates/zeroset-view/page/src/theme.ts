/** Light or dark: as the system says, until the user says otherwise. */

import type { Rgb } from './protocol';
import { Signal } from './signal';

export class Theme {
  readonly changed = new Signal();
  ink = '';
  paper = '';
  accent = '';
  /** The background of the picture. */
  stage: Rgb = [255, 255, 255];
  private readonly system = window.matchMedia('(prefers-color-scheme: dark)');

  /** `sample` is an element whose style shows the colours: see `.stage` in the style sheet. */
  constructor(private readonly sample: HTMLElement) {
    this.system.addEventListener('change', () => this.read());
    this.read();
  }

  get isDark(): boolean {
    const chosen = document.documentElement.dataset.theme;
    return chosen ? chosen === 'dark' : this.system.matches;
  }

  toggle(): void {
    document.documentElement.dataset.theme = this.isDark ? 'light' : 'dark';
    this.read();
  }

  private read(): void {
    const style = getComputedStyle(this.sample);
    this.ink = style.color;
    this.paper = style.borderTopColor;
    this.accent = style.outlineColor;
    this.stage = (style.backgroundColor.match(/\d+/g) ?? []).slice(0, 3).map(Number) as Rgb;
    this.changed.emit();
  }
}
