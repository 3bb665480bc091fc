/** The bar at the top: tools, views and what concerns the page. */

import { PRESETS } from '../camera/orbit';
import type { PageActions } from '../commands';
import { TOOLS, type Tool } from '../tools/toolbox';
import type { Viewer } from '../viewer';
import { makeButton, setPressed } from './buttons';
import { make } from './dom';

const TOOL_NAMES: Record<Tool, { name: string; text: string; key?: string }> = {
  inspect: { name: 'Show what is clicked', text: 'Inspect' },
  distance: { name: 'Measure a distance', text: 'Distance', key: 'd' },
  angle: { name: 'Measure an angle', text: 'Angle', key: 'n' },
  section: { name: 'Draw a section', text: 'Section', key: 's' },
};

export function header(viewer: Viewer, page: PageActions): HTMLElement {
  const title = make('span', { class: 'title', 'data-testid': 'title' });
  viewer.sceneChanged.listen(() => {
    const name = viewer.scene.title;
    title.textContent = name;
    title.title = name;
    document.title = name ? `${name} · zeroset` : 'zeroset';
  });
  return make(
    'header',
    { class: 'header' },
    make('h1', { class: 'mark' }, 'zeroset'),
    title,
    make('div', { class: 'bar', role: 'toolbar', 'aria-label': 'Tools' }, ...toolButtons(viewer)),
    make('div', { class: 'bar bar-views', role: 'toolbar', 'aria-label': 'Views' }, ...viewButtons(viewer)),
    make('div', { class: 'bar bar-end', role: 'toolbar', 'aria-label': 'Page' }, ...pageButtons(viewer, page)),
  );
}

function toolButtons({ toolbox }: Viewer): HTMLElement[] {
  const buttons = TOOLS.map((tool) =>
    makeButton({ icon: tool, testid: `tool-${tool}`, press: () => toolbox.choose(tool), ...TOOL_NAMES[tool] }),
  );
  const update = () => TOOLS.forEach((tool, i) => setPressed(buttons[i], toolbox.tool === tool));
  toolbox.changed.listen(update);
  update();
  return buttons;
}

function viewButtons(viewer: Viewer): HTMLElement[] {
  const { camera } = viewer;
  const presets = PRESETS.map((preset) =>
    make(
      'button',
      {
        type: 'button', class: 'button', title: `View: ${preset} (${preset[0]})`, 'aria-keyshortcuts': preset[0], 'data-testid': `view-${preset}`,
        onclick: () => camera.look(preset),
      },
      preset[0].toUpperCase() + preset.slice(1),
    ),
  );
  const fit = makeButton({ icon: 'fit', name: 'Fit all that is visible', testid: 'fit-all', key: 'a', press: () => viewer.fit(null) });
  const parallel = makeButton({
    icon: 'parallel', name: 'Parallel', testid: 'parallel', key: 'o', press: () => camera.setParallel(!camera.isParallel),
  });
  const update = () => setPressed(parallel, camera.isParallel);
  camera.changed.listen(update);
  update();
  return [...presets, fit, parallel];
}

function pageButtons(viewer: Viewer, page: PageActions): HTMLElement[] {
  const panel = makeButton({ icon: 'panel', name: 'Show or hide the panel', testid: 'toggle-panel', key: 'h', press: page.togglePanel });
  panel.setAttribute('aria-controls', 'panel');
  return [
    makeButton({ icon: 'add', name: 'Add files', testid: 'add-files', key: 'u', press: page.addFiles }),
    makeButton({ icon: 'save', name: 'Save the picture', testid: 'save-picture', key: 'w', press: page.savePicture }),
    makeButton({ icon: 'theme', name: 'Light or dark', testid: 'theme', key: 'g', press: () => viewer.theme.toggle() }),
    panel,
    makeButton({ icon: 'help', name: 'Help', testid: 'open-help', key: '?', press: page.toggleHelp }),
  ];
}
