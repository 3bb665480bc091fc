/** Keeps up with the server's scene: asks again while the server works. */

import { fetchScene, sendFile, Unreachable, type SceneInfo } from './protocol';
import { Signal } from './signal';

/** Milliseconds between questions while the server works. */
const PAUSE = 300;
/** After a file was sent, so many answers may show nothing new before asking ends. */
const PATIENCE = 10;

export class Feed {
  readonly received = new Signal<SceneInfo>();
  readonly failed = new Signal<Error>();
  /** The name of a file on its way to the server. */
  readonly sending = new Signal<string>();
  private latest: SceneInfo | null = null;
  private isAsking = false;
  private patience = 0;

  /** Asks for the scene, and goes on while there is more to come. */
  async follow(): Promise<void> {
    if (this.isAsking) {
      return;
    }
    this.isAsking = true;
    try {
      for (;;) {
        const scene = await fetchScene();
        if (this.latest && scene.revision !== this.latest.revision) {
          this.patience = 0;
        }
        this.latest = scene;
        this.received.emit(scene);
        this.patience -= 1;
        if (scene.work === null && this.patience <= 0) {
          return;
        }
        await new Promise((resolve) => setTimeout(resolve, PAUSE));
      }
    } catch (error) {
      this.failed.emit(error as Error);
    } finally {
      this.isAsking = false;
    }
  }

  /** Hands files over, one after the other. */
  async send(files: Iterable<File>): Promise<void> {
    for (const file of files) {
      this.sending.emit(file.name);
      try {
        await sendFile(file);
      } catch (error) {
        this.failed.emit(error instanceof Unreachable ? error : new Error(`${file.name}: ${(error as Error).message}`));
        continue;
      }
      this.patience = PATIENCE;
      void this.follow();
    }
  }
}
