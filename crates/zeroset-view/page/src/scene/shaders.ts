/** The programs of the graphics card. Colours go to the target as they are; its alpha tells the depth cue how strong to be there. */

/** What clipping planes take away: positions p with n . p + d < 0 for any plane (n, d). */
const CLIP = /* glsl */ `
#define MOST_CLIPS 5
uniform vec4 clips[MOST_CLIPS];
uniform int clip_count;

bool is_clipped(vec3 position) {
  for (int i = 0; i < MOST_CLIPS; i++) {
    if (i < clip_count && dot(clips[i].xyz, position) + clips[i].w < 0.0) return true;
  }
  return false;
}
`;

/** The depth of what is lifted is that of a place a little nearer to the camera. */
const PLACE = /* glsl */ `
uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform float lift;

vec4 placed(vec4 world) {
  vec4 seen = viewMatrix * world;
  vec4 place = projectionMatrix * seen;
  if (lift > 0.0) {
    vec4 nearer = projectionMatrix * (seen + vec4(0.0, 0.0, lift, 0.0));
    place.z = nearer.w > 0.0 ? max(nearer.z / nearer.w, -1.0) * place.w : -place.w;
  }
  return place;
}
`;

export const POINT_VERTEX = /* glsl */ `
precision highp float;
in vec3 position;
in vec4 color;
uniform float pixels_per_unit;
uniform float size_factor;
uniform float fixed_diameter;
uniform float pixel_ratio;
uniform float spacings[8];
out vec3 tint;
out float diameter;
// Discs of an even cloud cover a surface from about this multiple of their spacing on.
const float COVER = 1.4;
${CLIP}
${PLACE}
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  tint = color.rgb;
  diameter = 0.0;
  if (is_clipped(world.xyz)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 0.0;
    return;
  }
  gl_Position = placed(world);
  if (fixed_diameter > 0.0) {
    diameter = fixed_diameter * pixel_ratio;
  } else {
    int octant = int(position.x >= 0.5) + 2 * int(position.y >= 0.5) + 4 * int(position.z >= 0.5);
    // In parallel w is 1, and a unit has the same size everywhere.
    diameter = size_factor * COVER * spacings[octant] * pixels_per_unit / gl_Position.w;
    diameter = clamp(diameter, 1.4 * pixel_ratio, 22.0 * pixel_ratio);
  }
  gl_PointSize = diameter;
}
`;

export const POINT_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 tint;
in float diameter;
uniform float cue;
out vec4 shown;
void main() {
  vec2 from_middle = 2.0 * gl_PointCoord - 1.0;
  if (diameter > 2.5 && dot(from_middle, from_middle) > 1.0) discard;
  shown = vec4(tint, cue);
}
`;

export const SURFACE_VERTEX = /* glsl */ `
precision highp float;
in vec3 position;
in vec3 normal;
in vec4 color;
out vec3 tint;
out vec3 local;
out vec3 upright;
${PLACE}
void main() {
  tint = color.rgb;
  local = position;
  upright = normal;
  gl_Position = placed(modelMatrix * vec4(position, 1.0));
}
`;

/** Light from everywhere, from the sky, and from a lamp at the camera's left shoulder: as in \`zeroset render\`. */
export const SURFACE_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 tint;
in vec3 local;
in vec3 upright;
uniform mat4 viewMatrix;
uniform vec3 sky;
uniform float cue;
out vec4 shown;
${CLIP}
const vec3 LAMP = vec3(-0.408, 0.577, 0.707);
const vec3 SHARES = vec3(0.30, 0.18, 0.58);
const float INSIDE = 0.66;
void main() {
  if (is_clipped(local)) discard;
  float side = gl_FrontFacing ? 1.0 : -1.0;
  vec3 normal = side * normalize(upright);
  float lamp = max(dot(mat3(viewMatrix) * normal, LAMP), 0.0);
  float light = SHARES.x + SHARES.y * (0.5 + 0.5 * dot(normal, sky)) + SHARES.z * lamp;
  shown = vec4(min(tint * light * (gl_FrontFacing ? 1.0 : INSIDE), 1.0), cue);
}
`;

/** Each instance is one line, and its four corners are spread to both sides by half the width. */
export const LINE_VERTEX = /* glsl */ `
precision highp float;
in vec2 corner;
in vec3 first;
in vec3 second;
in vec4 first_color;
in vec4 second_color;
uniform vec2 picture;
uniform float line_width;
out vec3 tint;
out vec3 local;
${PLACE}
void main() {
  vec4 a = placed(modelMatrix * vec4(first, 1.0));
  vec4 b = placed(modelMatrix * vec4(second, 1.0));
  tint = mix(first_color.rgb, second_color.rgb, corner.x);
  local = mix(first, second, corner.x);
  // What is behind the camera has no place on the picture: cut the line at the near plane.
  float near_a = a.z + a.w;
  float near_b = b.z + b.w;
  if (near_a < 0.0 && near_b > 0.0) a = mix(a, b, near_a / (near_a - near_b) + 1e-5);
  if (near_b < 0.0 && near_a > 0.0) b = mix(b, a, near_b / (near_b - near_a) + 1e-5);
  vec2 on_a = a.xy / a.w * picture;
  vec2 on_b = b.xy / b.w * picture;
  vec2 along = on_b - on_a;
  float length_on_picture = length(along);
  along = length_on_picture > 1e-6 ? along / length_on_picture : vec2(1.0, 0.0);
  vec4 place = corner.x < 0.5 ? a : b;
  vec2 aside = vec2(-along.y, along.x) * corner.y + along * (2.0 * corner.x - 1.0) * 0.5;
  gl_Position = place + vec4(aside * line_width / picture * place.w, 0.0, 0.0);
}
`;

export const LINE_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 tint;
in vec3 local;
out vec4 shown;
${CLIP}
void main() {
  if (is_clipped(local)) discard;
  shown = vec4(tint, 0.0);
}
`;

export const SCREEN_VERTEX = /* glsl */ `
precision highp float;
in vec3 position;
out vec2 place;
void main() {
  place = 0.5 * position.xy + 0.5;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
`;

/** Eye-dome lighting: what lies behind its surroundings, a pixel away, is darker. Clouds have no normals, and this shows their shape all the same. */
export const SCREEN_FRAGMENT = /* glsl */ `
precision highp float;
in vec2 place;
uniform sampler2D colors;
uniform highp sampler2D depths;
uniform vec2 step_size;
uniform vec2 near_far;
uniform bool is_parallel;
uniform float reach;
uniform float strength;
out vec4 shown;
const float DARKEST = 0.25;

float log_depth(vec2 at) {
  float depth = texture(depths, at).r;
  float near = near_far.x;
  float far = near_far.y;
  if (is_parallel) return (near + depth * (far - near)) / (reach * 0.693147);
  return log2(near * far / (far - depth * (far - near)));
}

void main() {
  vec4 own = texture(colors, place);
  float light = 1.0;
  if (own.a > 0.0 && strength > 0.0) {
    float depth = log_depth(place);
    float behind = 0.0;
    for (int dy = -1; dy <= 1; dy++) {
      for (int dx = -1; dx <= 1; dx++) {
        behind += max(0.0, depth - log_depth(place + vec2(dx, dy) * step_size));
      }
    }
    light = max(exp(-strength * own.a * behind / 8.0), DARKEST);
  }
  shown = vec4(own.rgb * light, 1.0);
}
`;
