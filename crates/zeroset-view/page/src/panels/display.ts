/** How points are shown. */

import { POINT_SIZES, setDepthCue, setPointSize } from '../commands';
import type { Viewer } from '../viewer';
import { make, makeField, makePart, makeSelect } from './dom';

const BUDGETS = [1, 3, 6];

export function displayPanel(viewer: Viewer): HTMLElement {
  const { detail, stage } = viewer;
  const size = make('input', {
    type: 'range', min: String(POINT_SIZES[0]), max: String(POINT_SIZES[1]), step: '0.05', 'aria-label': 'Point size', 'data-testid': 'point-size',
  });
  size.addEventListener('input', () => setPointSize(viewer, size.valueAsNumber));
  const budget = makeSelect(
    'Points of a picture, at most',
    'budget',
    BUDGETS.map((millions) => ({ value: String(millions), text: `${millions} million points` })),
    (millions) => {
      detail.budget = Number(millions) * 1e6;
      stage.invalidate();
    },
  );
  budget.value = String(detail.budget / 1e6);
  const cue = make('input', { type: 'checkbox', 'data-testid': 'depth-cue' });
  cue.addEventListener('change', () => setDepthCue(viewer, cue.checked));
  const update = () => {
    size.valueAsNumber = stage.shared.size_factor.value;
    cue.checked = stage.hasDepthCue;
  };
  viewer.displayChanged.listen(update);
  update();
  return makePart(
    'Points',
    'display',
    makeField('Size', size),
    makeField('At most', budget),
    make('label', { class: 'check' }, cue, 'Depth shading'),
  );
}
