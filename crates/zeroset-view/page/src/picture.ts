/** Saves what is on the screen: the scene, the measures and the legend. */

import type { Viewer } from './viewer';

export async function savePicture(viewer: Viewer, legend: HTMLCanvasElement): Promise<void> {
  const { canvas } = viewer.stage;
  const picture = document.createElement('canvas');
  picture.width = canvas.width;
  picture.height = canvas.height;
  const context = picture.getContext('2d') as CanvasRenderingContext2D;
  // The browser may forget a drawn frame as soon as it is shown: draw and take it in one go.
  viewer.stage.draw();
  context.drawImage(canvas, 0, 0);
  context.drawImage(viewer.overlay.canvas, 0, 0, picture.width, picture.height);
  if (!legend.hidden) {
    const scale = picture.width / canvas.clientWidth;
    const [frame, own] = [canvas.getBoundingClientRect(), legend.getBoundingClientRect()];
    const [left, top] = [own.left - frame.left, own.top - frame.top];
    context.drawImage(legend, left * scale, top * scale, own.width * scale, own.height * scale);
  }
  const blob = await new Promise<Blob | null>((resolve) => picture.toBlob(resolve, 'image/png'));
  if (!blob) {
    viewer.noticed.emit('The browser could not make a PNG of this size.');
    return;
  }
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = `${viewer.scene.title.replace(/[^\p{L}\p{N}._-]+/gu, '-') || 'zeroset'}.png`;
  link.click();
  // The download has read the address by then.
  window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
