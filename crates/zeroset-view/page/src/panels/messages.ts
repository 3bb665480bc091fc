/** What the user has to know: problems until they are closed, notices for a moment, and the progress of loading. */

import type { Viewer } from '../viewer';
import { makeButton } from './buttons';
import { make } from './dom';

/** Milliseconds that a notice stays. */
const NOTICE = 5000;
/** No more messages at a time: the oldest go. */
const MOST = 6;

export class Messages {
  readonly element = make('div', { class: 'messages' });
  private readonly work = make('div', { class: 'message work', role: 'status', 'data-testid': 'work', hidden: true });
  private readonly problems = make('div', { class: 'stack', role: 'alert', 'data-testid': 'problems' });
  private readonly notices = make('div', { class: 'stack', role: 'status', 'data-testid': 'notices' });
  /** Problems of the server that were shown already: it repeats them. */
  private readonly known = new Set<string>();
  private readonly bar = make('progress', { max: '1' });
  private readonly what = make('span');

  constructor(viewer: Viewer) {
    this.work.append(this.what, this.bar);
    this.element.append(this.work, this.problems, this.notices);
    viewer.noticed.listen((text) => this.notice(text));
    viewer.sceneChanged.listen(() => {
      const { work, problems } = viewer.scene;
      this.work.hidden = work === null;
      if (work) {
        this.what.textContent = work.what;
        this.bar.value = work.share;
      }
      problems.filter((text) => !this.known.has(text)).forEach((text) => {
        this.known.add(text);
        this.problem(text);
      });
    });
  }

  /** Something went wrong: shown until it is closed. */
  problem(text: string, retry?: () => void): void {
    const message = make('div', { class: 'message problem', 'data-testid': 'problem' }, make('span', {}, text));
    if (retry) {
      const again = make('button', { type: 'button', class: 'button' }, 'Try again');
      again.addEventListener('click', () => {
        message.remove();
        retry();
      });
      message.append(again);
    }
    message.append(makeButton({ icon: 'remove', name: 'Close the message', testid: 'problem-close', press: () => message.remove() }));
    put(this.problems, message);
  }

  /** For a moment; the same one is not repeated while it is there. */
  notice(text: string): void {
    if ([...this.notices.children].some((message) => message.textContent === text)) {
      return;
    }
    const message = make('div', { class: 'message', 'data-testid': 'notice' }, make('span', {}, text));
    put(this.notices, message);
    window.setTimeout(() => message.remove(), NOTICE);
  }
}

function put(list: HTMLElement, message: HTMLElement): void {
  list.append(message);
  while (list.children.length > MOST) {
    list.firstElementChild?.remove();
  }
}
