/** The state of the page in its address: `#d=1&f=87&layer=support`. */

export const LAYERS = ["picture", "support", "defect", "blade"] as const;
export type Layer = (typeof LAYERS)[number];
export const TABS = ["findings", "frames", "detections"] as const;
export type Tab = (typeof TABS)[number];

export interface Place {
  readonly tab: Tab;
  /** Number of the finding; of one that people made, below zero. */
  readonly d: number | null;
  /** Index of the frame. */
  readonly f: number | null;
  /** Number of the detection. */
  readonly n: number | null;
  /** A point of the surface. */
  readonly p: readonly [number, number, number] | null;
  /** Blade that stands alone. */
  readonly b: number | null;
  readonly layer: Layer;
  /** Position, target, up, field of view of the 3D view. */
  readonly cam: readonly number[] | null;
}

export const NOWHERE: Place = { tab: "findings", d: null, f: null, n: null, p: null, b: null, layer: "picture", cam: null };

/** Reads a fragment; parts that are not understood are as if absent. */
export function parseHash(hash: string): Place {
  const words = new URLSearchParams(hash.replace(/^#/, ""));
  const whole = (name: string): number | null => {
    const text = words.get(name);
    return text !== null && (name === "d" ? /^-?\d{1,9}$/ : /^\d{1,9}$/).test(text) ? Number(text) : null;
  };
  const list = (name: string, count: number): number[] | null => {
    const values = (words.get(name) ?? "").split(",").map((text) => (text.trim() ? Number(text) : NaN));
    return values.length === count && values.every(Number.isFinite) ? values : null;
  };
  return {
    tab: TABS.find((tab) => tab === words.get("tab")) ?? "findings",
    d: whole("d"),
    f: whole("f"),
    n: whole("n"),
    p: list("p", 3) as [number, number, number] | null,
    b: whole("b"),
    layer: LAYERS.find((layer) => layer === words.get("layer")) ?? "picture",
    cam: list("cam", 10),
  };
}

/** The fragment of a state, without what is as usual. */
export function formatHash(place: Place): string {
  const words: string[] = [];
  if (place.tab !== "findings") words.push(`tab=${place.tab}`);
  for (const name of ["d", "f", "n", "b"] as const) {
    const value = place[name];
    if (value !== null) words.push(`${name}=${value}`);
  }
  if (place.p) words.push(`p=${numbers(place.p)}`);
  if (place.layer !== "picture") words.push(`layer=${place.layer}`);
  if (place.cam) words.push(`cam=${numbers(place.cam)}`);
  return `#${words.join("&")}`;
}

function numbers(values: readonly number[]): string {
  return values.map((value) => String(Number(value.toPrecision(6)))).join(",");
}
