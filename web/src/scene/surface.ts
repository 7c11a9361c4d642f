/** The surface that rays are cast upon: first hits, and whether anything hides a place. */

import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Vector3 } from "three";
import { MeshBVH } from "three-mesh-bvh";
import type { Vec3 } from "../model/data";
import type { MeshArrays } from "../model/glb";

export interface Hit {
  readonly point: Vec3;
  readonly distance: number;
  /** Unit normal of the face. */
  readonly normal: Vec3;
  /** Of the angle between normal and the way back; negative = the face is seen from behind. */
  readonly cosine: number;
  /** Of the nearest corner, -1 none. */
  readonly finding: number;
  /** Of the nearest corner, in [0, 1]. */
  readonly support: number;
  readonly vertex: number;
}

export class Surface {
  readonly geometry = new BufferGeometry();
  readonly center: Vec3;
  /** Of the sphere around `center` that holds all but the outermost vertices. */
  readonly radius: number;
  private readonly bvh: MeshBVH;
  private readonly ray = new Ray();

  /**
   * @param mesh its arrays are kept
   * @param marks colour index of every finding, by its number
   */
  constructor(readonly mesh: MeshArrays, marks: ReadonlyMap<number, number>) {
    const n = mesh.finding.length;
    const mark = new Float32Array(2 * n);
    mesh.finding.forEach((finding, k) => {
      mark[2 * k] = finding;
      mark[2 * k + 1] = finding < 0 ? -1 : (marks.get(finding) ?? 0);
    });
    this.geometry.setAttribute("position", new BufferAttribute(mesh.position, 3));
    this.geometry.setAttribute("normal", new BufferAttribute(mesh.normal, 3));
    this.geometry.setAttribute("tint", new BufferAttribute(mesh.color, 4, true));
    this.geometry.setAttribute("support", new BufferAttribute(mesh.support, 1, true));
    this.geometry.setAttribute("blade", new BufferAttribute(mesh.blade, 1));
    this.geometry.setAttribute("mark", new BufferAttribute(mark, 2));
    this.geometry.setIndex(new BufferAttribute(mesh.index, 1));
    this.bvh = new MeshBVH(this.geometry);
    [this.center, this.radius] = robustSphere(mesh.position);
  }

  /** First hit of a ray; `direction` is of unit length. */
  cast(origin: Vec3, direction: Vec3): Hit | null {
    this.ray.origin.set(...origin);
    this.ray.direction.set(...direction);
    const found = this.bvh.raycastFirst(this.ray, DoubleSide);
    if (!found?.face) return null;
    const { a, b, c } = found.face;
    const [p, q, r] = [this.vertex(a), this.vertex(b), this.vertex(c)];
    const normal = q.clone().sub(p).cross(r.clone().sub(p)).normalize();
    const nearest = [a, b, c].reduce((best, k) => (this.vertex(k).distanceToSquared(found.point) < this.vertex(best).distanceToSquared(found.point) ? k : best), a);
    return {
      point: found.point.toArray() as [number, number, number],
      distance: found.distance,
      normal: normal.toArray() as [number, number, number],
      cosine: -normal.dot(this.ray.direction),
      finding: this.mesh.finding[nearest] as number,
      support: (this.mesh.support[nearest] as number) / 255,
      vertex: nearest,
    };
  }

  /** Whether nothing lies between two places, but for `tolerance` before the second. */
  clear(from: Vec3, to: Vec3, tolerance: number): boolean {
    this.ray.origin.set(...from);
    const way = new Vector3(...to).sub(this.ray.origin);
    const distance = way.length();
    this.ray.direction.copy(way.divideScalar(distance || 1));
    const found = this.bvh.raycastFirst(this.ray, DoubleSide);
    return !found || found.distance >= distance - tolerance;
  }

  /** Nearest vertex-based normal at a place: that of the closest point of the surface. */
  nearest(place: Vec3): { readonly point: Vec3; readonly normal: Vec3; readonly distance: number; readonly vertex: number } | null {
    const found = this.bvh.closestPointToPoint(new Vector3(...place));
    if (!found) return null;
    const index = this.mesh.index;
    const [a, b, c] = [0, 1, 2].map((k) => index[3 * found.faceIndex + k] as number) as [number, number, number];
    const [p, q, r] = [this.vertex(a), this.vertex(b), this.vertex(c)];
    const normal = q.clone().sub(p).cross(r.sub(p)).normalize();
    return { point: found.point.toArray() as [number, number, number], normal: normal.toArray() as [number, number, number], distance: found.distance, vertex: a };
  }

  private vertex(k: number): Vector3 {
    return new Vector3().fromArray(this.mesh.position, 3 * k);
  }
}

/** Middle and radius of all but one in fifty vertices: stray ones far away must not push the rest into a corner. */
function robustSphere(position: Float32Array): [Vec3, number] {
  const n = position.length / 3;
  const step = Math.max(1, Math.floor(n / 20000));
  const middle = [0, 1, 2].map((axis) => {
    const values: number[] = [];
    for (let k = 0; k < n; k += step) values.push(position[3 * k + axis] as number);
    values.sort((a, b) => a - b);
    const at = (share: number): number => values[Math.min(values.length - 1, Math.floor(share * values.length))] ?? 0;
    return (at(0.02) + at(0.98)) / 2;
  }) as [number, number, number];
  const distances: number[] = [];
  for (let k = 0; k < n; k += step) {
    distances.push(Math.hypot((position[3 * k] as number) - middle[0], (position[3 * k + 1] as number) - middle[1], (position[3 * k + 2] as number) - middle[2]));
  }
  distances.sort((a, b) => a - b);
  return [middle, distances[Math.min(distances.length - 1, Math.floor(0.98 * distances.length))] || 1];
}
