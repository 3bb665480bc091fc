/** What was clicked: where it is, and all that is known there. */

import { formatLength } from '../format';
import { cssColor } from '../scene/colors';
import type { Reading } from '../tools/pick';
import type { Viewer } from '../viewer';
import { makeButton } from './buttons';
import { make } from './dom';
import { copyText } from './measures';

export function pickedPanel(viewer: Viewer): HTMLElement {
  const title = make('strong', { class: 'picked-title', 'data-testid': 'picked-layer' });
  const body = make('div', { class: 'stack', 'aria-live': 'polite' });
  const copy = makeButton({
    icon: 'copy',
    name: 'Copy the coordinates',
    testid: 'picked-copy',
    press: () => void copyText(viewer, (viewer.picked?.world ?? []).map(formatLength).join('\t')),
  });
  const close = makeButton({ icon: 'remove', name: 'Close', testid: 'picked-close', press: () => viewer.setPicked(null) });
  const card = make(
    'section',
    { class: 'picked', 'aria-label': 'Clicked', 'data-testid': 'picked', hidden: true },
    make('div', { class: 'card-head' }, title, copy, close),
    body,
  );
  viewer.pickedChanged.listen(() => {
    const { picked } = viewer;
    card.hidden = picked === null;
    if (!picked) {
      return;
    }
    title.textContent = picked.layer;
    const place = ['x', 'y', 'z'].map((name, axis) => ({ title: name, text: formatLength(picked.world[axis]) }));
    body.replaceChildren(makeReadings([...place, ...picked.readings], 'picked-values'));
    if (picked.plane) {
      body.append(make('h3', {}, `Plane ${picked.plane.number}`), makeReadings(picked.plane.readings, 'picked-plane'));
    }
  });
  return card;
}

function makeReadings(readings: Reading[], testid: string): HTMLElement {
  const list = make('dl', { class: 'readings', 'data-testid': testid });
  for (const { title, text, color } of readings) {
    const value = make('dd', { class: 'number' }, text);
    if (color) {
      const swatch = make('span', { class: 'swatch', 'aria-hidden': 'true' });
      swatch.style.setProperty('--color', cssColor(color));
      value.prepend(swatch);
    }
    list.append(make('dt', {}, title), value);
  }
  return list;
}
