import { expect, test } from "vitest";
import { PALETTE, SHAPES } from "../src/model/marks";

type RGB = readonly number[];

/** Machado, Oliveira and Fernandes 2009, severity 1: linear RGB as people without one kind of cone see it. */
const BLINDNESS: Readonly<Record<string, readonly (readonly number[])[]>> = {
  none: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
};

const linear = (rgb: RGB): number[] => rgb.map((value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));

/** CIELAB (D65) of a colour as it is seen. */
function lab(rgb: RGB, matrix: readonly (readonly number[])[]): [number, number, number] {
  const from = linear(rgb);
  const times = (m: readonly (readonly number[])[], v: readonly number[]): number[] => m.map((row) => row.reduce((sum, value, k) => sum + value * v[k]!, 0));
  const seen = times(matrix, from).map((value) => Math.min(1, Math.max(0, value)));
  const xyz = times([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]], seen);
  const [x, y, z] = [xyz[0]! / 0.9505, xyz[1]!, xyz[2]! / 1.089].map((t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116)) as [number, number, number];
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/** CIEDE2000, after Sharma, Wu and Dalal 2005. */
function difference([l1, a1, b1]: readonly [number, number, number], [l2, a2, b2]: readonly [number, number, number]): number {
  const degrees = Math.PI / 180;
  const mean = (Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2;
  const g = 0.5 * (1 - Math.sqrt(mean ** 7 / (mean ** 7 + 25 ** 7)));
  const [p, q] = [(1 + g) * a1, (1 + g) * a2];
  const [c1, c2] = [Math.hypot(p, b1), Math.hypot(q, b2)];
  const hue = (b: number, a: number): number => (a === 0 && b === 0 ? 0 : (Math.atan2(b, a) / degrees + 360) % 360);
  const [h1, h2] = [hue(b1, p), hue(b2, q)];
  let turn = c1 * c2 === 0 ? 0 : h2 - h1;
  if (turn > 180) turn -= 360;
  if (turn < -180) turn += 360;
  const dh = 2 * Math.sqrt(c1 * c2) * Math.sin((turn / 2) * degrees);
  const [l, c] = [(l1 + l2) / 2, (c1 + c2) / 2];
  let h = h1 + h2;
  if (c1 * c2 !== 0) h = Math.abs(h1 - h2) <= 180 ? h / 2 : h < 360 ? (h + 360) / 2 : (h - 360) / 2;
  const t = 1 - 0.17 * Math.cos((h - 30) * degrees) + 0.24 * Math.cos(2 * h * degrees) + 0.32 * Math.cos((3 * h + 6) * degrees) - 0.2 * Math.cos((4 * h - 63) * degrees);
  const [sl, sc, sh] = [1 + (0.015 * (l - 50) ** 2) / Math.sqrt(20 + (l - 50) ** 2), 1 + 0.045 * c, 1 + 0.015 * c * t];
  const rt = -2 * Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7)) * Math.sin(60 * Math.exp(-(((h - 275) / 25) ** 2)) * degrees);
  const [x, y, z] = [(l2 - l1) / sl, (c2 - c1) / sc, dh / sh];
  return Math.sqrt(x * x + y * y + z * z + rt * y * z);
}

test("the difference of colours is CIEDE2000's", () => {
  expect(difference([50, 2.6772, -79.7751], [50, 0, -82.7485])).toBeCloseTo(2.0425, 4);
  expect(difference([50, 2.5, 0], [73, 25, -18])).toBeCloseTo(27.1492, 4);
  expect(difference([22.7233, 20.0904, -46.694], [23.0331, 14.973, -42.5619])).toBeCloseTo(2.0373, 4);
});

test.each(Object.entries(BLINDNESS))("%s: what was observed, weakly seen and not seen differ", (_, matrix) => {
  const [observed, weak, unseen] = [[115, 173, 219], [237, 153, 41], [87, 87, 87]].map((rgb) => lab(rgb, matrix)) as [number, number, number][];
  expect(Math.min(difference(observed!, weak!), difference(observed!, unseen!), difference(weak!, unseen!))).toBeGreaterThanOrEqual(15);
});

test.each(Object.entries(BLINDNESS))("%s: labels differ by colour or by shape", (_, matrix) => {
  const colors = PALETTE.map((rgb) => lab(rgb, matrix));
  const alike: string[] = [];
  colors.forEach((a, i) => colors.slice(0, i).forEach((b, j) => difference(a, b) < 15 && alike.push(`${j}-${i}: ${difference(a, b).toFixed(1)}`)));
  for (const pair of alike) {
    const [j, i] = pair.split(":")[0]!.split("-").map(Number) as [number, number];
    expect(SHAPES[i]).not.toBe(SHAPES[j]);
  }
});
