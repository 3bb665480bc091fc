/** Files come in by a drop on the page, or by the chooser. */

import type { Feed } from '../feed';
import { make } from './dom';

export class FileIntake {
  /** Hidden, but part of the page: the chooser belongs to it. */
  readonly chooser = make('input', { type: 'file', multiple: true, hidden: true, 'aria-label': 'Files to add', 'data-testid': 'file-chooser' });
  readonly curtain = make('div', { class: 'curtain', hidden: true, 'aria-hidden': 'true' }, make('p', {}, 'Drop to add'));

  constructor(feed: Feed) {
    this.chooser.addEventListener('change', () => {
      void feed.send([...(this.chooser.files ?? [])]);
      this.chooser.value = '';
    });
    // A drag enters and leaves every element on its way: the curtain goes when it has left as many as it entered.
    let entered = 0;
    const cover = (isCovered: boolean) => {
      entered = isCovered ? entered : 0;
      this.curtain.hidden = !isCovered;
    };
    const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
    document.addEventListener('dragenter', (event) => {
      if (hasFiles(event)) {
        entered += 1;
        cover(true);
      }
    });
    document.addEventListener('dragleave', () => {
      entered -= 1;
      cover(entered > 0);
    });
    document.addEventListener('dragover', (event) => event.preventDefault());
    document.addEventListener('drop', (event) => {
      event.preventDefault();
      cover(false);
      void feed.send([...(event.dataTransfer?.files ?? [])]);
    });
  }

  choose(): void {
    this.chooser.click();
  }
}
