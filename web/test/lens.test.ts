import { expect, test } from "vitest";
import { direction, foldOf, makeLens, project } from "../src/model/lens";

const LENSES = [
  ["OPENCV_FISHEYE", [520.2, 519.8, 480, 360, 0.0416, 0.0063, -0.001, 0.0002]],
  ["SIMPLE_FISHEYE", [450, 320, 240]],
  ["OPENCV", [600, 610, 480, 350, -0.21, 0.05, 0.001, -0.002]],
  ["SIMPLE_RADIAL", [700, 480, 360, -0.1]],
  ["PINHOLE", [500, 501, 320, 240]],
] as const;

test.each(LENSES)("%s: a pixel's direction is projected back to it", (model, params) => {
  const lens = makeLens(model, params)!;
  for (const [px, py] of [[480, 360], [100, 80], [760, 590], [481, 20]] as const) {
    const ray = direction(lens, px, py)!;
    expect(Math.hypot(...ray)).toBeCloseTo(1, 10);
    const back = project(lens, 7 * ray[0], 7 * ray[1], 7 * ray[2])!;
    expect(back[0]).toBeCloseTo(px, 5);
    expect(back[1]).toBeCloseTo(py, 5);
  }
});

test("an undistorted fisheye measures the angle", () => {
  const lens = makeLens("SIMPLE_FISHEYE", [300, 320, 240])!;
  expect(project(lens, Math.sin(0.7), 0, Math.cos(0.7))![0]).toBeCloseTo(320 + 300 * 0.7, 9);
});

test("what the lens cannot show has no pixel and no direction", () => {
  const folding = makeLens("OPENCV_FISHEYE", [300, 300, 320, 240, -0.3, 0, 0, 0])!;
  expect(foldOf(folding)).toBeCloseTo(Math.sqrt(1 / 0.9), 2);
  expect(project(folding, Math.sin(1.3), 0, Math.cos(1.3))).toBeNull();
  expect(direction(folding, 320 + 300 * 1.2, 240)).toBeNull();
  expect(project(folding, 0, 0, -1)).toBeNull();
  expect(makeLens("UNKNOWN", [1, 2, 3])).toBeNull();
  expect(makeLens("PINHOLE", [1, 2, 3])).toBeNull();
});
