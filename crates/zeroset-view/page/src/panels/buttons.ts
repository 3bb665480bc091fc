/** Buttons with a drawing. */

import { make } from './dom';
import { makeIcon, type Icon } from './icons';

export interface ButtonChoice {
  icon: Icon;
  /** What the button does; shown as a hint and read aloud. */
  name: string;
  testid: string;
  press: () => void;
  /** Shown beside the drawing. */
  text?: string;
  /** The key that does the same. */
  key?: string;
}

export function makeButton({ icon, name, testid, press, text, key }: ButtonChoice): HTMLButtonElement {
  const hint = key ? `${name} (${key})` : name;
  const button = make('button', { type: 'button', class: 'button', title: hint, 'aria-label': name, 'data-testid': testid, onclick: press });
  button.append(makeIcon(icon));
  if (text) {
    button.append(make('span', { class: 'button-text' }, text));
  }
  if (key) {
    button.setAttribute('aria-keyshortcuts', key);
  }
  return button;
}

export function setPressed(button: HTMLElement, isPressed: boolean): void {
  button.setAttribute('aria-pressed', String(isPressed));
}
