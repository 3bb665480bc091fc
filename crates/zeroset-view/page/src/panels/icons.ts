/** Drawings on buttons: strokes on a square of 16 by 16. */

const SPACE = 'http://www.w3.org/2000/svg';

const PATHS = {
  inspect: 'M8 1.5v3M8 11.5v3M1.5 8h3M11.5 8h3M8 5.2a2.8 2.8 0 1 0 0 5.6a2.8 2.8 0 1 0 0-5.6',
  distance: 'M1.8 11.2l9.4-9.4l3 3l-9.4 9.4zM4.4 8.6l1.6 1.6M6.8 6.2l1.6 1.6M9.2 3.8l1.6 1.6',
  angle: 'M13.5 13h-11l8-10.5M8.6 13c0-2-.8-3.6-2.2-4.9',
  section: 'M2 12.5l9-10M5 14.5l9-10M2 12.5l3 2M11 2.5l3 2',
  fit: 'M2 5.5v-3.5h3.5M10.5 2h3.5v3.5M14 10.5v3.5h-3.5M5.5 14h-3.5v-3.5M6 6h4v4h-4z',
  parallel: 'M8 1.8l5.5 3.1v6.2l-5.5 3.1l-5.5-3.1v-6.2zM2.5 4.9l5.5 3.1l5.5-3.1M8 8v6.2',
  add: 'M8 3v10M3 8h10',
  save: 'M8 2v7.5M4.8 6.5l3.2 3.2l3.2-3.2M2.5 11v2.8h11v-2.8',
  theme: 'M8 2a6 6 0 1 0 0 12a6 6 0 1 0 0-12M8 2v12M8 5h4.8M8 8h6M8 11h4.8',
  help: 'M5.5 5.8c0-3.3 5.2-3.3 5.2 0c0 2-2.7 2.1-2.7 4.2M8 12.8v.4',
  eye: 'M1.5 8c3-5.2 10-5.2 13 0c-3 5.2-10 5.2-13 0M8 6a2 2 0 1 0 0 4a2 2 0 1 0 0-4',
  hidden: 'M1.5 8c3-5.2 10-5.2 13 0c-3 5.2-10 5.2-13 0M2.5 13.5l11-11',
  remove: 'M4 4l8 8M12 4l-8 8',
  copy: 'M5.5 5.5h8v8h-8zM10.5 5.5v-3h-8v8h3',
  flip: 'M8 2v12M5.5 5l-3 3l3 3M10.5 5l3 3l-3 3',
  panel: 'M2 3.5h12v9h-12zM2 9h12',
  look: 'M2 13l3.5-8h5l3.5 8zM8 5v8',
} as const;

export type Icon = keyof typeof PATHS;

export function makeIcon(icon: Icon): SVGSVGElement {
  const svg = document.createElementNS(SPACE, 'svg');
  svg.setAttribute('viewBox', '0 0 16 16');
  svg.setAttribute('class', 'icon');
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS(SPACE, 'path');
  path.setAttribute('d', PATHS[icon]);
  svg.append(path);
  return svg;
}
