/** What one person did and said, and the two forms in which it is handed over. */

import type { Condition } from "./plan";

export const SCHEMA_VERSION = 1;

export interface Answer {
  readonly task: string;
  /** Null: could not tell. */
  readonly answer: string | null;
  /** From the first sight of the scene to the answer. */
  readonly seconds: number;
  /** 1 (guessed) to 7 (certain). */
  readonly confidence: number;
  /** Of these seconds, those in which the window was hidden. */
  readonly hidden_s: number;
  /** How often the scene was opened anew. */
  readonly reopened: number;
}

export interface Block {
  readonly condition: Condition;
  readonly scene: string;
  readonly order: readonly string[];
  readonly answers: readonly Answer[];
  /** Ten, 1 to 5 as they were marked; empty before. */
  readonly sus: readonly number[];
  /** Six, 0 to 100 by name; empty before. */
  readonly tlx: Readonly<Record<string, number>>;
}

export interface Run {
  readonly schema_version: number;
  readonly study: string;
  readonly participant: number;
  readonly group: number;
  readonly consented: string;
  readonly ended: string | null;
  readonly window: readonly [number, number];
  readonly background: Readonly<Record<string, string>>;
  readonly blocks: readonly Block[];
  readonly preference: Readonly<Record<string, string>>;
}

export type Step =
  | { readonly what: "consent" | "background" | "preference" | "end" }
  | { readonly what: "introduction" | "sus" | "tlx"; readonly block: number }
  | { readonly what: "task"; readonly block: number; readonly position: number };

/** What comes next follows from what is there, and from the parts whose introduction was read. */
export function stepOf(now: Run | null, read: ReadonlySet<number>): Step {
  if (!now) return { what: "consent" };
  if (!Object.keys(now.background).length) return { what: "background" };
  for (const [block, own] of now.blocks.entries()) {
    const position = own.answers.length;
    if (position < own.order.length) return position === 0 && !read.has(block) ? { what: "introduction", block } : { what: "task", block, position };
    if (!own.sus.length) return { what: "sus", block };
    if (!Object.keys(own.tlx).length) return { what: "tlx", block };
  }
  return { what: now.ended ? "end" : "preference" };
}

/** The System Usability Scale, 0 to 100 (Brooke 1996): odd statements count from 1 up, even ones from 5 down. */
export function susScore(marks: readonly number[]): number {
  return 2.5 * marks.reduce((sum, mark, k) => sum + (k % 2 === 0 ? mark - 1 : 5 - mark), 0);
}

/** The NASA Task Load Index without weights, 0 to 100 (Hart 2006). */
export function tlxScore(marks: Readonly<Record<string, number>>): number {
  const values = Object.values(marks);
  return values.reduce((sum, mark) => sum + mark, 0) / values.length;
}

const COLUMNS = ["study", "participant", "group", "block", "condition", "scene", "position", "task", "answer", "seconds", "confidence", "hidden_s", "reopened", "sus", "tlx"];

/** One row for each task; what was said of a whole block stands in each of its rows. */
export function csvOf(run: Run): string {
  const rows = run.blocks.flatMap((block, number) =>
    block.answers.map((one, position) => [
      run.study, run.participant, run.group, number + 1, block.condition, block.scene, position + 1, one.task, one.answer,
      one.seconds.toFixed(3), one.confidence, one.hidden_s.toFixed(3), one.reopened, susScore(block.sus), tlxScore(block.tlx).toFixed(2),
    ]),
  );
  return [COLUMNS, ...rows].map((row) => `${row.map(cell).join(",")}\r\n`).join("");
}

/** RFC 4180; a text that a spreadsheet would run gets an apostrophe, as everywhere in the product. */
function cell(value: string | number | null): string {
  if (value === null) return "";
  if (typeof value === "number") return String(value);
  const safe = /^[=+\-@\t\r]/.test(value) ? `'${value}` : value;
  return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

export const jsonOf = (run: Run): string => `${JSON.stringify(run, null, 1)}\n`;
