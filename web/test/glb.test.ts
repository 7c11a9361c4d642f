import { expect, test } from "vitest";
import { readGlb } from "../src/model/glb";

/** Two triangles, one of them a finding, positions quantised to unsigned shorts. */
function glb(version = 2): Uint8Array<ArrayBuffer> {
  const body = new ArrayBuffer(64);
  new Uint16Array(body, 0, 12).set([0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0]);
  new Int8Array(body, 24, 12).set([0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0]);
  new Uint32Array(body, 36, 3).set([0, 1, 2]);
  new Uint8Array(body, 48, 12).set([255, 0, 0, 0, 128, 0, 0, 0, 0, 0, 0, 0]);
  const node = (name: string, x: number) => ({ name, mesh: 0, translation: [x, 0, 5], scale: [2, 4, 1] });
  const document = {
    asset: { version: "2.0" },
    nodes: [{ name: "world", rotation: [1, 0, 0, 0], children: [1, 2] }, node("surface", 10), node("defect_7", 20)],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1, _SUPPORT: 3, _BLADE: 4 }, indices: 2 }] }],
    accessors: [
      { bufferView: 0, componentType: 5123, count: 3, type: "VEC3", normalized: true },
      { bufferView: 1, componentType: 5120, count: 3, type: "VEC3", normalized: true },
      { bufferView: 2, componentType: 5125, count: 3, type: "SCALAR" },
      { bufferView: 3, componentType: 5121, count: 3, type: "SCALAR", normalized: true },
      { componentType: 5121, count: 3, type: "SCALAR" },
    ],
    bufferViews: [
      { byteOffset: 0, byteLength: 24, byteStride: 8 },
      { byteOffset: 24, byteLength: 12, byteStride: 4 },
      { byteOffset: 36, byteLength: 12 },
      { byteOffset: 48, byteLength: 12, byteStride: 4 },
    ],
  };
  let text = JSON.stringify(document);
  text += " ".repeat((4 - (text.length % 4)) % 4);
  const bytes = new Uint8Array(28 + text.length + body.byteLength);
  const view = new DataView(bytes.buffer);
  [0x46546c67, version, bytes.length, text.length, 0x4e4f534a].forEach((value, k) => view.setUint32(4 * k, value, true));
  bytes.set(new TextEncoder().encode(text), 20);
  view.setUint32(20 + text.length, body.byteLength, true);
  view.setUint32(24 + text.length, 0x004e4942, true);
  bytes.set(new Uint8Array(body), 28 + text.length);
  return bytes;
}

test("all nodes become one mesh in the world", () => {
  const mesh = readGlb(glb());
  expect([...mesh.position]).toEqual([10, 0, 5, 12, 0, 5, 10, 4, 5, 20, 0, 5, 22, 0, 5, 20, 4, 5]);
  expect([...mesh.index]).toEqual([0, 1, 2, 3, 4, 5]);
  expect([...mesh.finding]).toEqual([-1, -1, -1, 7, 7, 7]);
  expect([...mesh.support]).toEqual([255, 128, 0, 255, 128, 0]);
  expect([...mesh.blade]).toEqual([0, 0, 0, 0, 0, 0]);
  expect(mesh.normal[2]).toBeCloseTo(1, 6);
});

test("another kind of file is refused", () => {
  expect(() => readGlb(glb(1))).toThrow("no binary glTF 2.0");
  expect(() => readGlb(new Uint8Array(40))).toThrow("no binary glTF 2.0");
});
