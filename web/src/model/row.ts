/** What the page shows of `row.json`: where root and tip are, seen from a place, and what was seen of each blade. */

import type { Row, Vec3 } from "./data";
import { dot, norm, sub } from "./pose";

/**
 * The unit direction from root to tip at a place: away from the axis of the row, or towards it when the root is
 * outside; null as long as the row, or which end is the root, is not known.
 */
export function visibleRow(row: Row, at: Vec3): { readonly tip: Vec3 } | null {
  const [axis, point] = [three(row["axis"]), three(row["point"])];
  const root = row["root"];
  if (row.status === "unknown" || !axis || !point || (root !== "inside" && root !== "outside" && root !== "inner" && root !== "outer")) return null;
  const arm = sub(at, point);
  const along = dot(arm, axis) / dot(axis, axis);
  const away: Vec3 = [arm[0] - along * axis[0], arm[1] - along * axis[1], arm[2] - along * axis[2]];
  const length = norm(away);
  if (!(length > 0)) return null;
  const sign = (root.startsWith("in") ? 1 : -1) / length;
  return { tip: [sign * away[0], sign * away[1], sign * away[2]] };
}

export interface SeenBlade {
  /** On the surface of this model. */
  readonly number: number;
  /** In the tables: by the numbers of the first model where it is known how its row goes on. */
  readonly name: string;
  /** Share of its reconstructed surface that two views see at a usable angle. */
  readonly seen: number;
}

/** The blades that were seen; empty while that is not known. */
export function bladesOf(row: Row): readonly SeenBlade[] {
  const blades = row["coverage"];
  if (!Array.isArray(blades)) return [];
  return blades.flatMap((one: { blade?: unknown; name?: unknown; views_2?: unknown } | null) =>
    // Pages of earlier releases tell no names.
    one && typeof one.blade === "number" && typeof one.views_2 === "number" ? [{ number: one.blade, name: String(one.name ?? one.blade), seen: one.views_2 }] : [],
  );
}

function three(value: unknown): Vec3 | null {
  return Array.isArray(value) && value.length === 3 && value.every((one) => typeof one === "number") ? (value as unknown as Vec3) : null;
}
