/** The 3D view: the surface, the cameras that saw it, and where things lie on the screen. */

import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments, Mesh, Scene, Vector3, WebGLRenderer } from "three";
import type { Finding, Vec3 } from "../model/data";
import type { Layer } from "../model/hash";
import { direction } from "../model/lens";
import { toWorld, type Pose } from "../model/pose";
import { Orbit } from "./orbit";
import type { Questions } from "./questions";
import { exposureOf, layerNumber, orbitMaterial } from "./shading";
import type { Hit, Surface } from "./surface";

export interface Looks {
  readonly layer: Layer;
  readonly finding: number | null;
  readonly blade: number | null;
  readonly frame: number | null;
  readonly frusta: boolean;
  readonly clip: number;
}

export class View3D {
  readonly orbit: Orbit;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly material = orbitMaterial();
  private readonly cameras: LineSegments;
  private readonly current: LineSegments;
  private pending = 0;
  private clipShare = 0;
  /** Whether it still shows the whole surface as at first, which a new size must keep in sight. */
  private untouched = true;

  /** Throws where the browser offers no WebGL 2. `drawn` is called after each picture. */
  constructor(
    readonly canvas: HTMLCanvasElement,
    readonly surface: Surface,
    private readonly questions: Questions,
    private readonly home: { readonly up: Vec3 | null },
    private readonly drawn: () => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.material.uniforms["exposure"]!.value = exposureOf(surface.mesh.color);
    const mesh = new Mesh(surface.geometry, this.material);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    const poses = [...questions.poses.values()];
    this.cameras = lines(poses.flatMap((pose) => this.pyramid(pose, 0.04)), 0x808a94);
    this.cameras.visible = false;
    this.current = lines([], 0xd55e00);
    this.scene.add(this.cameras, this.current);
    this.orbit = new Orbit(this.up(), surface.radius, () => {
      this.untouched = false;
      this.request();
    });
    this.whole();
  }

  /** Draws again soon. */
  request(): void {
    this.pending ||= requestAnimationFrame(() => this.draw());
  }

  resize(width: number, height: number): void {
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.orbit.camera.aspect = width / height;
    if (this.untouched) this.whole();
    else this.orbit.changed();
  }

  show(looks: Looks): void {
    const uniforms = this.material.uniforms;
    uniforms["layer"]!.value = layerNumber(looks.layer);
    uniforms["chosen"]!.value = looks.finding ?? -2;
    uniforms["alone"]!.value = looks.blade ?? 0;
    this.clipShare = looks.clip;
    this.cameras.visible = looks.frusta;
    const pose = looks.frame === null ? undefined : this.questions.poses.get(looks.frame);
    this.current.geometry.dispose();
    this.current.geometry = segments(pose ? this.pyramid(pose, 0.09) : []);
    this.request();
  }

  /** The whole surface from the side that the cameras saw, their up being up. */
  whole(): void {
    const center = new Vector3(...this.surface.center);
    const forward = this.forward();
    const fit = this.surface.radius / Math.tan((35 * Math.PI) / 360) / Math.min(1, this.orbit.camera.aspect);
    this.orbit.place(center.clone().addScaledVector(forward, -1.1 * fit), center);
    this.untouched = true;
  }

  /** Comes near a finding, from where it was seen best. */
  near(finding: Finding, frame: number | null): void {
    const target = new Vector3(...finding.centroid);
    const pose = frame === null ? undefined : this.questions.poses.get(frame);
    const away = pose ? new Vector3(...pose.center).sub(target) : new Vector3(...(finding.normal ?? [0, 0, -1]));
    const size = Math.max(finding.size ?? 0, 0.06 * this.surface.radius);
    const length = Math.min(8 * size, pose ? Math.max(away.length(), 3 * size) : Infinity);
    const up = pose ? new Vector3(...toWorld(pose, [0, -1, 0])) : this.orbit.up;
    this.orbit.place(target.clone().add(away.setLength(length)), target, up);
  }

  /** Stands where the camera of a frame stood and looks where it looked. */
  from(frame: number): boolean {
    const { lens, crop } = this.questions;
    const pose = this.questions.poses.get(frame);
    if (!pose || !lens) return false;
    const eye = new Vector3(...pose.center);
    const ahead = new Vector3(...toWorld(pose, [0, 0, 1]));
    const hit = this.surface.cast(pose.center, ahead.toArray() as [number, number, number]);
    const length = hit?.distance ?? this.surface.radius;
    const edge = direction(lens, (crop[0] + crop[2]) / 2, crop[1]);
    const half = edge ? Math.atan2(Math.hypot(edge[0], edge[1]), edge[2]) : 0.5;
    this.orbit.place(eye, eye.clone().addScaledVector(ahead, length), new Vector3(...toWorld(pose, [0, -1, 0])), Math.min(110, (360 * half) / Math.PI));
    return true;
  }

