/** A colour and a shape for every label, by alphabet: shapes tell them apart where colours do not. */

/** Those of the gallery (`core.gallery.palette`), 0-255. */
export const PALETTE: readonly (readonly [number, number, number])[] = [
  [255, 176, 0],
  [86, 180, 233],
  [240, 90, 160],
  [0, 200, 150],
  [190, 130, 255],
  [240, 228, 66],
  [255, 110, 60],
  [160, 220, 90],
];

/** Outlines in a square from -1 to 1. */
export const SHAPES: readonly string[] = [
  "M1 0A1 1 0 1 1-1 0A1 1 0 1 1 1 0Z",
  "M-.85-.85H.85V.85H-.85Z",
  "M0-1L1 .85H-1Z",
  "M0-1.1L1.1 0L0 1.1L-1.1 0Z",
  "M-.35-1H.35V-.35H1V.35H.35V1H-.35V.35H-1V-.35H-.35Z",
  "M0 1L-1-.85H1Z",
  "M-.5-.9H.5L1 0L.5 .9H-.5L-1 0Z",
  "M0-1.1L.3-.35L1.1-.3L.5 .2L.7 1L0 .55L-.7 1L-.5 .2L-1.1-.3L-.3-.35Z",
];

export interface Mark {
  readonly index: number;
  readonly css: string;
  readonly shape: string;
}

export function marksOf(labels: Iterable<string>): ReadonlyMap<string, Mark> {
  const sorted = [...new Set(labels)].sort();
  return new Map(sorted.map((label, k) => [label, markAt(k)]));
}

function markAt(k: number): Mark {
  const index = k % PALETTE.length;
  return { index, css: `rgb(${(PALETTE[index] ?? [128, 128, 128]).join(" ")})`, shape: SHAPES[(k + Math.floor(k / PALETTE.length)) % SHAPES.length] as string };
}
