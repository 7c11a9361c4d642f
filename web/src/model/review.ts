/** Records of a review, appended only, and what holds after all of them; the same as `core.review`, by the same cases. */

import type { Finding, Vec3 } from "./data";

export const ACTIONS = ["accept", "reject", "relabel", "merge", "split", "move", "set_blade", "severity", "note", "measure", "add", "undo"] as const;
export type Action = (typeof ACTIONS)[number];

/** The finding that a record speaks of, by number, label and place, so that it is found again after a new attempt. */
export interface Target {
  readonly kind: "defect" | "added";
  /** Number of the defect; of a finding that people made, the id of the record that made it. */
  readonly id: number | string;
  readonly label: string;
  readonly model: number;
  readonly centroid: Vec3 | null;
  readonly sigma?: number | null;
}

export interface Measure {
  readonly length: number;
  readonly sigma: number | null;
  readonly unit: string;
  readonly along: boolean;
  readonly points: readonly [Vec3, Vec3];
}
export interface Addition {
  readonly label: string;
  readonly frame: number;
  /** In shares of the source frame. */
  readonly box: readonly [number, number, number, number];
  readonly point: Vec3 | null;
  readonly normal?: Vec3;
  readonly unplaced?: string;
}
export type Value = string | null | Target | Measure | Addition | { readonly detections: readonly number[] } | { readonly point: Vec3; readonly normal?: Vec3; readonly frame?: number };

export interface ReviewRecord {
  readonly id: string;
  /** From 1, in order. */
  readonly revision: number;
  readonly target: Target;
  readonly action: Action;
  readonly value: Value;
  readonly reason: string | null;
  /** ISO 8601; of the browser where no service keeps the records. */
  readonly time: string;
  readonly by?: string;
}

export const REASONS = ["not damage", "wrong place", "duplicate", "other"] as const;
export const SEVERITIES: readonly string[] = ["serviceable", "monitor", "reject"];

export type State = "open" | "accepted" | "rejected" | "merged";

export interface Review {
  readonly state: State;
  readonly reason: string | null;
  readonly label: string | null;
  readonly blade: string | null;
  readonly severity: string | null;
  readonly point: Vec3 | null;
  readonly merged_into: string | null;
  readonly notes: readonly { readonly text: string; readonly by: string; readonly time: string }[];
  readonly measures: readonly Measure[];
  /** Detections that are findings of their own. */
  readonly without: readonly number[];
  readonly by: string | null;
  readonly time: string | null;
}

export interface Reviewed {
  /** `D7` for the method's, `H1` for people's, `U1` for what is not attached. */
  readonly name: string;
  readonly target: Target;
  readonly review: Review;
  readonly made: ReviewRecord | null;
}

const NOTHING: Review = { state: "open", reason: null, label: null, blade: null, severity: null, point: null, merged_into: null, notes: [], measures: [], without: [], by: null, time: null };
/** Places closer than this share of their size are one: what a file rounds off. */
const EXACT = 1e-6;

export function targetOf(one: Finding): Target {
  return { kind: "defect", id: one.id, label: plain(one.label), model: one.model, centroid: one.centroid, sigma: one.centroid_sigma ?? null };
}

/** A label as targets tell it: without the characters that no record may have. */
const plain = (label: string): string => label.replace(/[\0-\x08\x0b-\x1f\x7f]/g, "").slice(0, 1000);

export interface Folded {
  readonly findings: ReadonlyMap<string, Reviewed>;
  readonly unattached: readonly Reviewed[];
}

