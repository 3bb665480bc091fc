/** All that can be done by a letter: one list, for the keyboard, the buttons and the help. */

import type { Preset } from './camera/orbit';
import { PRESETS } from './camera/orbit';
import type { Tool } from './tools/toolbox';
import type { Viewer } from './viewer';

/** What the page does, apart from what the viewer itself can do. */
export interface PageActions {
  addFiles(): void;
  savePicture(): void;
  toggleHelp(): void;
  togglePanel(): void;
  cancel(): void;
}

export interface Command {
  /** As in `KeyboardEvent.key`, in lower case. */
  keys: string[];
  group: 'View' | 'Tools' | 'Layers' | 'Page';
  name: string;
  run: () => void;
}

/** Radians and pixels of one press of an arrow. */
const TURN = Math.PI / 36;
const PAN = 40;
const ZOOM = 1.2;
const ARROWS: Record<string, [number, number]> = {
  arrowleft: [-1, 0],
  arrowright: [1, 0],
  arrowup: [0, -1],
  arrowdown: [0, 1],
};
export const POINT_SIZES = [0.5, 3] as const;
const SIZE_STEP = 0.25;

const PRESET_NAMES: Record<Preset, string> = {
  iso: 'From the corner',
  top: 'From above',
  front: 'From the front',
  back: 'From the back',
  left: 'From the left',
  right: 'From the right',
};

export function commandsOf(viewer: Viewer, page: PageActions): Command[] {
  const { camera, toolbox, clip, stage } = viewer;
  const centre = (): [number, number] => {
    const { width, height } = camera.view();
    return [width / 2, height / 2];
  };
  const tool = (key: string, name: string, choice: Tool): Command => ({
    keys: [key],
    group: 'Tools',
    name,
    run: () => toolbox.choose(toolbox.tool === choice ? 'inspect' : choice),
  });
  return [
    ...PRESETS.map((preset): Command => ({
      keys: [preset[0]],
      group: 'View',
      name: PRESET_NAMES[preset],
      run: () => camera.look(preset),
    })),
    { keys: ['a'], group: 'View', name: 'Fit all that is visible', run: () => viewer.fit(null) },
    { keys: ['z'], group: 'View', name: 'Fit the active layer', run: () => viewer.fit(viewer.active) },
    { keys: ['o'], group: 'View', name: 'Perspective or parallel', run: () => camera.setParallel(!camera.isParallel) },
    { keys: ['+', '='], group: 'View', name: 'Zoom in', run: () => camera.zoom(1 / ZOOM, null) },
    { keys: ['-'], group: 'View', name: 'Zoom out', run: () => camera.zoom(ZOOM, null) },
    { keys: ['p'], group: 'Tools', name: 'Click at the cross in the middle', run: () => viewer.click(centre()) },
    tool('d', 'Measure a distance', 'distance'),
    tool('n', 'Measure an angle', 'angle'),
    tool('s', 'Draw a section', 'section'),
    { keys: ['enter'], group: 'Tools', name: 'End the measure', run: () => toolbox.finish() },
    { keys: ['backspace'], group: 'Tools', name: 'Take back the last point', run: () => toolbox.undo() },
    { keys: ['c'], group: 'Tools', name: 'Clip on or off', run: () => clip.setMode(clip.mode === 'off' ? 'z' : 'off') },
    { keys: ['x'], group: 'Tools', name: 'Flip the clip', run: () => clip.flip() },
    { keys: ['v'], group: 'Layers', name: 'Show or hide the active layer', run: () => toggle(viewer, viewer.active) },
    { keys: ['.'], group: 'Layers', name: 'Next layer', run: () => step(viewer, 1) },
    { keys: [','], group: 'Layers', name: 'Previous layer', run: () => step(viewer, -1) },
    { keys: [']'], group: 'Layers', name: 'Larger points', run: () => resize(viewer, SIZE_STEP) },
    { keys: ['['], group: 'Layers', name: 'Smaller points', run: () => resize(viewer, -SIZE_STEP) },
    { keys: ['e'], group: 'Layers', name: 'Depth shading on or off', run: () => setDepthCue(viewer, !stage.hasDepthCue) },
    { keys: ['u'], group: 'Page', name: 'Add files', run: page.addFiles },
    { keys: ['w'], group: 'Page', name: 'Save the picture', run: page.savePicture },
    { keys: ['g'], group: 'Page', name: 'Light or dark', run: () => viewer.theme.toggle() },
    { keys: ['h'], group: 'Page', name: 'Show or hide the panel', run: page.togglePanel },
    { keys: ['?'], group: 'Page', name: 'Help', run: page.toggleHelp },
    { keys: ['escape'], group: 'Page', name: 'Close, or leave the tool', run: page.cancel },
  ];
}

function toggle(viewer: Viewer, layer: Viewer['active']): void {
  if (layer) {
    viewer.setVisible(layer, !layer.isVisible);
  }
}

function step(viewer: Viewer, by: number): void {
  const { layers, active } = viewer;
  if (active) {
    viewer.activate(layers[(layers.indexOf(active) + by + layers.length) % layers.length]);
  }
}

function resize(viewer: Viewer, by: number): void {
  setPointSize(viewer, viewer.stage.shared.size_factor.value + by);
}

export function setPointSize(viewer: Viewer, factor: number): void {
  viewer.stage.shared.size_factor.value = Math.max(POINT_SIZES[0], Math.min(POINT_SIZES[1], factor));
  viewer.displayChanged.emit();
  viewer.stage.invalidate();
}

export function setDepthCue(viewer: Viewer, isOn: boolean): void {
  viewer.stage.hasDepthCue = isOn;
  viewer.displayChanged.emit();
  viewer.stage.invalidate();
}

/** Letters work wherever the focus is, except where they are text or choose something. A dialogue closes itself by Escape. */
export function listenToKeys(commands: Command[], viewer: Viewer, isModal: () => boolean): void {
  document.addEventListener('keydown', (event) => {
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey || event.altKey || (isModal() && key !== '?')) {
      return;
    }
    const target = event.target as HTMLElement;
    const isTaken =
      (target.matches('select, input[type=number]') && key !== 'escape') ||
      (target.matches('input[type=range]') && key in ARROWS) ||
      (target.matches('button, a') && key === 'enter');
    if (isTaken) {
      return;
    }
    if (key in ARROWS) {
      move(viewer, ARROWS[key], event.shiftKey);
    } else {
      const command = commands.find(({ keys }) => keys.includes(key));
      if (!command) {
        return;
      }
      command.run();
    }
    event.preventDefault();
  });
}

/** An arrow turns the camera its way, or moves it there with Shift. */
function move(viewer: Viewer, [right, down]: [number, number], isPan: boolean): void {
  if (isPan) {
    viewer.camera.pan(-right * PAN, -down * PAN);
  } else {
    viewer.camera.orbit(-right * TURN, -down * TURN);
  }
}
