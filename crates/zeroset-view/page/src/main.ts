/** Puts the page together. */

import './style/page.css';
import './style/panels.css';

import { commandsOf, listenToKeys, type PageActions } from './commands';
import { Feed } from './feed';
import { clipPanel, sectionPanel } from './panels/clip';
import { displayPanel } from './panels/display';
import { make } from './panels/dom';
import { FileIntake } from './panels/files';
import { header } from './panels/header';
import { Help } from './panels/help';
import { layersPanel } from './panels/layers';
import { LegendPanel } from './panels/legend';
import { measuresPanel } from './panels/measures';
import { Messages } from './panels/messages';
import { pickedPanel } from './panels/picked';
import { statusLine } from './panels/status';
import { savePicture } from './picture';
import { expose } from './probe';
import { Unreachable } from './protocol';
import { Theme } from './theme';
import { Viewer } from './viewer';

function start(): void {
  const canvas = make('canvas', {
    class: 'canvas', tabindex: '0', role: 'img', 'data-testid': 'canvas',
    'aria-label': 'The scene. Arrows turn, Shift and arrows move, plus and minus zoom, P clicks at the cross in the middle.',
  });
  const marks = make('canvas', { class: 'marks', 'aria-hidden': 'true' });
  const hint = make('p', { class: 'hint', role: 'status', 'data-testid': 'hint' });
  const stage = make('main', { class: 'stage' }, canvas, make('div', { class: 'cross', 'aria-hidden': 'true' }), marks, hint);
  document.body.append(stage);

  const viewer = new Viewer(canvas, marks, new Theme(stage));
  const feed = new Feed();
  const messages = new Messages(viewer);
  const files = new FileIntake(feed);
  const legend = new LegendPanel(viewer);
  const panel = make(
    'aside',
    { class: 'panel', id: 'panel', 'aria-label': 'Panel', 'data-testid': 'panel' },
    layersPanel(viewer), measuresPanel(viewer), clipPanel(viewer), sectionPanel(viewer), displayPanel(viewer),
  );
  const page: PageActions = {
    addFiles: () => files.choose(),
    savePicture: () => void savePicture(viewer, legend.element),
    toggleHelp: () => help.toggle(),
    togglePanel: () => document.body.classList.toggle('has-panel-toggled'),
    cancel: () => viewer.cancel(),
  };
  const commands = commandsOf(viewer, page);
  const help = new Help(commands);

  stage.append(legend.element, pickedPanel(viewer), messages.element);
  stage.before(header(viewer, page), panel);
  stage.after(statusLine(viewer), files.chooser, files.curtain, help.element);
  viewer.toolbox.changed.listen(() => {
    hint.textContent = viewer.toolbox.hint;
    stage.dataset.tool = viewer.toolbox.tool;
  });
  showCrossByKeyboard(stage);
  listenToKeys(commands, viewer, () => help.isOpen);
  expose(viewer);

  feed.received.listen((scene) => viewer.accept(scene));
  feed.sending.listen((name) => messages.notice(`Sending ${name}.`));
  feed.failed.listen((error) => messages.problem(error.message, error instanceof Unreachable ? () => void feed.follow() : undefined));
  void feed.follow();
}

/** The cross tells where the keyboard clicks; the mouse has its cursor. */
function showCrossByKeyboard(stage: HTMLElement): void {
  document.addEventListener('keydown', (event) => {
    if (event.key.startsWith('Arrow') || event.key.toLowerCase() === 'p') {
      stage.classList.add('has-cross');
    }
  });
  stage.addEventListener('pointermove', () => stage.classList.remove('has-cross'));
}

try {
  start();
} catch (error) {
  document.body.replaceChildren(
    make('p', { class: 'fatal', role: 'alert' }, `The page could not start: ${(error as Error).message}. It needs a browser with WebGL 2.`),
  );
}
