/** The list of layers: eye, name, count and colour of each. */

import { setPressed, makeButton } from './buttons';
import { make, makePart, makeSelect } from './dom';
import { makeIcon } from './icons';
import { formatCount } from '../format';
import type { LayerKind } from '../protocol';
import { cssColor } from '../scene/colors';
import type { SceneLayer } from '../scene/layer';
import type { Viewer } from '../viewer';

const THINGS: Record<LayerKind, string> = { points: 'points', surface: 'triangles', planes: 'planes', lines: 'lines' };
/** Stands for the plain colour where names of channels are chosen from. */
const PLAIN = '';

interface Row {
  layer: SceneLayer;
  element: HTMLElement;
  update: () => void;
}

export function layersPanel(viewer: Viewer): HTMLElement {
  const list = make('ul', { class: 'layers' });
  const empty = make('p', { class: 'faint' }, 'Nothing here yet. Drop a file on the page, or add one.');
  const part = makePart('Layers', 'layers', list, empty);
  let rows: Row[] = [];
  viewer.layersChanged.listen(() => {
    // Rows stay as long as their layers, so that the focus does.
    const before = new Map(rows.map((row) => [row.layer, row]));
    rows = viewer.layers.map((layer) => before.get(layer) ?? makeRow(viewer, layer));
    if (rows.some((row, i) => list.children[i] !== row.element) || list.children.length !== rows.length) {
      list.replaceChildren(...rows.map((row) => row.element));
    }
    rows.forEach((row) => row.update());
    empty.hidden = rows.length > 0;
  });
  return part;
}

function makeRow(viewer: Viewer, layer: SceneLayer): Row {
  const { info } = layer;
  const eye = makeButton({
    icon: 'eye',
    name: `Show ${info.name}`,
    testid: `eye-${info.id}`,
    press: () => viewer.setVisible(layer, !layer.isVisible),
  });
  const swatch = make('span', { class: `swatch swatch-${info.kind}`, 'aria-hidden': 'true' });
  swatch.style.setProperty('--color', cssColor(info.plain));
  const name = make(
    'button',
    { type: 'button', class: 'layer-name', title: info.name, 'data-testid': `layer-${info.id}`, onclick: () => viewer.activate(layer) },
    swatch,
    make('span', { class: 'layer-text' }, info.name),
  );
  const count = make('span', { class: 'count', title: `${info.count} ${THINGS[info.kind]}` }, formatCount(info.count));
  const fit = makeButton({ icon: 'fit', name: `Fit ${info.name}`, testid: `fit-${info.id}`, press: () => viewer.fit(layer) });
  const options = [{ value: PLAIN, text: 'plain' }, ...info.channels.map(({ name: value, title }) => ({ value, text: title }))];
  const color = makeSelect(`Colour of ${info.name}`, `color-${info.id}`, options, (value) =>
    viewer.setColor(layer, value === PLAIN ? null : value),
  );
  const element = make('li', { class: 'layer' }, eye, name, count, fit);
  if (info.channels.length > 0) {
    element.append(color);
  }
  const update = () => {
    setPressed(eye, layer.isVisible);
    eye.replaceChildren(makeIcon(layer.isVisible ? 'eye' : 'hidden'));
    color.value = layer.color ?? PLAIN;
    element.classList.toggle('is-active', layer === viewer.active);
    element.classList.toggle('is-hidden', !layer.isVisible);
    name.setAttribute('aria-current', String(layer === viewer.active));
  };
  return { layer, element, update };
}