/** What holds of the findings after all records. */
export function fold(records: readonly ReviewRecord[], defects: readonly Target[]): Folded {
  const ordered = inOrder(records);
  const names = new Map<string | number, string>();
  for (const one of ordered) if (one.action === "add" || one.action === "split") names.set(one.id, `H${names.size + 1}`);
  const found = new Map<string, Reviewed>(defects.map((one) => [`D${one.id}`, { name: `D${one.id}`, target: one, review: NOTHING, made: null }]));
  const lost = new Map<string, Reviewed>();

  const nameOf = (target: Target): string => {
    if (target.kind === "added") return names.get(target.id) ?? `H-${target.id}`;
    const near = defects.filter((one) => isSame(one, target));
    near.sort((a, b) => Number(a.id !== target.id) - Number(b.id !== target.id) || distance(a, target) - distance(b, target));
    if (near[0]) return `D${near[0].id}`;
    const known = [...lost.values()].find((one) => sameTarget(one.target, target));
    return known?.name ?? `U${1 + [...lost.values()].filter((one) => one.target.kind === "defect").length}`;
  };
  const make = (record: ReviewRecord, target: Target): void => {
    const name = names.get(record.id) as string;
    found.set(name, { name, target, review: { ...NOTHING, by: record.by || null, time: record.time }, made: record });
  };
  const merged = (one: Reviewed, into: Target): Review => {
    const name = nameOf(into);
    for (let at: string | null = name; at; at = found.get(at)?.review.merged_into ?? null) if (at === one.name) return one.review;
    return { ...one.review, state: "merged", reason: null, merged_into: name };
  };

  for (const record of standing(ordered)) {
    if (record.action === "add") {
      const value = record.value as Addition;
      make(record, { kind: "added", id: record.id, label: value.label, model: record.target.model, centroid: value.point, sigma: null });
      continue;
    }
    const name = nameOf(record.target);
    const here = found.has(name) ? found : lost;
    const one = here.get(name) ?? { name, target: record.target, review: NOTHING, made: null };
    const review = record.action === "merge" ? merged(one, record.value as Target) : after(one.review, record);
    here.set(name, { ...one, review: { ...review, by: record.by || null, time: record.time } });
    if (record.action === "split") make(record, { ...one.target, kind: "added", id: record.id, centroid: null, sigma: null });
  }
  return { findings: found, unattached: [...lost.values()] };
}

function after(review: Review, { action, value, reason, by, time }: ReviewRecord): Review {
  switch (action) {
    case "accept": return { ...review, state: "accepted", reason: null, merged_into: null };
    case "reject": return { ...review, state: "rejected", reason, merged_into: null };
    case "relabel": return { ...review, label: String(value) };
    case "set_blade": return { ...review, blade: String(value) };
    case "severity": return { ...review, severity: String(value) };
    case "note": return { ...review, notes: [...review.notes, { text: String(value), by: by ?? "", time }] };
    case "move": return { ...review, point: (value as { point: Vec3 }).point };
    case "measure": return { ...review, measures: [...review.measures, value as Measure] };
    case "split": return { ...review, without: [...new Set([...review.without, ...(value as { detections: number[] }).detections])].sort((a, b) => a - b) };
    default: return review;
  }
}

/** The last record that an undo of this author would take back; null when there is none. */
export function lastStanding(records: readonly ReviewRecord[], by?: string | null): ReviewRecord | null {
  return standing(inOrder(records)).filter((one) => by === undefined || by === null || !one.by || one.by === by).pop() ?? null;
}

function standing(ordered: readonly ReviewRecord[]): ReviewRecord[] {
  const taken = new Set(ordered.filter((one) => one.action === "undo").map((one) => one.value));
  return ordered.filter((one) => one.action !== "undo" && !taken.has(one.id));
}

const inOrder = (records: readonly ReviewRecord[]): ReviewRecord[] => [...records].sort((a, b) => a.revision - b.revision);

export function sameTarget(a: Target, b: Target): boolean {
  return a.kind === b.kind && a.id === b.id && a.label === b.label && a.model === b.model && String(a.centroid) === String(b.centroid) && (a.sigma ?? null) === (b.sigma ?? null);
}

function isSame(defect: Target, told: Target): boolean {
  if (defect.label !== told.label) return false;
  const scale = Math.max(1, ...(told.centroid ?? []).map(Math.abs));
  return distance(defect, told) <= Math.hypot(defect.sigma ?? 0, told.sigma ?? 0) + EXACT * scale;
}

function distance(a: Target, b: Target): number {
  if (!a.centroid || !b.centroid || a.model !== b.model) return Infinity;
  return Math.hypot(...a.centroid.map((value, k) => value - (b.centroid as Vec3)[k]!));
}

/** Records of a text that was kept, also of one from before they had ids; null when it is not such a text. */
export function readRecords(text: string | null): ReviewRecord[] | null {
  if (!text) return null;
  try {
    const value: unknown = JSON.parse(text);
    if (!Array.isArray(value) || !value.every((one) => typeof one === "object" && one !== null && "revision" in one && "action" in one && "target" in one)) return null;
    return withIds(value as (Omit<ReviewRecord, "id"> & { id?: string })[]);
  } catch {
    return null;
  }
}

function withIds(records: readonly (Omit<ReviewRecord, "id" | "value"> & { id?: string; value: unknown })[]): ReviewRecord[] {
  const names = new Map<unknown, string>(records.map((one) => [one.revision, one.id ?? `v1-${one.revision}-${one.time}`]));
  return records.map((one) => ({
    ...one,
    id: one.id ?? (names.get(one.revision) as string),
    value: (one.id === undefined && one.action === "undo" ? (names.get(one.value) ?? "none") : one.value) as Value,
  }));
}

/** A name that nobody else gives: 128 random bits. */
export function newId(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}
