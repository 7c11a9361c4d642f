/** A viewer that walks around a target; turning is about the direction that is up in the pictures. */

import { PerspectiveCamera, Quaternion, Vector3 } from "three";

export class Orbit {
  readonly camera = new PerspectiveCamera(35, 1, 0.01, 100);
  readonly target = new Vector3();

  /** @param up direction that stays up, @param reach size of the scene, for the clipping distances */
  constructor(readonly up: Vector3, readonly reach: number, private readonly moved: () => void) {}

  get distance(): number {
    return this.camera.position.distanceTo(this.target);
  }

  /** Stands at `eye` and looks at `target`. */
  place(eye: Vector3, target: Vector3, up: Vector3 = this.up, fov = 35): void {
    this.camera.position.copy(eye);
    this.target.copy(target);
    this.camera.up.copy(up);
    this.camera.lookAt(target);
    this.camera.fov = fov;
    this.changed();
  }

  /** Walks around the target by angles in rad. */
  turn(yaw: number, pitch: number): void {
    const right = new Vector3(1, 0, 0).applyQuaternion(this.camera.quaternion);
    const forward = new Vector3(0, 0, -1).applyQuaternion(this.camera.quaternion);
    const leaning = Math.acos(Math.max(-1, Math.min(1, forward.dot(this.up))));
    // Stops short of the pole, where left and right would change places.
    const tilt = Math.max(-(leaning - 0.05), Math.min(Math.PI - 0.05 - leaning, -pitch));
    const way = new Quaternion().setFromAxisAngle(this.up, yaw).multiply(new Quaternion().setFromAxisAngle(right, -tilt));
    this.camera.position.sub(this.target).applyQuaternion(way).add(this.target);
    this.camera.quaternion.premultiply(way);
    this.changed();
  }

  /** Shifts view and target by shares of the picture's height. */
  pan(dx: number, dy: number): void {
    const height = 2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360);
    const shift = new Vector3(-dx * height, dy * height, 0).applyQuaternion(this.camera.quaternion);
    this.camera.position.add(shift);
    this.target.add(shift);
    this.changed();
  }

  /** Comes nearer (factor below 1) or goes away. */
  zoom(factor: number): void {
    const length = Math.min(20 * this.reach, Math.max(1e-3 * this.reach, this.distance * factor));
    const away = this.camera.position.clone().sub(this.target).setLength(length);
    this.camera.position.copy(this.target).add(away);
    this.changed();
  }

  /** Position, target, up and field of view as ten numbers. */
  get numbers(): number[] {
    const up = new Vector3(0, 1, 0).applyQuaternion(this.camera.quaternion);
    return [...this.camera.position.toArray(), ...this.target.toArray(), ...up.toArray(), this.camera.fov];
  }

  set numbers(values: readonly number[]) {
    const [a = 0, b = 0, c = 0, d = 0, e = 0, f = 0, g = 0, h = 0, i = 0, fov = 35] = values;
    this.place(new Vector3(a, b, c), new Vector3(d, e, f), new Vector3(g, h, i), fov);
  }

  /** After the size of the window or anything else of the camera changed. */
  changed(): void {
    const far = this.camera.position.distanceTo(this.target) + 4 * this.reach;
    this.camera.near = Math.max(far / 20000, 1e-3 * this.reach);
    this.camera.far = far;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.moved();
  }
}

/** Drag turns, right or shift drag shifts, wheel and pinch zoom; a press that does not move is a click. */
export function handle(element: HTMLElement, orbit: Orbit, click: (x: number, y: number) => void): () => void {
  const pointers = new Map<number, { x: number; y: number }>();
  let travelled = 0;
  const size = (): number => element.clientHeight || 1;
  const down = (event: PointerEvent): void => {
    element.setPointerCapture(event.pointerId);
    if (!pointers.size) travelled = 0;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  };
  const move = (event: PointerEvent): void => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
    travelled += Math.hypot(dx, dy);
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1] ?? before;
      const spread = (x: number, y: number): number => Math.hypot(x - other.x, y - other.y) || 1;
      orbit.zoom(spread(before.x, before.y) / spread(event.clientX, event.clientY));
      orbit.pan(dx / 2 / size(), dy / 2 / size());
    } else if (event.buttons & 2 || event.shiftKey) orbit.pan(dx / size(), dy / size());
    else if (travelled > 4) orbit.turn((-dx / size()) * 3.5, (-dy / size()) * 3.5);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  };
  const up = (event: PointerEvent): void => {
    if (pointers.delete(event.pointerId) && !pointers.size && travelled <= 4 && event.button === 0) {
      const box = element.getBoundingClientRect();
      click(event.clientX - box.left, event.clientY - box.top);
    }
  };
  const cancel = (event: PointerEvent): void => void pointers.delete(event.pointerId);
  const wheel = (event: WheelEvent): void => {
    event.preventDefault();
    orbit.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 400))));
  };
  const menu = (event: Event): void => event.preventDefault();
  element.addEventListener("pointerdown", down);
  element.addEventListener("pointermove", move);
  element.addEventListener("pointerup", up);
  element.addEventListener("pointercancel", cancel);
  element.addEventListener("wheel", wheel, { passive: false });
  element.addEventListener("contextmenu", menu);
  return () => {
    element.removeEventListener("pointerdown", down);
    element.removeEventListener("pointermove", move);
    element.removeEventListener("pointerup", up);
    element.removeEventListener("pointercancel", cancel);
    element.removeEventListener("wheel", wheel);
    element.removeEventListener("contextmenu", menu);
  };
}
