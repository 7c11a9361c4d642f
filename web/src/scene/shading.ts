/** How the surface is coloured, alike in the 3D view and laid over a frame. */

import { DoubleSide, GLSL3, ShaderMaterial, Vector3, Vector4 } from "three";
import { LAYERS, type Layer } from "../model/hash";
import { PALETTE } from "../model/marks";

const FRAGMENT = /* glsl */ `
precision highp float;
in vec3 place;
in vec3 facing;
in vec4 paint;
in float seen;
flat in float onBlade;
flat in vec2 owner;
in float beyond;
out vec4 result;
uniform vec3 eye;
uniform int layer;
uniform float chosen;
uniform float alone;
uniform vec4 plane;
uniform float exposure;
uniform vec3 palette[8];

vec3 encoded(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), linear));
}
float stripes(float width) { return step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / width)); }
float dots(float width) { vec2 at = fract(gl_FragCoord.xy / width) - 0.5; return step(dot(at, at), 0.06); }

void main() {
  if (beyond > 0.0) discard;
  if (dot(plane.xyz, place) > plane.w) discard;
  if (alone > 0.0 && abs(onBlade - alone) > 0.5) discard;
  vec3 towards = normalize(eye - place);
  float lean = abs(dot(normalize(facing), towards));
  vec3 light = vec3(0.42 + 0.58 * lean);
  vec3 base = vec3(0.62);
  bool found = owner.x >= 0.0;
  vec3 own = palette[int(clamp(owner.y, 0.0, 7.0))];
  if (layer == 0) {
    base = clamp(encoded(paint.rgb * exposure), 0.0, 1.0);
    if (found) base = mix(base, own, 0.45);
  } else if (layer == 1) {
    // Blue, orange and grey stay apart for all kinds of colour blindness; patterns say the same without colour.
    base = seen >= 0.5 ? vec3(0.45, 0.68, 0.86) : seen >= 0.2 ? mix(vec3(0.93, 0.60, 0.16), vec3(0.62, 0.36, 0.05), stripes(9.0)) : mix(vec3(0.34), vec3(0.12), dots(6.0));
  } else if (layer == 2) {
    if (found) base = own;
  } else {
    if (onBlade > 0.5) base = palette[int(mod(onBlade - 1.0, 8.0))];
  }
  if (found && abs(owner.x - chosen) < 0.5) {
    // What was found must stay visible below the mark: thin lines on the picture, wide ones elsewhere.
    if (layer == 0) base = mix(clamp(encoded(paint.rgb * exposure), 0.0, 1.0), own, fract((gl_FragCoord.x + gl_FragCoord.y) / 14.0) < 0.16 ? 0.9 : 0.12);
    else base = mix(own, vec3(1.0), 0.35 * stripes(8.0));
  }
  if (!gl_FrontFacing) { base = mix(vec3(0.42, 0.43, 0.45), vec3(0.33, 0.34, 0.36), stripes(5.0)); }
  result = vec4(base * light, 1.0);
}`;

const VERTEX = /* glsl */ `
in vec4 tint;
in float support;
in float blade;
in vec2 mark;
out vec3 place;
out vec3 facing;
out vec4 paint;
out float seen;
flat out float onBlade;
flat out vec2 owner;
out float beyond;
void pass() {
  place = position;
  facing = normal;
  paint = tint;
  seen = support;
  onBlade = blade;
  owner = mark;
}`;

const ORBIT = /* glsl */ `
void main() {
  pass();
  beyond = 0.0;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
}`;

/**
 * The lens itself: each vertex goes to its own pixel, so the surface lies on the unmodified picture.
 * A triangle with a corner behind the camera or beyond the fold is not drawn.
 */
const LENS = /* glsl */ `
uniform vec4 pose[3];
uniform vec4 focus;
uniform vec4 radial;
uniform vec2 tangential;
uniform vec2 extent;
uniform vec2 depths;
uniform float fold;
uniform bool fisheye;
void main() {
  pass();
  vec4 here = vec4(position, 1.0);
  vec3 p = vec3(dot(pose[0], here), dot(pose[1], here), dot(pose[2], here));
  float across = length(p.xy);
  float angle = atan(across, p.z);
  float reach = fisheye ? angle : across / max(p.z, 1e-9);
  beyond = (p.z <= 1e-6 || reach >= fold || angle > 1.5) ? 1.0 : 0.0;
  vec2 at;
  if (fisheye) {
    float s = angle * angle;
    float radius = angle * (1.0 + s * (radial.x + s * (radial.y + s * (radial.z + s * radial.w))));
    at = across > 1e-9 ? p.xy * radius / across : vec2(0.0);
  } else {
    vec2 u = p.xy / max(p.z, 1e-9);
    float s = dot(u, u);
    at = u * (1.0 + s * (radial.x + s * radial.y)) + vec2(
      2.0 * tangential.x * u.x * u.y + tangential.y * (s + 2.0 * u.x * u.x),
      2.0 * tangential.y * u.x * u.y + tangential.x * (s + 2.0 * u.y * u.y));
  }
  vec2 pixel = at * focus.xy + focus.zw;
  float depth = (length(p) - depths.x) / (depths.y - depths.x);
  gl_Position = beyond > 0.0 ? vec4(3.0, 3.0, 3.0, 1.0)
    : vec4(2.0 * pixel.x / extent.x - 1.0, 1.0 - 2.0 * pixel.y / extent.y, 2.0 * depth - 1.0, 1.0);
}`;

function material(vertex: string, more: Record<string, { value: unknown }>): ShaderMaterial {
  return new ShaderMaterial({
    glslVersion: GLSL3,
    side: DoubleSide,
    vertexShader: VERTEX + vertex,
    fragmentShader: FRAGMENT,
    uniforms: {
      eye: { value: new Vector3() },
      layer: { value: 0 },
      chosen: { value: -2 },
      alone: { value: 0 },
      plane: { value: new Vector4(0, 0, 0, 1) },
      exposure: { value: 1 },
      palette: { value: PALETTE.map(([r, g, b]) => new Vector3(r / 255, g / 255, b / 255)) },
      ...more,
    },
  });
}

export const orbitMaterial = (): ShaderMaterial => material(ORBIT, {});

export const lensMaterial = (): ShaderMaterial =>
  material(LENS, {
    pose: { value: [new Vector4(), new Vector4(), new Vector4()] },
    focus: { value: new Vector4() },
    radial: { value: new Vector4() },
    tangential: { value: [0, 0] },
    extent: { value: [1, 1] },
    depths: { value: [0, 1] },
    fold: { value: 10 },
    fisheye: { value: true },
  });

export const layerNumber = (layer: Layer): number => LAYERS.indexOf(layer);

/** Common factor that brings the bright end of dark colours to a readable level; never darkens. */
export function exposureOf(color: Uint8Array): number {
  const levels: number[] = [];
  const step = 4 * Math.max(1, Math.floor(color.length / 4 / 20000));
  for (let k = 0; k < color.length; k += step) levels.push(((color[k] as number) + (color[k + 1] as number) + (color[k + 2] as number)) / 765);
  levels.sort((a, b) => a - b);
  const bright = levels[Math.floor(0.9 * levels.length)] ?? 1;
  return Math.min(6, Math.max(1, 0.5 / Math.max(bright, 1e-3)));
}

