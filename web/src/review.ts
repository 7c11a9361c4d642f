/** The review of this page: in a folder kept by the browser and handed over as `review.json`, else by the service. */

import { computed, effect, signal } from "@preact/signals";
import type { Finding, Vec3 } from "./model/data";
import { fold, lastStanding, newId, readRecords, targetOf, type Action, type Addition, type Review, type Reviewed, type ReviewRecord, type Target, type Value } from "./model/review";
import { findingName, scaled } from "./model/words";
import { all, author, fromService, hand, mayReview, start } from "./server";
import { data, detections, keeps, questions, size, surface } from "./session";
import { allFindings, announcement, drawing, finding, findingOf, frame, made, measured, place, reviewState, selectFinding, stepFinding } from "./state";

const KEY = `bladeatlas review ${data.fingerprint ?? `${data.title} ${data.frames.length} ${data.detections.length}`} ${data.model.index}`;
/** Pixels across a drawn box, and down it, that are asked where it lies; as in `core.query`. */
const GRID = 5;

const local = signal<readonly ReviewRecord[]>(fromService ? [] : restored());
export const records = computed(() => (fromService ? all.value : local.value));
/** Whether the browser kept the records; some keep nothing for pages from a folder. */
export const kept = signal(true);
export type Asked = "reject" | "relabel" | "note" | "severity" | "set_blade" | "merge" | "split" | "add";
/** What asks for a word: the reason of a rejection, a label, a note. */
export const asking = signal<Asked | null>(null);

const defects = data.defects.map(targetOf);
const folded = computed(() => fold(records.value.filter((one) => one.target.model === data.model.index), defects));
export const unattached = computed<readonly Reviewed[]>(() => folded.value.unattached);
const NONE = fold([], [{ kind: "defect", id: 0, label: "", model: 0, centroid: null }]).findings.get("D0")!.review;

export const reviewOf = (id: number): Review => folded.value.findings.get(findingName(id))?.review ?? NONE;
export const counts = computed(() => {
  const states = allFindings.value.map((one) => reviewOf(one.id).state);
  return { done: states.filter((state) => state !== "open").length, all: states.length };
});

effect(() => {
  const reviews = [...folded.value.findings.values()];
  made.value = new Map(reviews.filter((one) => one.made).map((one) => { const id = -Number(one.name.slice(1)); return [id, asFinding(id, one)]; }));
  reviewState.value = new Map(reviews.flatMap((one) => {
    const id = one.made ? -Number(one.name.slice(1)) : Number(one.target.id);
    return one.review.state === "open" ? [] : [[id, one.review.state] as const];
  }));
});
start();

/** A finding that people made, as the page shows those of the method. */
function asFinding(id: number, { target, made: record, review }: Reviewed): Finding {
  const drawn = record?.action === "add" ? (record.value as Addition) : null;
  const ids = record?.action === "split" ? (record.value as { detections: number[] }).detections : [];
  const own = ids.flatMap((one) => detections.get(one) ?? []);
  const points = own.flatMap((one) => (one.point ? [one.point] : []));
  const at = review.point ?? target.centroid ?? (points.length ? mean(points) : null);
  const near = at && surface ? surface.nearest(at) : null;
  const seen = near ? questions.visibleFrames(near.point, near.normal) : [];
  const shown = drawn ? [drawn.frame] : own.flatMap((one) => (one.frame === null ? [] : [one.frame]));
  return {
    id, label: target.label, model: target.model, centroid: at ?? [NaN, NaN, NaN], confidence: null,
    persistence: { k: shown.length, n: Math.max(shown.length, seen.length), share: 0 }, events: [], detections: ids,
    frames: seen.map((one) => ({ frame_index: one.frame, quality: one.quality, detected: shown.includes(one.frame) })),
    drawn: drawn && { frame: drawn.frame, box: drawn.box }, node: null, best_frames: shown.slice(0, 3), size: null, size_sigma: null,
    best: drawn ? { frame: drawn.frame, x: (drawn.box[0] + drawn.box[2]) / 2, y: (drawn.box[1] + drawn.box[3]) / 2 } : null,
  };
}

const mean = (points: readonly Vec3[]): Vec3 => [0, 1, 2].map((k) => points.reduce((sum, one) => sum + one[k]!, 0) / points.length) as unknown as Vec3;

export function targetFor(one: Finding): Target {
  const known = folded.peek().findings.get(findingName(one.id));
  return known?.made ? known.target : targetOf(one);
}

export function act(action: Exclude<Action, "undo" | "add">, value: Value = null, reason: string | null = null): void {
  const one = finding.peek();
  if (!one) return;
  append({ id: newId(), action, value, reason, target: targetFor(one) });
  const said = typeof value === "string" ? value : value && "kind" in value ? `into D${value.id}` : "";
  announcement.value = `${findingName(one.id)}: ${action.replace("_", " ")}${said ? ` ${said}` : ""}${reason ? `, ${reason}` : ""}`;
}

