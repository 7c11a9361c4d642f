/** The human's word on a finding: buttons, what asks for a word, what holds, and how the records are kept. */

import type { JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import type { Finding } from "../model/data";
import { REASONS, type Review } from "../model/review";
import { findingName, measured } from "../model/words";
import { act, add, asking, counts, draw, exportReview, kept, records, reviewOf, targetFor, unattached, undo, type Asked } from "../review";
import { fromService, leaveOut, mayReview, notice, report, sendAnyway, severities, startPage, trouble, unsent } from "../server";
import { data, detections, frames } from "../session";
import { allFindings, drawing, finding, units } from "../state";

export function ReviewBar({ one }: { readonly one: Finding }): JSX.Element {
  const { state, reason, severity } = reviewOf(one.id);
  const off = !mayReview.value;
  const ask = (what: Asked) => () => (asking.value = what);
  return (
    <div class="review-bar" role="group" aria-label="Review">
      <button type="button" disabled={off} aria-pressed={state === "accepted"} onClick={() => act("accept")} title="Accept (A)">Accept</button>
      <button type="button" disabled={off} aria-pressed={state === "rejected"} onClick={ask("reject")} title="Reject (R)">Reject{state === "rejected" && reason ? `: ${reason}` : ""}</button>
      <button type="button" disabled={off} onClick={ask("severity")} title="Severity (S)">Severity{severity ? `: ${severity}` : ""}</button>
      <button type="button" disabled={off} onClick={ask("relabel")} title="Label (L)">Label</button>
      <button type="button" disabled={off} onClick={ask("note")} title="Note (N)">Note</button>
      <button type="button" disabled={off} onClick={ask("set_blade")} title="Blade (T)">Blade</button>
      <button type="button" disabled={off} onClick={() => draw("move")} title="Move (W)">Move</button>
      <button type="button" disabled={off || allFindings.value.length < 2} onClick={ask("merge")} title="Merge (G)">Merge</button>
      <button type="button" disabled={off || one.detections.length < 2} onClick={ask("split")} title="Split (Y)">Split</button>
      <button type="button" disabled={off || !records.value.length} onClick={undo} title="Take back (Z)">Undo</button>
    </div>
  );
}

const QUESTIONS: Readonly<Record<Asked, string>> = {
  reject: "Why is it rejected?", relabel: "The right label", note: "Note", severity: "What shall be done?", set_blade: "Blade (empty: on none)",
  merge: "It is the same as", split: "Detections that are a finding of their own", add: "What is it?",
};

/** Asks for the word that an action needs; Enter keeps it, Escape leaves. */
export function Ask(): JSX.Element | null {
  const what = asking.value;
  const field = useRef<HTMLFormElement>(null);
  const one = finding.value;
  useLayoutEffect(() => field.current?.querySelector<HTMLElement>("select, input")?.focus(), [what]); // before the next key is pressed
  if (!what || (!one && what !== "add")) return null;
  const leave = (): void => {
    asking.value = null;
    drawing.value = null;
  };
  const done = (event: Event): void => {
    event.preventDefault();
    const given = new FormData(field.current as HTMLFormElement);
    const text = String(given.get("value") ?? "").trim();
    asking.value = null;
    if (what === "reject") act("reject", null, text);
    else if (what === "split") {
      const chosen = given.getAll("detection").map(Number);
      if (chosen.length && chosen.length < (one?.detections.length ?? 0)) act("split", { detections: chosen });
    } else if (what === "merge") {
      const into = allFindings.peek().find((other) => other.id === Number(text));
      if (into) act("merge", targetFor(into));
    } else if (what === "add") { if (text) add(text); }
    else if (text || what === "set_blade") act(what, text);
  };
  return (
    <form class="ask" ref={field} onSubmit={done} onKeyDown={(event) => { if (event.key === "Escape") { event.stopPropagation(); leave(); } else if (event.key === "Enter" && !(event.target as HTMLElement).matches("button")) done(event); }}>
      {what === "split" ? <Parts one={one as Finding} /> : <label>{QUESTIONS[what]}<Field what={what} one={one} /></label>}
      <datalist id="known-labels">{[...new Set(data.detections.map((own) => own.label))].map((own) => <option key={own} value={own} />)}</datalist>
      <button type="submit">Keep</button>
      <button type="button" onClick={leave}>Leave</button>
    </form>
  );
}

function Field({ what, one }: { readonly what: Asked; readonly one: Finding | null }): JSX.Element {
  if (what === "reject" || what === "severity") return <select name="value">{(what === "reject" ? REASONS : severities.value).map((word) => <option key={word}>{word}</option>)}</select>;
  if (what === "merge") return <select name="value">{allFindings.value.filter((other) => other.id !== one?.id).map((other) => <option key={other.id} value={other.id}>{findingName(other.id)} {other.label}</option>)}</select>;
  const labels = what === "relabel" || what === "add";
  const first = what === "relabel" ? one?.label : what === "set_blade" ? (one && (reviewOf(one.id).blade ?? String(one.blade ?? ""))) : "";
  return <input name="value" type="text" maxLength={what === "note" ? 2000 : what === "set_blade" ? 64 : 100} defaultValue={first ?? ""} {...(labels ? { list: "known-labels" } : {})} />;
}

function Parts({ one }: { readonly one: Finding }): JSX.Element {
  return (
    <fieldset>
      <legend>{QUESTIONS.split}</legend>
      {one.detections.map((id) => {
        const own = detections.get(id);
        return <label key={id} class="check"><input type="checkbox" name="detection" value={id} /> {id} <bdi>{own?.label}</bdi>{own?.frame === null || own === undefined ? "" : `, frame ${frames.get(own.frame)?.source_index ?? own.frame}`}</label>;
      })}
    </fieldset>
  );
}

/** What people say of the finding, beside what the method says. */
export function Said({ review }: { readonly review: Review }): JSX.Element | null {
  const said: [string, string][] = [];
  if (review.merged_into) said.push(["Merged into", review.merged_into]);
  if (review.severity) said.push(["Severity", review.severity]);
  if (review.blade !== null) said.push(["Blade", review.blade || "on none"]);
  if (review.point) said.push(["Moved to", review.point.map((value) => value.toFixed(3)).join(", ")]);
  for (const one of review.measures.slice(-1)) said.push(["Measured", measured(one.length, one.sigma, one.unit, units.value)]);
  if (review.without.length) said.push(["Without detections", review.without.join(", ")]);
  if (!said.length && !review.notes.length && !review.by) return null;
  return (
    <div class="said-by" role="group" aria-label="What people say">
      <h3>People say{review.by ? <> (<bdi>{review.by}</bdi>)</> : ""}</h3>
      <dl>{said.map(([name, text]) => <div key={name}><dt>{name}</dt><dd><bdi>{text}</bdi></dd></div>)}</dl>
      {review.notes.length > 0 && <ul class="reasons">{review.notes.map((note, k) => <li key={k}><bdi>{note.text}</bdi>{note.by && <small> <bdi>{note.by}</bdi></small>}</li>)}</ul>}
    </div>
  );
}

export function Exports(): JSX.Element {
  const waiting = unsent.value.length;
  return (
    <div class="exports">
      <Trouble />
      {notice.value && <p role="status">{notice.value} <button type="button" class="link" onClick={() => (notice.value = "")}>Seen</button></p>}
      <span>Reviewed {counts.value.done} of {counts.value.all}.{fromService && mayReview.value ? (waiting ? ` ${waiting} not sent yet.` : " Kept by the service.") : ""}</span>
      {fromService && !mayReview.value && <span class="warn">Your key may not review.</span>}
      <button type="button" disabled={!mayReview.value} onClick={() => draw("add")} title="Add a finding (D)">Add a finding</button>
      <button type="button" disabled={!records.value.length} onClick={exportReview}>Save review.json</button>
      {fromService && <a href={report}>Report</a>}
      {!kept.value && <span class="warn">This browser keeps nothing for this page: save before you close it.</span>}
      {unattached.value.length > 0 && (
        <details><summary>{unattached.value.length} reviewed before and not found here</summary>
          <ul class="reasons">{unattached.value.map((one) => <li key={one.name}><bdi>{one.target.label}</bdi> (was {String(one.target.id).slice(0, 6)}): {one.review.state}{one.review.notes.map((note, k) => <bdi key={k}>, {note.text}</bdi>)}</li>)}</ul>
        </details>
      )}
    </div>
  );
}

function Trouble(): JSX.Element | null {
  const now = trouble.value;
  if (!now) return null;
  const mine = unsent.value[0];
  return (
    <div class="trouble" role="alert">
      <p>{now.text}</p>
      {now.others.length > 0 && <ul>{now.others.map((one) => <li key={one.id}><bdi>{one.by}</bdi>: {one.action}{typeof one.value === "string" ? <> <bdi>{one.value}</bdi></> : ""}{one.reason ? `, ${one.reason}` : ""}</li>)}</ul>}
      {(now.kind === "conflict" || now.kind === "refused") && mine && (
        <p>Yours: {mine.action}{mine.reason ? `, ${mine.reason}` : ""}. <button type="button" onClick={sendAnyway}>Send mine too</button> <button type="button" onClick={leaveOut}>Leave mine out</button></p>
      )}
      {now.kind === "sign-in" && <a href={startPage}>To the start page</a>}
    </div>
  );
}
