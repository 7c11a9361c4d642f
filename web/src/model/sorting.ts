/** Orders of the list of findings. */

import type { Finding, Visit } from "./data";

export const SORTS = {
  size: "Size",
  confidence: "Confidence",
  seen: "Persistence",
  blade: "Blade",
  label: "Label",
  time: "First seen",
  id: "Number",
} as const;
export type SortKey = keyof typeof SORTS;

/** Compares findings by a key; unknown values come last either way, equals by number. */
export function byRank(
  key: SortKey,
  descending: boolean,
  visits: ReadonlyMap<number, readonly Visit[]> = new Map(),
): (a: Finding, b: Finding) => number {
  const value = (one: Finding): number | string | null => {
    switch (key) {
      case "size":
        return one.length ?? one.size;
      case "confidence":
        return one.confidence?.value ?? null;
      case "seen":
        return one.persistence.share;
      case "blade":
        return one.blade ? Number(one.blade) || String(one.blade) : null;
      case "label":
        return one.label;
      case "time":
        return first(visits.get(one.id));
      case "id":
        return one.id;
    }
  };
  const sign = descending ? -1 : 1;
  return (a, b) => {
    const [x, y] = [value(a), value(b)];
    if (x === null || y === null) return x === y ? a.id - b.id : x === null ? 1 : -1;
    const less = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y));
    return sign * less || a.id - b.id;
  };
}

function first(visits: readonly Visit[] | undefined): number | null {
  return visits?.length ? Math.min(...visits.map((one) => 1e6 * (one.video ?? 0) + one.start_s)) : null;
}
