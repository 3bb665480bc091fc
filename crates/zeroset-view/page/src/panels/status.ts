/** One line at the bottom: what is drawn, and where things are. */

import { formatCount } from '../format';
import type { Viewer } from '../viewer';
import { make } from './dom';

/** Milliseconds of rest after which the line is read anew: at each frame of a turn it would be noise. */
const REST = 200;

export function statusLine(viewer: Viewer): HTMLElement {
  const drawn = make('span', { class: 'number', role: 'status', 'aria-live': 'polite', 'data-testid': 'status' });
  const place = make('span', { class: 'faint', 'data-testid': 'reference' });
  let timer: number | undefined;
  viewer.stage.framed.listen(() => {
    window.clearTimeout(timer);
    timer = window.setTimeout(() => (drawn.textContent = describeFrame(viewer)), REST);
  });
  viewer.sceneChanged.listen(() => {
    const { crs, unit, up, zeroset } = viewer.scene;
    const parts = [crs, unit === null ? 'unit unknown' : `unit ${unit}`, `${up} is up`, `zeroset ${zeroset}`];
    place.textContent = parts.filter(Boolean).join(' · ');
  });
  return make('footer', { class: 'status' }, drawn, place);
}

function describeFrame({ stage, detail, layers }: Viewer): string {
  const { points, nodes, of, loading } = detail.report;
  const calls = `${stage.drawCalls} draw ${stage.drawCalls === 1 ? 'call' : 'calls'}`;
  if (!layers.some((layer) => layer.info.kind === 'points')) {
    return calls;
  }
  const parts = [calls, `${formatCount(points)} of ${formatCount(of)} points`, `${nodes} ${nodes === 1 ? 'node' : 'nodes'}`];
  return [...parts, ...(loading > 0 ? [`${loading} loading`] : [])].join(', ');
}
