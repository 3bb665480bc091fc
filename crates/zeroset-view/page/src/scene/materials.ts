/** How points, surfaces and lines are drawn. One material for each kind of layer; what all of them need to know is shared. */

import { DoubleSide, GLSL3, NoBlending, RawShaderMaterial, Vector2, Vector3, Vector4, type IUniform } from 'three';

import type { Viewpoint } from '../camera/viewpoint';
import {
  LINE_FRAGMENT,
  LINE_VERTEX,
  POINT_FRAGMENT,
  POINT_VERTEX,
  SURFACE_FRAGMENT,
  SURFACE_VERTEX,
} from './shaders';

/** The space where n . p + d >= 0. */
export interface HalfSpace {
  normal: [number, number, number];
  offset: number;
}

/** No more half spaces than this can be given: one clipping plane and the four sides of a section. */
export const MOST_CLIPS = 5;
/** Pixels across a line. */
export const LINE_WIDTH = 2;
/** How strong the depth cue is on points and on surfaces; on lines there is none. */
export const CUE = { points: 1, surface: 0.25 };

/** The uniforms of all materials: changed in one place, seen by all. */
export class SharedUniforms {
  readonly clips = { value: Array.from({ length: MOST_CLIPS }, () => new Vector4()) };
  readonly clip_count = { value: 0 };
  readonly pixels_per_unit = { value: 1 };
  readonly pixel_ratio = { value: 1 };
  readonly size_factor = { value: 1 };
  readonly picture = { value: new Vector2(1, 1) };
  readonly sky = { value: new Vector3(0, 0, 1) };

  setClips(halfSpaces: HalfSpace[]): void {
    this.clip_count.value = halfSpaces.length;
    halfSpaces.forEach(({ normal, offset }, i) => this.clips.value[i].set(...normal, offset));
  }

  setView(view: Viewpoint, pixelRatio: number): void {
    this.pixels_per_unit.value = view.pixelsPerUnit * pixelRatio;
    this.pixel_ratio.value = pixelRatio;
    this.picture.value.set(view.width * pixelRatio, view.height * pixelRatio);
  }
}

function material(vertexShader: string, fragmentShader: string, uniforms: Record<string, IUniform>): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    uniforms,
    side: DoubleSide,
    // Alpha is the strength of the depth cue, not a share of the colour.
    blending: NoBlending,
  });
}

export function pointMaterial(shared: SharedUniforms, diameter: number | null, lift: number): RawShaderMaterial {
  const { clips, clip_count, pixels_per_unit, pixel_ratio, size_factor } = shared;
  return material(POINT_VERTEX, POINT_FRAGMENT, {
    clips,
    clip_count,
    pixels_per_unit,
    pixel_ratio,
    size_factor,
    fixed_diameter: { value: diameter ?? 0 },
    spacings: { value: new Array<number>(8).fill(1) },
    // Markers lie apart from one another, and a shadow around each would only make them dirty.
    cue: { value: diameter === null ? CUE.points : 0 },
    lift: { value: lift },
  });
}

export function surfaceMaterial(shared: SharedUniforms, lift: number): RawShaderMaterial {
  const { clips, clip_count, sky } = shared;
  return material(SURFACE_VERTEX, SURFACE_FRAGMENT, {
    clips,
    clip_count,
    sky,
    cue: { value: CUE.surface },
    lift: { value: lift },
  });
}

export function lineMaterial(shared: SharedUniforms, lift: number): RawShaderMaterial {
  const { clips, clip_count, picture, pixel_ratio } = shared;
  const width = { get value() { return LINE_WIDTH * pixel_ratio.value; } };
  return material(LINE_VERTEX, LINE_FRAGMENT, { clips, clip_count, picture, line_width: width, lift: { value: lift } });
}
