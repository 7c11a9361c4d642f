/** The review in this browser: kept in its storage, handed over as `review.json`. */

import { computed, signal } from "@preact/signals";
import { lastStanding, readRecords, reviewOf, type Action, type ReviewRecord } from "./model/review";
import { data, findings } from "./session";
import { announcement, finding, reviewState, selectFinding, stepFinding } from "./state";

const KEY = `bladeatlas review ${data.fingerprint ?? `${data.title} ${data.frames.length} ${data.detections.length}`} ${data.model.index}`;

export const records = signal<readonly ReviewRecord[]>(restored());
/** Whether the browser kept the records; some keep nothing for pages from a folder. */
export const kept = signal(true);
/** What asks for a word: the reason of a rejection, a label, a note. */
export const asking = signal<"reject" | "relabel" | "note" | null>(null);
export const counts = computed(() => {
  const states = data.defects.map((one) => reviewOf(records.value, one.id).state);
  return { done: states.filter((state) => state !== "open").length, all: states.length };
});

mirror();

export function act(action: Exclude<Action, "undo">, value: string | null = null, reason: string | null = null): void {
  const one = finding.peek();
  if (!one) return;
  append({ action, value, reason, target: { kind: "defect", id: one.id, label: one.label, model: one.model, centroid: one.centroid } });
  announcement.value = `D${one.id}: ${action}${value ? ` ${value}` : ""}${reason ? `, ${reason}` : ""}`;
}

export function undo(): void {
  const last = lastStanding(records.peek());
  if (!last) return;
  append({ action: "undo", value: last.revision, reason: null, target: last.target });
  announcement.value = `Taken back: ${last.action} of D${last.target.id}`;
  if (findings.has(last.target.id)) selectFinding(last.target.id);
}

export const stepOpen = (by: number): void => stepFinding(by, (id) => reviewOf(records.peek(), id).state === "open");

/** Offers `review.json` as a file. */
export function exportReview(): void {
  const { title, fingerprint, model } = data;
  const text = JSON.stringify({ schema_version: 1, title, fingerprint: fingerprint ?? null, model: model.index, records: records.peek() }, null, 1);
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "application/json" }));
  link.download = "review.json";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function append(one: Omit<ReviewRecord, "revision" | "time">): void {
  records.value = [...records.peek(), { revision: records.peek().length + 1, ...one, time: new Date().toISOString() }];
  try {
    localStorage.setItem(KEY, JSON.stringify(records.peek()));
  } catch {
    kept.value = false;
  }
  mirror();
}

function mirror(): void {
  reviewState.value = new Map(
    data.defects.flatMap((one) => {
      const { state } = reviewOf(records.peek(), one.id);
      return state === "open" ? [] : [[one.id, state] as const];
    }),
  );
}

function restored(): readonly ReviewRecord[] {
  try {
    return readRecords(localStorage.getItem(KEY)) ?? [];
  } catch {
    return [];
  }
}