export function undo(): void {
  const last = lastStanding(records.peek(), fromService ? author.peek() : null);
  if (!last) return;
  const before = finding.peek();
  append({ id: newId(), action: "undo", value: last.id, reason: null, target: last.target });
  announcement.value = `Taken back: ${last.action.replace("_", " ")}`;
  const own = last.target.kind === "defect" ? Number(last.target.id) : null;
  if (own !== null && findingOf(own)) selectFinding(own);
  else if (before && !findingOf(before.id)) selectFinding(null);
}

export const stepOpen = (by: number): void => stepFinding(by, (id) => reviewOf(id).state === "open");

/** Begins to draw: a new finding in the middle of the used picture, or the new place of the selected one. */
export function draw(what: "add" | "move"): void {
  const one = frame.peek();
  if (!one || (what === "move" && !finding.peek())) return;
  const [x0, y0, x1, y1] = questions.crop;
  const at = (what === "move" && finding.peek() && questions.pixelOf(one.index, finding.peek()!.centroid)) || [(x0 + x1) / 2, (y0 + y1) / 2];
  const half = what === "move" ? 6 : 0.06 * Math.min(x1 - x0, y1 - y0);
  drawing.value = { what, box: [at[0]! - half, at[1]! - half, at[0]! + half, at[1]! + half] };
  announcement.value = `${what === "add" ? "Draw the new finding" : "Put the cross where it lies"}: drag on the frame, or arrows, with Shift for the size; Enter keeps it.`;
}

/** Ends the drawing: moves the finding, or asks what the new one is. */
export function drawn(): void {
  const now = drawing.peek();
  const at = place.peek().f;
  if (!now || at === null) return;
  if (now.what === "add") return void (asking.value = "add");
  const shown = cast(at, now.box);
  if (shown.point) {
    act("move", { point: shown.point, ...(shown.normal ? { normal: shown.normal } : {}), frame: at });
    drawing.value = null;
  } else announcement.value = `Nothing of the surface lies there: ${shown.unplaced ?? ""}.`;
}

export function add(label: string): void {
  const now = drawing.peek();
  const at = place.peek().f;
  drawing.value = null;
  if (!now || at === null) return;
  const clip = (value: number): number => Math.max(0, Math.min(1, value));
  const [x0, y0, x1, y1] = now.box;
  const value: Addition = { label, frame: at, box: [clip(x0 / size.width), clip(y0 / size.height), clip(x1 / size.width), clip(y1 / size.height)], ...cast(at, now.box) };
  const id = newId();
  append({ id, action: "add", value, reason: null, target: { kind: "added", id, label, model: data.model.index, centroid: value.point, sigma: null } });
  const own = [...folded.peek().findings.values()].find((one) => one.made?.id === id);
  if (own) selectFinding(-Number(own.name.slice(1)), { frame: at });
  announcement.value = `${own?.name ?? ""} ${label} added${value.point ? "" : `, without a place: ${value.unplaced ?? ""}`}`;
}

/** Where a box lies: of a grid of its pixels that meet the surface the one at median distance; as in `core.query`. */
function cast(at: number, [x0, y0, x1, y1]: readonly [number, number, number, number]): { point: Vec3 | null; normal?: Vec3; unplaced?: string } {
  const steps = Array.from({ length: GRID }, (_, k) => (k + 0.5) / GRID);
  const shown = steps.flatMap((down) => steps.map((along) => questions.pointAt(at, x0 + (x1 - x0) * along, y0 + (y1 - y0) * down)));
  const hits = shown.flatMap((one) => (one.reason === null ? [one] : [])).sort((a, b) => a.distance - b.distance);
  const middle = hits[Math.floor(hits.length / 2)];
  if (middle) return { point: [...middle.point], normal: [...middle.normal] };
  return { point: null, unplaced: shown[Math.floor(shown.length / 2)]?.reason ?? "off_surface" };
}

/** Keeps the length between the two measured points, in units of the model, as that of the selected finding. */
export function keepMeasured(length: number, along: boolean, sigma: number): void {
  const [a, b] = measured.peek();
  const { value, sigma: spread, unit } = scaled(length, sigma, data.model);
  if (a && b) act("measure", { length: value, sigma: spread, unit, along, points: [[...a], [...b]] });
}

/** Offers `review.json` as a file. */
export function exportReview(): void {
  const { title, fingerprint, model } = data;
  const text = JSON.stringify({ schema_version: 2, title, fingerprint: fingerprint ?? null, model: model.index, records: records.peek() }, null, 1);
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "application/json" }));
  link.download = "review.json";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function append(one: Omit<ReviewRecord, "revision" | "time" | "by">): void {
  const record = { ...one, revision: records.peek().length + 1, time: new Date().toISOString(), by: "" };
  if (fromService) {
    if (mayReview.peek()) hand(record);
    else announcement.value = "This key may not review.";
    return;
  }
  local.value = [...local.peek(), record];
  if (!keeps) return;
  try {
    localStorage.setItem(KEY, JSON.stringify(local.peek()));
  } catch {
    kept.value = false;
  }
}

function restored(): readonly ReviewRecord[] {
  if (!keeps) return [];
  try {
    return readRecords(localStorage.getItem(KEY)) ?? [];
  } catch {
    return [];
  }
}

