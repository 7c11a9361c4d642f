/** Length of the way between two places along the surface's edges (Dijkstra 1959), smoothed where it zigzags. */

import type { Vec3 } from "../model/data";
import { norm, sub } from "../model/pose";
import type { Surface } from "./surface";

let neighbours: { readonly mesh: unknown; readonly start: Uint32Array; readonly other: Uint32Array } | null = null;

/** Model units; null where no way leads from one to the other. Edges make it too long by some per cent at most. */
export function pathAlong(surface: Surface, a: Vec3, b: Vec3): number | null {
  const [from, to] = [surface.nearest(a)?.vertex, surface.nearest(b)?.vertex];
  if (from === undefined || to === undefined) return null;
  const { start, other } = edges(surface);
  const position = surface.mesh.position;
  const at = (k: number): Vec3 => [position[3 * k] as number, position[3 * k + 1] as number, position[3 * k + 2] as number];
  const best = new Float64Array(start.length - 1).fill(Infinity);
  const came = new Int32Array(start.length - 1).fill(-1);
  const goal = at(to);
  const heap = new Heap();
  best[from] = 0;
  heap.push(norm(sub(at(from), goal)), from);
  for (let node = heap.pop(); node !== null; node = heap.pop()) {
    if (node === to) break;
    const here = at(node);
    for (let k = start[node] as number; k < (start[node + 1] as number); k++) {
      const next = other[k] as number;
      const place = at(next);
      const length = (best[node] as number) + norm(sub(place, here));
      if (length < (best[next] as number)) {
        best[next] = length;
        came[next] = node;
        heap.push(length + norm(sub(place, goal)), next);
      }
    }
  }
  if (best[to] === Infinity) return null;
  const way: [number, number, number][] = [[...a]];
  const nodes: number[] = [];
  for (let node = to; node !== -1; node = came[node] as number) nodes.push(node);
  for (const node of nodes.reverse()) way.push([...at(node)] as [number, number, number]);
  way.push([...b]);
  return smoothed(way);
}

/** Length after each inner place has moved to the middle of its neighbours a few times: edges only go three ways. */
function smoothed(way: [number, number, number][]): number {
  for (let round = 0; round < 4; round++) {
    for (let k = 1; k < way.length - 1; k++) {
      const [p, q, r] = [way[k - 1], way[k], way[k + 1]] as [number[], [number, number, number], number[]];
      for (let axis = 0; axis < 3; axis++) q[axis] = 0.5 * (q[axis] as number) + 0.25 * ((p[axis] as number) + (r[axis] as number));
    }
  }
  let sum = 0;
  for (let k = 1; k < way.length; k++) sum += norm(sub(way[k] as Vec3, way[k - 1] as Vec3));
  return sum;
}

function edges(surface: Surface): { readonly start: Uint32Array; readonly other: Uint32Array } {
  if (neighbours?.mesh === surface.mesh) return neighbours;
  const { index, finding } = surface.mesh;
  // Patches are nodes of their own: places that coincide are one.
  const same = welded(surface.mesh.position);
  const start = new Uint32Array(finding.length + 1);
  const pairs = (use: (a: number, b: number) => void): void => {
    for (let k = 0; k < index.length; k += 3) {
      const [a, b, c] = [index[k], index[k + 1], index[k + 2]] as [number, number, number];
      for (const [p, q] of [[a, b], [b, c], [c, a]] as const) {
        use(p, q);
        use(q, p);
      }
    }
    same.forEach((first, k) => {
      if (first !== k) {
        use(first, k);
        use(k, first);
      }
    });
  };
  pairs((a) => (start[a + 1] as number, start[a + 1]!++));
  for (let k = 1; k < start.length; k++) start[k]! += start[k - 1] as number;
  const other = new Uint32Array(start[start.length - 1] as number);
  const fill = start.slice();
  pairs((a, b) => (other[fill[a]!++] = b));
  neighbours = { mesh: surface.mesh, start, other };
  return neighbours;
}

function welded(position: Float32Array): Uint32Array {
  const first = new Map<string, number>();
  return Uint32Array.from({ length: position.length / 3 }, (_, k) => {
    const key = `${position[3 * k]},${position[3 * k + 1]},${position[3 * k + 2]}`;
    const known = first.get(key);
    if (known === undefined) first.set(key, k);
    return known ?? k;
  });
}

class Heap {
  private readonly keys: number[] = [];
  private readonly nodes: number[] = [];

  push(key: number, node: number): void {
    let at = this.keys.length;
    while (at > 0) {
      const up = (at - 1) >> 1;
      if ((this.keys[up] as number) <= key) break;
      this.keys[at] = this.keys[up] as number;
      this.nodes[at] = this.nodes[up] as number;
      at = up;
    }
    this.keys[at] = key;
    this.nodes[at] = node;
  }

  pop(): number | null {
    const top = this.nodes[0];
    const [key, node] = [this.keys.pop(), this.nodes.pop()];
    if (top === undefined || key === undefined || node === undefined) return null;
    const count = this.keys.length;
    if (!count) return top;
    let at = 0;
    for (;;) {
      let child = 2 * at + 1;
      if (child >= count) break;
      if (child + 1 < count && (this.keys[child + 1] as number) < (this.keys[child] as number)) child += 1;
      if ((this.keys[child] as number) >= key) break;
      this.keys[at] = this.keys[child] as number;
      this.nodes[at] = this.nodes[child] as number;
      at = child;
    }
    this.keys[at] = key;
    this.nodes[at] = node;
    return top;
  }
}
