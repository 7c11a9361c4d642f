/** The questions of `core.query`, asked in the page: what does a pixel show, and which frames see a place? */

import type { Box, Frame, Vec3 } from "../model/data";
import { direction, foldOf, project, type Lens } from "../model/lens";
import { dot, norm, poseOf, sub, toCamera, toWorld, type Pose } from "../model/pose";
import type { Surface } from "./surface";

/** What a pixel shows; without a point `reason` is a code of the detections' table. */
export type SurfaceHit =
  | { readonly reason: "frame_not_registered" | "outside_roi" | "off_surface" | "occluded" | "no_surface" }
  | {
      readonly reason: null;
      readonly point: Vec3;
      readonly normal: Vec3;
      readonly distance: number;
      readonly incidence_deg: number;
      readonly finding: number;
      readonly support: number;
    };

export interface VisibleFrame {
  readonly frame: number;
  /** cos(incidence) / squared distance, relative to the best frame. */
  readonly quality: number;
  /** Pixel of the source picture. */
  readonly x: number;
  readonly y: number;
}

/** A place must lie at least so far inside the used part of the picture, px; as in `core.mapping.consensus`. */
const RIM_PX = 4;
const MAX_INCIDENCE_DEG = 75;
const TOLERANCE_SPACINGS = 5;

export class Questions {
  readonly poses: ReadonlyMap<number, Pose>;
  private readonly fold: number;

  constructor(
    readonly lens: Lens | null,
    readonly crop: Box,
    frames: readonly Frame[],
    readonly surface: Surface | null,
    readonly spacing: number,
  ) {
    this.poses = new Map(frames.flatMap((frame) => (poseOf(frame) ? [[frame.index, poseOf(frame) as Pose] as const] : [])));
    this.fold = lens ? foldOf(lens) : 0;
  }

  /** What a pixel of a frame shows. */
  pointAt(frame: number, x: number, y: number): SurfaceHit {
    const pose = this.poses.get(frame);
    if (!pose || !this.lens) return { reason: "frame_not_registered" };
    const [x0, y0, x1, y1] = this.crop;
    if (!(x >= x0 && x <= x1 && y >= y0 && y <= y1)) return { reason: "outside_roi" };
    if (!this.surface) return { reason: "no_surface" };
    const ray = direction(this.lens, x, y);
    const hit = ray && this.surface.cast(pose.center, toWorld(pose, ray));
    if (!hit) return { reason: "off_surface" };
    if (hit.cosine <= 0) return { reason: "occluded" };
    const incidence_deg = (Math.acos(Math.min(1, hit.cosine)) * 180) / Math.PI;
    const { point, normal, distance, finding, support } = hit;
    return { reason: null, point, normal, distance, incidence_deg, finding, support };
  }

  /** Registered frames that see a place of the surface, best first. */
  visibleFrames(place: Vec3, normal: Vec3): VisibleFrame[] {
    const least = Math.cos((MAX_INCIDENCE_DEG * Math.PI) / 180);
    const visible: VisibleFrame[] = [];
    for (const pose of this.poses.values()) {
      const at = this.pixelOf(pose.frame, place);
      const [x0, y0, x1, y1] = this.crop;
      if (!at || !(at[0] > x0 + RIM_PX && at[0] < x1 - RIM_PX && at[1] > y0 + RIM_PX && at[1] < y1 - RIM_PX)) continue;
      const towards = sub(pose.center, place);
      const distance = norm(towards);
      const cosine = dot(towards, normal) / distance;
      if (cosine <= least || !this.surface?.clear(pose.center, place, TOLERANCE_SPACINGS * this.spacing)) continue;
      visible.push({ frame: pose.frame, quality: cosine / distance ** 2, x: at[0], y: at[1] });
    }
    const best = Math.max(...visible.map((one) => one.quality), 1e-300);
    return visible
      .map((one) => ({ ...one, quality: one.quality / best }))
      .sort((a, b) => b.quality - a.quality || a.frame - b.frame);
  }

  /** Pixel of the source picture where a frame shows a place, hidden or not; null outside its view. */
  pixelOf(frame: number, place: Vec3): [number, number] | null {
    const pose = this.poses.get(frame);
    return pose && this.lens ? project(this.lens, ...toCamera(pose, place), this.fold) : null;
  }

  /** Largest angle or tangent that the lens shows. */
  get limit(): number {
    return this.fold;
  }
}
