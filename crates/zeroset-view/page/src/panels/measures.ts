/** The list of measures. */

import { formatLength, formatPosition } from '../format';
import { asTable, headline, legsOf, sumOf, type Measure } from '../tools/measure';
import type { Viewer } from '../viewer';
import { makeButton } from './buttons';
import { make, makePart } from './dom';

export function measuresPanel(viewer: Viewer): HTMLElement {
  const list = make('div', { class: 'stack' });
  const part = makePart('Measures', 'measures', list);
  const update = () => {
    const { measures } = viewer.toolbox;
    part.hidden = measures.length === 0;
    list.replaceChildren(...measures.map((measure) => makeCard(viewer, measure)));
  };
  viewer.toolbox.changed.listen(update);
  update();
  return part;
}

function makeCard(viewer: Viewer, measure: Measure): HTMLElement {
  const { frame, scene, toolbox } = viewer;
  const name = `${measure.kind} ${measure.number}`;
  const copy = makeButton({
    icon: 'copy', name: `Copy ${name}`, testid: `measure-copy-${measure.number}`, press: () => void copyText(viewer, asTable(measure, frame, scene.unit)),
  });
  const remove = makeButton({
    icon: 'remove', name: `Remove ${name}`, testid: `measure-remove-${measure.number}`, press: () => toolbox.remove(measure),
  });
  const head = make(
    'div',
    { class: 'card-head' },
    make('span', {}, name),
    make('strong', { class: 'number', 'data-testid': `measure-${measure.number}` }, headline(measure, frame, scene.unit)),
    copy,
    remove,
  );
  const points = make('ol', { class: 'points' }, ...measure.points.map((p) => make('li', { class: 'number' }, formatPosition(p))));
  const card = make('article', { class: 'card', 'aria-label': name }, head);
  if (measure.kind === 'distance' && measure.points.length > 1) {
    card.append(makeLegs(viewer, measure));
  }
  card.append(points);
  return card;
}

function makeLegs(viewer: Viewer, measure: Measure): HTMLElement {
  const legs = legsOf(measure, viewer.frame);
  const head = make('tr', {}, ...['leg', 'length', 'horizontal', 'height'].map((name) => make('th', { scope: 'col' }, name)));
  const named = legs.map((leg, i) => ({ name: `${i + 1}–${i + 2}`, leg }));
  if (legs.length > 1) {
    named.push({ name: 'total', leg: sumOf(legs) });
  }
  const rows = named.map(({ name, leg }) =>
    make(
      'tr',
      {},
      make('th', { scope: 'row' }, name),
      ...[leg.length, leg.horizontal, leg.rise].map((value) => make('td', { class: 'number' }, formatLength(value))),
    ),
  );
  return make('table', { class: 'legs' }, make('thead', {}, head), make('tbody', {}, ...rows));
}

export async function copyText(viewer: Viewer, text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    viewer.noticed.emit('Copied.');
  } catch {
    viewer.noticed.emit('The browser does not let this page copy.');
  }
}
