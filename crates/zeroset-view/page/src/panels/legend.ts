/** What the colours of the active layer stand for. Drawn, not built of elements, so that a saved picture shows the same. */

import { formatValue } from '../format';
import type { Channel, Rgb } from '../protocol';
import { cssColor, NO_VALUE_COLOR, Scale } from '../scene/colors';
import type { Theme } from '../theme';
import type { Viewer } from '../viewer';
import { make } from './dom';

const WIDTH = 148;
const PADDING = 10;
const LINE = 18;
const BAR_WIDTH = 14;
const BAR_HEIGHT = 150;
const MOST_TICKS = 6;
const MOST_NAMES = 14;
const FONT = '12px system-ui, sans-serif';
const TITLE_FONT = '600 12px system-ui, sans-serif';

interface Legend {
  title: string;
  scale?: Scale;
  names: { name: string; color: Rgb }[];
}

function legendOf(viewer: Viewer): Legend | null {
  const layer = viewer.active;
  const channel = layer?.isVisible ? layer.info.channels.find(({ name }) => name === layer.color) : undefined;
  return channel ? legendOfChannel(channel, viewer) : null;
}

function legendOfChannel(channel: Channel, viewer: Viewer): Legend | null {
  const { title } = channel;
  switch (channel.kind) {
    case 'value':
      return { title, scale: new Scale(channel.low, channel.high, channel.signed), names: [] };
    case 'class': {
      const names = channel.entries.slice(0, MOST_NAMES).map(({ name, color }) => ({ name, color }));
      const rest = channel.entries.length - names.length;
      return { title, names: rest > 0 ? [...names, { name: `and ${rest} more`, color: NO_VALUE_COLOR }] : names };
    }
    case 'plane':
      return { title: `${viewer.scene.planes.length} planes, a colour each`, names: [{ name: 'no plane', color: NO_VALUE_COLOR }] };
    case 'color':
      return null;
  }
}

function heightOf(legend: Legend): number {
  return 2 * PADDING + LINE + (legend.scale ? BAR_HEIGHT + LINE / 2 : legend.names.length * LINE);
}

function drawLegend(context: CanvasRenderingContext2D, legend: Legend, theme: Theme): void {
  const height = heightOf(legend);
  context.beginPath();
  context.roundRect(0.5, 0.5, WIDTH - 1, height - 1, 6);
  context.fillStyle = theme.paper;
  context.fill();
  context.fillStyle = theme.ink;
  context.textBaseline = 'middle';
  context.textAlign = 'left';
  context.font = TITLE_FONT;
  const widest = WIDTH - 2 * PADDING;
  context.fillText(legend.title, PADDING, PADDING + LINE / 2 - 2, widest);
  context.font = FONT;
  const top = PADDING + LINE + 4;
  if (legend.scale) {
    drawBar(context, legend.scale, top, theme.ink);
  }
  legend.names.forEach(({ name, color }, i) => {
    const middle = PADDING + LINE * (i + 1.5);
    context.fillStyle = cssColor(color);
    context.fillRect(PADDING, middle - 5, 12, 10);
    context.fillStyle = theme.ink;
    context.fillText(name, PADDING + 20, middle, widest - 20);
  });
}

function drawBar(context: CanvasRenderingContext2D, scale: Scale, top: number, ink: string): void {
  const { low, high } = scale;
  for (let row = 0; row < BAR_HEIGHT; row++) {
    context.fillStyle = cssColor(scale.at(high - ((row + 0.5) / BAR_HEIGHT) * (high - low)));
    context.fillRect(PADDING, top + row, BAR_WIDTH, 1);
  }
  context.fillStyle = ink;
  for (const tick of scale.ticks(MOST_TICKS)) {
    const y = top + BAR_HEIGHT * (high > low ? (high - tick) / (high - low) : 0.5);
    context.fillRect(PADDING + BAR_WIDTH, Math.min(Math.round(y), top + BAR_HEIGHT - 1), 5, 1);
    context.fillText(formatValue(tick), PADDING + BAR_WIDTH + 10, y);
  }
}

export class LegendPanel {
  readonly element = make('canvas', { class: 'legend', role: 'img', 'data-testid': 'legend', hidden: true });

  constructor(private readonly viewer: Viewer) {
    const update = () => this.update();
    viewer.layersChanged.listen(update);
    viewer.theme.changed.listen(update);
  }

  private update(): void {
    const legend = legendOf(this.viewer);
    this.element.hidden = legend === null;
    if (!legend) {
      return;
    }
    const ratio = window.devicePixelRatio;
    const height = heightOf(legend);
    this.element.width = WIDTH * ratio;
    this.element.height = height * ratio;
    this.element.style.width = `${WIDTH}px`;
    this.element.style.height = `${height}px`;
    this.element.setAttribute('aria-label', describe(legend));
    const context = this.element.getContext('2d') as CanvasRenderingContext2D;
    context.scale(ratio, ratio);
    drawLegend(context, legend, this.viewer.theme);
  }
}

function describe({ title, scale, names }: Legend): string {
  const range = scale ? [`from ${formatValue(scale.low)} to ${formatValue(scale.high)}`] : [];
  return [`Legend: ${title}`, ...range, ...names.map(({ name }) => name)].join(', ');
}
