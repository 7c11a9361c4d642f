/** Records of a review: appended only, an undo is a record too. What holds now follows from all of them in order. */

export type Action = "accept" | "reject" | "relabel" | "note" | "undo";

export interface ReviewRecord {
  /** From 1, in order. */
  readonly revision: number;
  readonly target: {
    readonly kind: "defect";
    readonly id: number;
    /** Place and label by which it is found again after a new attempt. */
    readonly label: string;
    readonly model: number;
    readonly centroid: readonly [number, number, number];
  };
  readonly action: Action;
  /** A label, a note, or the revision that an undo takes back. */
  readonly value: string | number | null;
  readonly reason: string | null;
  /** ISO 8601, of the browser. */
  readonly time: string;
}

export const REASONS = ["not damage", "wrong place", "duplicate", "other"] as const;

export interface Review {
  readonly state: "open" | "accepted" | "rejected";
  readonly reason: string | null;
  readonly label: string | null;
  readonly notes: readonly string[];
}

/** What holds of a finding after all records. */
export function reviewOf(records: readonly ReviewRecord[], id: number): Review {
  let review: Review = { state: "open", reason: null, label: null, notes: [] };
  for (const one of standing(records)) {
    if (one.target.id !== id) continue;
    if (one.action === "accept") review = { ...review, state: "accepted", reason: null };
    if (one.action === "reject") review = { ...review, state: "rejected", reason: one.reason };
    if (one.action === "relabel") review = { ...review, label: String(one.value ?? "") };
    if (one.action === "note") review = { ...review, notes: [...review.notes, String(one.value ?? "")] };
  }
  return review;
}

/** The last record that an undo would take back; null when there is none. */
export function lastStanding(records: readonly ReviewRecord[]): ReviewRecord | null {
  return standing(records).pop() ?? null;
}

function standing(records: readonly ReviewRecord[]): ReviewRecord[] {
  const taken = new Set(records.filter((one) => one.action === "undo").map((one) => one.value));
  return records.filter((one) => one.action !== "undo" && !taken.has(one.revision));
}

/** Records of a text that was kept; null when it is not such a text. */
export function readRecords(text: string | null): ReviewRecord[] | null {
  if (!text) return null;
  try {
    const value: unknown = JSON.parse(text);
    return Array.isArray(value) && value.every((one) => typeof one === "object" && one !== null && "revision" in one && "action" in one && "target" in one) ? (value as ReviewRecord[]) : null;
  } catch {
    return null;
  }
}
