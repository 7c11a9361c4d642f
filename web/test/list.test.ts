import { expect, test } from "vitest";
import type { Finding } from "../src/model/data";
import { marksOf } from "../src/model/marks";
import { visibleRow } from "../src/model/row";
import { byRank } from "../src/model/sorting";
import { certainty, confidenceReasons, measured, scaled } from "../src/model/words";

function finding(id: number, more: Partial<Finding> = {}): Finding {
  return {
    id, label: "dent", model: 0, centroid: [0, 0, 0], confidence: null, persistence: { k: 1, n: 2, share: 0.5 },
    events: [], detections: [], frames: [], node: null, best_frames: [], size: null, size_sigma: null, ...more,
  };
}

test("unknown sizes come last in either direction", () => {
  const list = [finding(0), finding(1, { size: 2 }), finding(2, { size: 5 }), finding(3, { size: 2 })];
  expect([...list].sort(byRank("size", true)).map((one) => one.id)).toEqual([2, 1, 3, 0]);
  expect([...list].sort(byRank("size", false)).map((one) => one.id)).toEqual([1, 3, 2, 0]);
});

test("a length ranks before the extent, blades by number", () => {
  const list = [finding(0, { size: 9, length: 1, blade: "10" }), finding(1, { size: 2, blade: "2" })];
  expect([...list].sort(byRank("size", true)).map((one) => one.id)).toEqual([1, 0]);
  expect([...list].sort(byRank("blade", false)).map((one) => one.id)).toEqual([1, 0]);
});

test("the first visit decides the order by time", () => {
  const visit = (start_s: number, video = 0) => [{ event_id: 0, defect_id: 0, label: "", start_s, end_s: 9, n_detections: 1, n_frames: 1, video }];
  const visits = new Map([[0, visit(1, 1)], [1, visit(5)]]);
  expect([finding(0), finding(1), finding(2)].sort(byRank("time", false, visits)).map((one) => one.id)).toEqual([1, 0, 2]);
});

test("millimetres are shown in inches where these are wanted, and nothing else is", () => {
  expect(measured(25.4, 2.54, "mm", "in")).toBe("1.00 ± 0.10 in");
  expect(measured(645.16, 64.516, "mm²", "in")).toBe("1.00 ± 0.10 in²");
  expect(measured(25.4, 2.54, "model", "in")).toBe("25.4 ± 2.5");
});

test("a length on the surface has millimetres with a scale only", () => {
  const model = { index: 0, count: 1, unit: "mm", scale: 2, scale_sigma: 0.1 };
  expect(scaled(10, 0.5, model)).toEqual({ value: 20, sigma: Math.hypot(1, 1), unit: "mm" });
  expect(scaled(10, 0.5, { ...model, unit: "model", scale: null })).toEqual({ value: 10, sigma: 0.5, unit: "model" });
});

test("numbers are rounded by their uncertainty", () => {
  expect(measured(0.98209, 0.04736, "model")).toBe("0.982 ± 0.047");
  expect(measured(12.34, 1.2, "mm")).toBe("12.3 ± 1.2 mm");
  expect(measured(12.3456, null, "mm")).toBe("12.3 mm");
  expect(measured(null, null, "mm")).toBe("unknown");
  expect([0.9, 0.5, 0.1].map(certainty)).toEqual(["high", "medium", "low"]);
});

test("the largest doubt about a finding is said first", () => {
  const parts = { views_visible: 10, views_support: 9, views_same_label: 3, peers: 4, cosine: 0.9, model_doubts: 2 };
  const said = confidenceReasons(finding(0, { confidence: { value: 0.4, parts } }));
  expect(said[0]).toBe("The checks raise 2 warnings about the whole model.");
  expect(said[1]).toBe("3 of these 9 give it the same label.");
});

test("labels keep colour and shape, and differ", () => {
  const marks = marksOf(["b", "a", "b", "c"]);
  expect([...marks.keys()]).toEqual(["a", "b", "c"]);
  expect(new Set([...marks.values()].map((mark) => mark.shape)).size).toBe(3);
  const many = marksOf(Array.from({ length: 20 }, (_, k) => `label ${String(k).padStart(2, "0")}`));
  expect(new Set([...many.values()].map((mark) => mark.css + mark.shape)).size).toBe(20);
});

test("the tip is away from the axis when the root is inside, and nothing is drawn of an unknown row", () => {
  const row = { status: "estimated", axis: [0, 0, 1], point: [0, 0, 0], root: "inside" };
  expect(visibleRow(row, [0, 4, 9])?.tip).toEqual([0, 1, 0]);
  expect(visibleRow({ ...row, root: "outside" }, [-2, 0, 9])?.tip[0]).toBe(1);
  expect(visibleRow({ ...row, root: null }, [3, 4, 9])).toBeNull();
  expect(visibleRow({ ...row, status: "unknown" }, [3, 4, 9])).toBeNull();
});