  /** What lies under a pixel of the canvas, through the clip plane. */
  pick(x: number, y: number): Hit | null {
    const camera = this.orbit.camera;
    const at = new Vector3((2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight, 0.5).unproject(camera);
    const ray = at.sub(camera.position).normalize().toArray() as [number, number, number];
    const skip = this.clipShare > 0 ? this.clipDistance() / Math.max(1e-6, new Vector3(...ray).dot(this.ahead())) : 0;
    const from = camera.position.clone().addScaledVector(new Vector3(...ray), Math.max(0, skip));
    return this.surface.cast(from.toArray() as [number, number, number], ray);
  }

  /** Pixel of the canvas where a place lies, and whether the surface hides it; null behind the viewer. */
  screen(p: Vec3, asHidden: boolean): { readonly x: number; readonly y: number; readonly hidden: boolean } | null {
    const camera = this.orbit.camera;
    const at = new Vector3(...p).project(camera);
    if (at.z > 1 || Math.abs(at.x) > 1.05 || Math.abs(at.y) > 1.05) return null;
    if (this.clipShare > 0 && new Vector3(...p).sub(camera.position).dot(this.ahead()) < this.clipDistance()) return null;
    const eye = camera.position.toArray() as [number, number, number];
    // What the clip plane takes away hides nothing.
    const hidden = asHidden && this.clipShare === 0 && !this.surface.clear(eye, p, 0.02 * this.surface.radius);
    return { x: ((at.x + 1) / 2) * this.canvas.clientWidth, y: ((1 - at.y) / 2) * this.canvas.clientHeight, hidden };
  }

  /** A direction of the world on the screen: right, up, and towards the viewer. */
  onScreen(d: Vec3): Vec3 {
    return new Vector3(...d).applyQuaternion(this.orbit.camera.quaternion.clone().invert()).toArray() as [number, number, number];
  }

  private draw(): void {
    this.pending = 0;
    const uniforms = this.material.uniforms;
    const camera = this.orbit.camera;
    (uniforms["eye"]!.value as Vector3).copy(camera.position);
    const ahead = this.ahead();
    if (this.clipShare > 0) {
      const limit = ahead.dot(camera.position) + this.clipDistance();
      uniforms["plane"]!.value.set(-ahead.x, -ahead.y, -ahead.z, -limit);
    } else uniforms["plane"]!.value.set(0, 0, 0, 1);
    this.renderer.render(this.scene, camera);
    this.drawn();
  }

  private ahead(): Vector3 {
    return new Vector3(0, 0, -1).applyQuaternion(this.orbit.camera.quaternion);
  }

  private clipDistance(): number {
    const middle = new Vector3(...this.surface.center).sub(this.orbit.camera.position).dot(this.ahead());
    return middle + (2 * this.clipShare - 1) * this.surface.radius;
  }

  private forward(): Vector3 {
    const sum = new Vector3();
    for (const pose of this.questions.poses.values()) sum.add(new Vector3(...toWorld(pose, [0, 0, 1])));
    return sum.length() > 1e-3 * this.questions.poses.size ? sum.normalize() : new Vector3(0, 0, 1);
  }

  /** The pictures' up, made perpendicular enough to the first look that the view can turn about it. */
  private up(): Vector3 {
    const up = new Vector3(...(this.home.up ?? [0, -1, 0]));
    const forward = this.forward();
    const upright = up.clone().addScaledVector(forward, -up.dot(forward));
    return (upright.length() > 0.2 ? upright : up).normalize();
  }

  private pyramid(pose: Pose, share: number): Vec3[] {
    const { lens, crop } = this.questions;
    const length = share * this.surface.radius;
    const corners = ([[0, 1], [2, 1], [2, 3], [0, 3]] as const).map(([i, j]): Vec3 => {
      const d = (lens && direction(lens, crop[i], crop[j])) ?? [i ? 0.5 : -0.5, j > 1 ? 0.5 : -0.5, 0.7];
      const [x, y, z] = toWorld(pose, d);
      return [pose.center[0] + length * x, pose.center[1] + length * y, pose.center[2] + length * z];
    });
    return corners.flatMap((corner, k) => [pose.center, corner, corner, corners[(k + 1) % 4] as Vec3]);
  }
}

function segments(points: readonly Vec3[]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points.flat()), 3));
  return geometry;
}

function lines(points: readonly Vec3[], color: number): LineSegments {
  const made = new LineSegments(segments(points), new LineBasicMaterial({ color: new Color(color) }));
  made.frustumCulled = false;
  return made;
}
