/**
 * The surface from binary glTF 2.0 with `KHR_mesh_quantization`, all nodes as one mesh.
 * A mesh node's own matrix takes positions to the world of `viewer.json`; the root's turn to glTF's y-up is left out.
 */

export interface MeshArrays {
  /** (3 n) world coordinates. */
  readonly position: Float32Array;
  /** (3 n) unit. */
  readonly normal: Float32Array;
  /** (4 n) linear, 0-255. */
  readonly color: Uint8Array;
  /** (n) 0-255. */
  readonly support: Uint8Array;
  /** (n) number of the blade, 0 none. */
  readonly blade: Uint8Array;
  /** (n) number of the finding, -1 none. */
  readonly finding: Int32Array;
  readonly index: Uint32Array;
}

interface Accessor {
  bufferView?: number;
  byteOffset?: number;
  componentType: number;
  count: number;
  type: string;
  normalized?: boolean;
}
interface Document {
  nodes: { name?: string; mesh?: number; matrix?: number[]; translation?: number[]; rotation?: number[]; scale?: number[] }[];
  meshes: { primitives: { attributes: Record<string, number>; indices?: number }[] }[];
  accessors: Accessor[];
  bufferViews: { byteOffset?: number; byteLength: number; byteStride?: number }[];
}

const WIDTH: Readonly<Record<string, number>> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const LARGEST: Readonly<Record<number, number>> = { 5120: 127, 5121: 255, 5122: 32767, 5123: 65535, 5125: 4294967295, 5126: 1 };
const BYTES: Readonly<Record<number, number>> = { 5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4 };
const JSON_CHUNK = 0x4e4f534a;

/** Throws for a file that is no binary glTF of version 2. */
export function readGlb(bytes: Uint8Array<ArrayBuffer>): MeshArrays {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (view.getUint32(0, true) !== 0x46546c67 || view.getUint32(4, true) !== 2 || view.getUint32(16, true) !== JSON_CHUNK) {
    throw new Error("surface.glb is no binary glTF 2.0");
  }
  const length = view.getUint32(12, true);
  const document = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length))) as Document;
  const start = 20 + length + 8;
  const parts = document.nodes.flatMap((node) => {
    const primitives = node.mesh === undefined ? [] : (document.meshes[node.mesh]?.primitives ?? []);
    return primitives.map((primitive) => ({ node, primitive }));
  });
  const count = (name: "POSITION" | null): number =>
    parts.reduce((sum, { primitive }) => sum + (document.accessors[(name ? primitive.attributes[name] : primitive.indices) ?? -1]?.count ?? 0), 0);
  const n = count("POSITION");
  const mesh: MeshArrays = {
    position: new Float32Array(3 * n),
    normal: new Float32Array(3 * n),
    color: new Uint8Array(4 * n).fill(160),
    support: new Uint8Array(n).fill(255),
    blade: new Uint8Array(n),
    finding: new Int32Array(n).fill(-1),
    index: new Uint32Array(count(null)),
  };
  let [vertex, corner] = [0, 0];
  for (const { node, primitive } of parts) {
    const read = (name: string): Float32Array | null => {
      const at = primitive.attributes[name];
      return at === undefined ? null : values(document, view, start, at);
    };
    const position = read("POSITION") ?? new Float32Array(0);
    const m = matrixOf(node);
    const own = position.length / 3;
    for (let k = 0; k < own; k++) {
      for (let row = 0; row < 3; row++) {
        let sum = m[12 + row] as number;
        for (let axis = 0; axis < 3; axis++) sum += (m[4 * axis + row] as number) * (position[3 * k + axis] as number);
        mesh.position[3 * (vertex + k) + row] = sum;
      }
    }
    const normal = read("NORMAL");
    if (normal) mesh.normal.set(normal, 3 * vertex);
    const color = read("COLOR_0");
    if (color) copyColors(color, color.length / own, mesh.color, 4 * vertex);
    const support = read("_SUPPORT");
    if (support) mesh.support.set(support.map((value) => Math.round(255 * value)), vertex);
    const blade = read("_BLADE");
    if (blade) mesh.blade.set(blade, vertex);
    const named = /^defect_(\d+)$/.exec(node.name ?? "");
    if (named) mesh.finding.fill(Number(named[1]), vertex, vertex + own);
    if (primitive.indices !== undefined) {
      const index = values(document, view, start, primitive.indices, true);
      for (let k = 0; k < index.length; k++) mesh.index[corner + k] = (index[k] as number) + vertex;
      corner += index.length;
    }
    vertex += own;
  }
  return mesh;
}

function copyColors(from: Float32Array, width: number, to: Uint8Array, start: number): void {
  for (let k = 0; k < from.length / width; k++) {
    for (let c = 0; c < 3; c++) to[start + 4 * k + c] = Math.round(255 * (from[width * k + c] as number));
    to[start + 4 * k + 3] = 255;
  }
}

function values(document: Document, view: DataView, start: number, at: number, whole: true): Float64Array;
function values(document: Document, view: DataView, start: number, at: number): Float32Array;
/** Numbers of an accessor; normalised ones in [-1, 1], zeros where it has no buffer. */
function values(document: Document, view: DataView, start: number, at: number, whole = false): Float32Array | Float64Array {
  const accessor = document.accessors[at] as Accessor;
  const width = WIDTH[accessor.type] ?? 1;
  const out = whole ? new Float64Array(width * accessor.count) : new Float32Array(width * accessor.count);
  const buffer = accessor.bufferView === undefined ? undefined : document.bufferViews[accessor.bufferView];
  if (!buffer) return out;
  const size = BYTES[accessor.componentType] as number;
  const stride = buffer.byteStride ?? width * size;
  const offset = start + (buffer.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
  const scale = accessor.normalized ? 1 / (LARGEST[accessor.componentType] as number) : 1;
  const read = reader(view, accessor.componentType);
  for (let k = 0; k < accessor.count; k++) {
    for (let c = 0; c < width; c++) out[width * k + c] = read(offset + k * stride + c * size) * scale;
  }
  return out;
}

function reader(view: DataView, kind: number): (at: number) => number {
  switch (kind) {
    case 5120:
      return (at) => view.getInt8(at);
    case 5121:
      return (at) => view.getUint8(at);
    case 5122:
      return (at) => view.getInt16(at, true);
    case 5123:
      return (at) => view.getUint16(at, true);
    case 5125:
      return (at) => view.getUint32(at, true);
    case 5126:
      return (at) => view.getFloat32(at, true);
    default:
      throw new Error(`surface.glb has components of the unknown kind ${kind}`);
  }
}

/** Column-major 4x4 of a node: its matrix, or translation, rotation and scale. */
function matrixOf(node: Document["nodes"][number]): readonly number[] {
  if (node.matrix) return node.matrix;
  const [tx = 0, ty = 0, tz = 0] = node.translation ?? [];
  const [x = 0, y = 0, z = 0, w = 1] = node.rotation ?? [];
  const [sx = 1, sy = 1, sz = 1] = node.scale ?? [];
  return [
    (1 - 2 * (y * y + z * z)) * sx, 2 * (x * y + z * w) * sx, 2 * (x * z - y * w) * sx, 0,
    2 * (x * y - z * w) * sy, (1 - 2 * (x * x + z * z)) * sy, 2 * (y * z + x * w) * sy, 0,
    2 * (x * z + y * w) * sz, 2 * (y * z - x * w) * sz, (1 - 2 * (x * x + y * y)) * sz, 0,
    tx, ty, tz, 1,
  ];
}
