/** The whole page. */

import type { JSX } from "preact";
import { data, failure } from "../session";
import type { Units } from "../model/words";
import { announcement, helpOpen, setUnits, units } from "../state";
import { Detail } from "./Detail";
import { FrameView } from "./FrameView";
import { Help } from "./Help";
import { BladeAlone, List } from "./List";
import { Surface3D } from "./Surface3D";
import { Timeline } from "./Timeline";

const VERDICTS: Readonly<Record<string, string>> = {
  ok: "ok: the checks found nothing that speaks against the model",
  suspect: "suspect: read the warnings before you trust a place or a size",
  refused: "refused: no model can be trusted",
};

export function App(): JSX.Element {
  if (failure) return <main class="broken"><h1>Nothing can be shown</h1><p role="alert">{failure}</p></main>;
  return (
    <>
      <Header />
      <main class="grid">
        <div class="side"><List /><Detail /></div>
        <Surface3D />
        <FrameView />
        <Timeline />
      </main>
      <p class="spoken" aria-live="polite">{announcement.value}</p>
      <Help />
    </>
  );
}

function Header(): JSX.Element {
  const { title, verdict, message, flags, model, models } = data;
  const serious = flags.filter((one) => one.severity !== "info");
  return (
    <header>
      <h1><bdi>{title}</bdi></h1>
      <p class="lead">
        <span class={`verdict ${verdict}`} title={VERDICTS[verdict] ?? ""}>{verdict}</span>
        {" "}{data.defects.length} {data.defects.length === 1 ? "finding" : "findings"}{inAll(model.findings)}, {data.detections.length} {data.detections.length === 1 ? "detection" : "detections"}, {data.frames.length} frames
        {model.unit === "model" ? ", unscaled" : `, in ${units.value === "in" ? "inches" : model.unit}`}
      </p>
      {models.length > 0 && (
        <nav aria-label="Models">
          <span>Model {model.index} of {model.count}; the others: </span>
          {models.map((one) => <a key={one.index} href={safe(one.href)}>model {one.index}</a>)}
        </nav>
      )}
      <BladeAlone />
      {(flags.length > 0 || message) && (
        <details class="flags" open={verdict === "refused"}>
          <summary>{serious.length || flags.length ? `${flags.length} ${flags.length === 1 ? "remark" : "remarks"} of the checks` : "What happened"}</summary>
          {message && <p>{message}</p>}
          <ul>{flags.map((one, k) => <li key={k} class={one.severity}><b>{one.severity}</b> {one.text}{one.where ? ` (${one.where})` : ""}.{one.advice ? ` ${one.advice}` : ""}</li>)}</ul>
        </details>
      )}
      {model.unit === "mm" && (
        <label class="units">Lengths in{" "}
          <select value={units.value} onChange={(event) => setUnits(event.currentTarget.value as Units)}><option value="mm">mm</option><option value="in">inches</option></select>
        </label>
      )}
      <button type="button" class="help" onClick={() => (helpOpen.value = true)} aria-label="Keys" title="Keys (?)">?</button>
    </header>
  );
}

/** Where several models hold findings, how many there are in all: a range, since one place may have a record in each. */
function inAll(range: readonly [number, number] | null | undefined): string {
  return range ? ` here (${range[0]} to ${range[1]} in all models)` : "";
}

/** Links lead to other pages of the result only. */
function safe(href: string): string {
  return /^(\.\.\/)*[\w./-]+$/.test(href) && !href.startsWith("/") ? href : "#";
}
