/** The service that keeps the review, where the page was opened from one: records are sent in order, none is dropped. */

import { computed, signal } from "@preact/signals";
import { sameTarget, SEVERITIES, type ReviewRecord } from "./model/review";

const FOUND = /^(.*\/v1\/inspections\/([0-9a-f]{32}))\/(?:models\/\d+\/)?viewer\//.exec(location.protocol.startsWith("http") ? location.pathname : "");
/** Address of the records; null where the page was opened from a folder. */
const ADDRESS = FOUND ? `${FOUND[1]}/reviews` : null;
const KEPT = `bladeatlas unsent ${FOUND?.[2] ?? ""}`;
const POLL_MS = 10_000;

export const fromService = ADDRESS !== null;
/** Start page of the service, where one signs in. */
export const startPage = FOUND ? (FOUND[1] as string).replace(/\/v1\/inspections\/.*/, "/") : "";
/** The inspection's report, which holds what people said up to now. */
export const report = FOUND ? `${FOUND[1]}/report.pdf` : "";
/** What the service has, and behind it what it was not sent yet. */
export const confirmed = signal<readonly ReviewRecord[]>([]);
export const unsent = signal<readonly ReviewRecord[]>(fromService ? kept() : []);
export const severities = signal<readonly string[]>(SEVERITIES);
/** Whose records are written here; null until the service has said it. */
export const author = signal<string | null>(null);
export const mayReview = signal(true);
/** Why the next record is not sent; null while all is well. */
export const trouble = signal<{ readonly kind: "offline" | "sign-in" | "conflict" | "refused"; readonly text: string; readonly others: readonly ReviewRecord[] } | null>(null);
export const notice = signal("");
export const all = computed<readonly ReviewRecord[]>(() => [
  ...confirmed.value,
  ...unsent.value.map((one, k) => ({ ...one, revision: last() + 1 + k, by: author.value ?? "" })),
]);

let busy = false;
let again = 0;

function last(): number {
  return confirmed.value[confirmed.value.length - 1]?.revision ?? 0;
}

/** Hands a record over; it is kept in the browser until the service has it. */
export function hand(record: ReviewRecord): void {
  keep([...unsent.peek(), record]);
  void send();
}

/** Sends what waits although others have spoken of the same finding, or tries again. */
export function sendAnyway(): void {
  trouble.value = null;
  void send(true);
}

/** Leaves the record out that could not be sent. */
export function leaveOut(): void {
  trouble.value = null;
  keep(unsent.peek().slice(1));
  void send();
}

export function start(): void {
  if (!ADDRESS) return;
  void pull().then(() => send());
  window.setInterval(() => {
    if (document.visibilityState === "visible" && trouble.peek()?.kind !== "conflict") void pull().then(() => send());
  }, POLL_MS);
}

async function send(insist = false): Promise<void> {
  if (!ADDRESS || busy || trouble.peek()?.kind === "conflict" || trouble.peek()?.kind === "refused") return;
  busy = true;
  clearTimeout(again);
  try {
    for (let next = unsent.peek()[0]; next; next = unsent.peek()[0]) if (!(await sent(next, insist))) return;
  } finally {
    busy = false;
  }
}

/** Sends one record; false where the next must wait. */
async function sent(next: ReviewRecord, insist: boolean): Promise<boolean> {
  const { id, target, action, value, reason } = next;
  const answer = await ask("POST", "", { id, target, action, value, reason, revision: last() });
  if (!answer) return false;
  if (answer.ok) {
    const kept = (await answer.json()) as ReviewRecord;
    if (kept.revision === last() + 1) confirmed.value = [...confirmed.peek(), kept];
    else await pull();
    author.value = kept.by ?? author.peek();
    keep(unsent.peek().filter((one) => one.id !== id));
    trouble.value = null;
    return true;
  }
  if (answer.status === 409) {
    const others = (await pull()).filter((one) => one.id !== id);
    const same = others.filter((one) => sameTarget(one.target, target));
    if (others.length) notice.value = `${others.length} ${others.length === 1 ? "record" : "records"} of others came meanwhile; nothing is lost.`;
    if (!same.length || insist) return trouble.peek() === null;
    trouble.value = { kind: "conflict", text: "Somebody else has spoken of this finding meanwhile (409).", others: same };
    return false;
  }
  const problem = (await answer.json().catch(() => ({}))) as { detail?: string };
  trouble.value = { kind: "refused", text: problem.detail ?? `the service answers ${answer.status}`, others: [] };
  return false;
}

/** Reads what others have written; gives it. */
async function pull(): Promise<readonly ReviewRecord[]> {
  const answer = await ask("GET", `?since=${last()}`);
  if (!answer?.ok) return [];
  const page = (await answer.json()) as { records: ReviewRecord[]; severities: string[]; may_review: boolean; you: string };
  const new_ = page.records.filter((one) => one.revision > last());
  if (new_.length) confirmed.value = [...confirmed.peek(), ...new_];
  severities.value = page.severities;
  mayReview.value = page.may_review;
  author.value = page.you;
  if (trouble.peek()?.kind === "offline" || trouble.peek()?.kind === "sign-in") trouble.value = null;
  return new_;
}

/** The answer of the service; undefined where none came, or where it is not for this browser. */
async function ask(method: string, more: string, body?: object): Promise<Response | undefined> {
  try {
    const answer = await fetch(ADDRESS + more, {
      method,
      credentials: "same-origin",
      headers: body ? { "Content-Type": "application/json", "X-BladeAtlas-Write": "1" } : {},
      ...(body ? { body: JSON.stringify(body) } : {}),
    });
    if (answer.status === 401) {
      trouble.value = { kind: "sign-in", text: "The session is over: sign in on the start page. What was not sent waits in this browser.", others: [] };
      return undefined;
    }
    if (answer.status >= 500 || answer.status === 429) throw new Error(String(answer.status));
    return answer;
  } catch {
    trouble.value = { kind: "offline", text: "The service does not answer. What was not sent waits in this browser and is sent as soon as it does.", others: [] };
    again = window.setTimeout(() => void send(), POLL_MS / 2);
    return undefined;
  }
}

function keep(records: readonly ReviewRecord[]): void {
  unsent.value = records;
  try {
    localStorage.setItem(KEPT, JSON.stringify(records));
  } catch {
    notice.value = "This browser keeps nothing: leave the page open until all is sent.";
  }
}

function kept(): readonly ReviewRecord[] {
  try {
    return JSON.parse(localStorage.getItem(KEPT) ?? "[]") as ReviewRecord[];
  } catch {
    return [];
  }
}
