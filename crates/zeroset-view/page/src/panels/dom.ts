/** Elements in few words. */

type Attributes = Record<string, string | boolean | EventListener>;

/** Attributes that begin with `on` are listeners; `true` sets an attribute without value, `false` none. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') {
      element.addEventListener(name.slice(2), value);
    } else if (value !== false) {
      element.setAttribute(name, value === true ? '' : value);
    }
  }
  element.append(...children);
  return element;
}

export interface Option {
  value: string;
  text: string;
}

export function makeSelect(label: string, testid: string, options: Option[], choose: (value: string) => void): HTMLSelectElement {
  const select = make('select', { 'aria-label': label, 'data-testid': testid });
  select.append(...options.map(({ value, text }) => make('option', { value }, text)));
  select.addEventListener('change', () => choose(select.value));
  return select;
}

/** A part of the panel with a heading. */
export function makePart(title: string, testid: string, ...children: Node[]): HTMLElement {
  return make('section', { class: 'part', 'data-testid': testid, 'aria-label': title }, make('h2', {}, title), ...children);
}

/** A name before a control. */
export function makeField(name: string, ...controls: Node[]): HTMLElement {
  return make('label', { class: 'field' }, make('span', {}, name), ...controls);
}
