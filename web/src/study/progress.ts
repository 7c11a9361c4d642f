/** How far a person has come, kept in the browser so that a reload loses nothing. */

import { computed, signal } from "@preact/signals";
import { groupOf, planOf } from "./plan";
import { SCHEMA_VERSION, stepOf, type Answer, type Block, type Run, type Step } from "./record";

export interface TaskData {
  readonly id: string;
  readonly text: string;
  readonly kind: "number" | "finding" | "end";
  readonly unit: string;
}

export interface StudyData {
  readonly schema_version: number;
  readonly study: string;
  readonly contact: string;
  readonly scenes: readonly { readonly name: string; readonly box: string }[];
  readonly tasks: readonly TaskData[];
  readonly practice: boolean;
  readonly not_told: string;
}

declare global {
  interface Window {
    STUDY_DATA?: StudyData;
  }
}

const delivered = window.STUDY_DATA;
/** Why there is nothing to begin; null when there is. */
export const failure: string | null = !delivered
  ? "The file study.js is not beside this page. Open index.html in the folder that `bladeatlas study` wrote."
  : delivered.schema_version !== SCHEMA_VERSION ? `This page reads studies of version ${SCHEMA_VERSION}.` : null;
export const data: StudyData = delivered ?? { schema_version: SCHEMA_VERSION, study: "", contact: "", scenes: [], tasks: [], practice: false, not_told: "" };

const KEY = `bladeatlas study ${data.study}`;
export const run = signal<Run | null>(restored());
/** A run that was begun before this page was opened, until it is gone on with or deleted. */
export const found = signal(run.peek() !== null);
/** Whether the browser kept the run; some keep nothing for pages from a folder. */
export const kept = signal(true);
/** Blocks whose introduction was read. */
const begun = signal<ReadonlySet<number>>(new Set());

/** What comes next follows from what is there. */
export const step = computed<Step>(() => stepOf(run.value, begun.value));

export function begin(participant: number): void {
  const planned = planOf(data.study, participant, data.scenes.map((one) => one.name), data.tasks.map((one) => one.id));
  begun.value = new Set();
  keep({
    schema_version: SCHEMA_VERSION, study: data.study, participant, group: groupOf(participant), consented: new Date().toISOString(), ended: null,
    window: [window.innerWidth, window.innerHeight], background: {}, blocks: planned.map((one) => ({ ...one, answers: [], sus: [], tlx: {} })), preference: {},
  });
}

export function tell(part: Partial<Run>): void {
  const now = run.peek();
  if (now) keep({ ...now, ...part });
}

export function tellOfBlock(block: number, part: Partial<Block>): void {
  tell({ blocks: (run.peek()?.blocks ?? []).map((one, k) => (k === block ? { ...one, ...part } : one)) });
}

export function answer(block: number, one: Answer): void {
  tellOfBlock(block, { answers: [...(run.peek()?.blocks[block]?.answers ?? []), one] });
}

export const read = (block: number): void => void (begun.value = new Set([...begun.peek(), block]));

export function forget(): void {
  run.value = null;
  found.value = false;
  try {
    localStorage.removeItem(KEY);
  } catch {
    // it had kept nothing
  }
}

function keep(next: Run): void {
  run.value = next;
  try {
    localStorage.setItem(KEY, JSON.stringify(next));
    kept.value = true;
  } catch {
    kept.value = false;
  }
}

/** The run of this study that the browser kept. */
function restored(): Run | null {
  try {
    const one = JSON.parse(localStorage.getItem(KEY) ?? "null") as Run | null;
    return one?.schema_version === SCHEMA_VERSION && one.study === data.study ? one : null;
  } catch {
    return null;
  }
}
