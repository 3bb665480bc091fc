/** All keys, and what the mouse does. */

import type { Command } from '../commands';
import { makeButton } from './buttons';
import { make } from './dom';

const MOUSE: [string, string][] = [
  ['Click', 'Show what is there'],
  ['Double click', 'Centre there'],
  ['Drag', 'Turn'],
  ['Shift or right drag', 'Move'],
  ['Wheel', 'Zoom to the cursor'],
  ['Drop a file', 'Add it'],
];
const MORE_KEYS: [string, string][] = [
  ['Arrows', 'Turn'],
  ['Shift + arrows', 'Move'],
  ['Tab', 'Go from control to control'],
];
const KEY_NAMES: Record<string, string> = { enter: 'Enter', backspace: 'Backspace', escape: 'Esc' };

export class Help {
  readonly element = make('dialog', { class: 'help', 'aria-label': 'Help', 'data-testid': 'help' });

  constructor(commands: Command[]) {
    const groups = [...new Set(commands.map(({ group }) => group))];
    const rowsOf = (group: string): [string, string][] =>
      commands.filter((command) => command.group === group).map(({ keys, name }) => [keyName(keys[0]), name]);
    const close = makeButton({ icon: 'remove', name: 'Close the help', testid: 'help-close', press: () => this.element.close() });
    this.element.append(
      make('div', { class: 'card-head' }, make('h2', {}, 'Help'), close),
      make(
        'div',
        { class: 'help-columns' },
        makeTable('Mouse', MOUSE),
        ...groups.map((group) => makeTable(group, group === 'View' ? [...rowsOf(group), ...MORE_KEYS] : rowsOf(group))),
      ),
    );
    // A click beside the box closes it.
    this.element.addEventListener('click', (event) => {
      if (event.target === this.element) {
        this.element.close();
      }
    });
  }

  get isOpen(): boolean {
    return this.element.open;
  }

  toggle(): void {
    if (this.isOpen) {
      this.element.close();
    } else {
      this.element.showModal();
    }
  }
}

function keyName(key: string): string {
  return KEY_NAMES[key] ?? key.toUpperCase();
}

function makeTable(title: string, rows: [string, string][]): HTMLElement {
  const list = make('dl', { class: 'keys' });
  for (const [key, name] of rows) {
    list.append(make('dt', {}, make('kbd', {}, key)), make('dd', {}, name));
  }
  return make('section', {}, make('h3', {}, title), list);
}
