/** The clipping plane and the section. */

import { formatLength, withUnit } from '../format';
import { CLIP_MODES, type ClipMode } from '../tools/clip';
import type { Viewer } from '../viewer';
import { makeButton, setPressed } from './buttons';
import { make, makeField, makePart, makeSelect } from './dom';

const MODE_NAMES: Record<ClipMode, string> = {
  off: 'off',
  x: 'across x',
  y: 'across y',
  z: 'across z',
  heading: 'upright, at an angle',
};
/** Steps of the slider from end to end. */
const STEPS = 1000;

function numberInput(label: string, testid: string, take: (value: number) => void): HTMLInputElement {
  const input = make('input', { type: 'number', step: 'any', 'aria-label': label, 'data-testid': testid });
  input.addEventListener('change', () => {
    if (Number.isFinite(input.valueAsNumber)) {
      take(input.valueAsNumber);
    }
  });
  return input;
}

export function clipPanel(viewer: Viewer): HTMLElement {
  const { clip } = viewer;
  const mode = makeSelect(
    'Clipping plane',
    'clip-mode',
    CLIP_MODES.map((value) => ({ value, text: MODE_NAMES[value] })),
    (value) => clip.setMode(value as ClipMode),
  );
  const slider = make('input', { type: 'range', min: '0', max: String(STEPS), 'aria-label': 'Place of the clip', 'data-testid': 'clip-slider' });
  slider.addEventListener('input', () => {
    const [low, high] = clip.range();
    clip.setPosition(low + ((high - low) * slider.valueAsNumber) / STEPS);
  });
  const position = numberInput('Place of the clip as a number', 'clip-position', (value) => clip.setPosition(value));
  const heading = numberInput('Heading in degrees from north to east', 'clip-heading', (value) => clip.setHeading(value));
  const flip = makeButton({ icon: 'flip', name: 'Flip the clip', testid: 'clip-flip', press: () => clip.flip(), key: 'x' });
  const headingField = makeField('Heading °', heading);
  const placeField = makeField('Place', position, flip);
  const update = () => {
    const [low, high] = clip.range();
    mode.value = clip.mode;
    slider.hidden = placeField.hidden = clip.mode === 'off';
    headingField.hidden = clip.mode !== 'heading';
    slider.valueAsNumber = high > low ? (STEPS * (clip.position - low)) / (high - low) : 0;
    position.value = formatLength(clip.position);
    heading.value = String(clip.heading);
    setPressed(flip, clip.isFlipped);
  };
  clip.changed.listen(update);
  update();
  return makePart('Clip', 'clip', makeField('Plane', mode), slider, placeField, headingField);
}

export function sectionPanel(viewer: Viewer): HTMLElement {
  const { section, toolbox } = viewer;
  const thickness = numberInput('Thickness of the section', 'section-thickness', (value) => section.setThickness(value));
  thickness.min = '0';
  const length = make('span', { class: 'number', 'data-testid': 'section-length' });
  const look = makeButton({
    icon: 'look', name: 'Look at the section', testid: 'section-look', text: 'Look at it', press: () => viewer.lookAtSection(),
  });
  const remove = makeButton({
    icon: 'remove', name: 'Remove the section', testid: 'section-remove', text: 'Remove', press: () => section.setLine(null),
  });
  const draw = makeButton({
    icon: 'section', name: 'Draw a section', testid: 'section-draw', text: 'Draw', key: 's', press: () => toolbox.choose('section'),
  });
  const shown = make('div', { class: 'stack' }, makeField('Length', length), makeField('Thickness', thickness));
  const part = makePart('Section', 'section', shown, make('div', { class: 'row' }, draw, look, remove));
  const update = () => {
    const isDrawn = section.line !== null;
    shown.hidden = look.hidden = remove.hidden = !isDrawn;
    length.textContent = withUnit(formatLength(section.length), viewer.scene.unit);
    thickness.value = String(section.thickness);
  };
  section.changed.listen(update);
  update();
  return part;
}
