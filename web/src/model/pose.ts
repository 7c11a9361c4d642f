/** A registered camera: COLMAP's `cam_from_world` (x right, y down, z forward) and what follows from it. */

import type { Frame, Vec3 } from "./data";

export interface Pose {
  readonly frame: number;
  /** Row-major 3x4. */
  readonly m: readonly number[];
  readonly center: Vec3;
}

export function poseOf(frame: Frame): Pose | null {
  const m = frame.cam_from_world;
  if (!m || m.length !== 12) return null;
  const at = (k: number): number => m[k] as number;
  const column = (k: number): number => -(at(k) * at(3) + at(4 + k) * at(7) + at(8 + k) * at(11));
  return { frame: frame.index, m, center: [column(0), column(1), column(2)] };
}

/** A world point in the camera's frame. */
export function toCamera(pose: Pose, p: Vec3): [number, number, number] {
  const row = (k: number): number =>
    (pose.m[k] as number) * p[0] + (pose.m[k + 1] as number) * p[1] + (pose.m[k + 2] as number) * p[2] + (pose.m[k + 3] as number);
  return [row(0), row(4), row(8)];
}

/** A direction of the camera's frame in the world. */
export function toWorld(pose: Pose, d: Vec3): [number, number, number] {
  const column = (k: number): number =>
    (pose.m[k] as number) * d[0] + (pose.m[4 + k] as number) * d[1] + (pose.m[8 + k] as number) * d[2];
  return [column(0), column(1), column(2)];
}

export const sub = (a: Vec3, b: Vec3): [number, number, number] => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
