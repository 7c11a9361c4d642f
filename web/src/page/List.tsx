/** The lists: findings, frames, detections. Counting and ranking happen here. */

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { TABS, type Tab } from "../model/hash";
import { SORTS, type SortKey } from "../model/sorting";
import { bladeText, certainty, findingName, measured, percent, reasonText, seconds } from "../model/words";
import { data, detectionsOfFrame, order, seenBlades, visitsOfFinding } from "../session";
import {
  allFindings, blade, descending, detection, filters, finding, frame, go, onlyUnplaced, place, reviewState, selectDetection, selectFinding,
  selectFrame, setTab, shownFindings, sort, tab, units,
} from "../state";
import { DetectionThumb, FindingThumb, LabelMark, Tile } from "./marks";

const NAMES: Readonly<Record<Tab, string>> = { findings: "Findings", frames: "Frames", detections: "Detections" };
const counts = (): Readonly<Record<Tab, number>> => ({ findings: allFindings.value.length, frames: data.frames.length, detections: data.detections.length });

export function List(): JSX.Element {
  return (
    <section class="panel list" aria-label="Lists">
      <div class="tabs" role="tablist" aria-label="What is listed" onKeyDown={stepTab}>
        {TABS.map((name) => (
          <button key={name} role="tab" id={`tab-${name}`} type="button" aria-selected={tab.value === name} aria-controls="listed" tabIndex={tab.value === name ? 0 : -1} onClick={() => setTab(name)}>
            {NAMES[name]} <span class="count">{counts()[name]}</span>
          </button>
        ))}
      </div>
      <div id="listed" class="listed" role="tabpanel" aria-labelledby={`tab-${tab.value}`}>
        {tab.value === "findings" ? <Findings /> : tab.value === "frames" ? <Frames /> : <Detections />}
      </div>
    </section>
  );
}

function stepTab(event: KeyboardEvent): void {
  const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
  if (!by) return;
  event.preventDefault();
  event.stopPropagation();
  const next = TABS[(TABS.indexOf(tab.value) + by + TABS.length) % TABS.length] as Tab;
  setTab(next);
  document.getElementById(`tab-${next}`)?.focus();
}

function useInSight(chosen: number | null): (element: HTMLElement | null) => void {
  const current = useRef<HTMLElement | null>(null);
  useEffect(() => current.current?.scrollIntoView({ block: "nearest" }), [chosen]);
  return (element) => {
    if (element) current.current = element;
  };
}

function Findings(): JSX.Element {
  const list = shownFindings.value;
  const inSight = useInSight(place.value.d);
  if (!allFindings.value.length) return <Nothing />;
  return (
    <>
      <FindingFilters shown={list.length} />
      <ul class="rows">
        {list.map((one) => {
          const chosen = finding.value?.id === one.id;
          const review = reviewState.value.get(one.id);
          const visits = visitsOfFinding.get(one.id)?.length ?? one.events.length;
          return (
            <li key={one.id}>
              <button type="button" class="row" aria-current={chosen} ref={chosen ? inSight : null} onClick={() => selectFinding(one.id)}>
                <FindingThumb finding={one} />
                <span class="what">
                  <span class="head"><LabelMark label={one.label} /> <b>{findingName(one.id)}</b> <bdi class="label">{one.label}</bdi>
                    {review && <span class={`review ${review}`}>{review}</span>}</span>
                  <span class="facts">
                    <span>{one.length !== null && one.length !== undefined ? "length" : "size"} {measured(one.length ?? one.size, one.length === null || one.length === undefined ? one.size_sigma : one.length_sigma, one.length_unit ?? one.size_unit ?? data.model.unit, units.value)}</span>
                    <span>blade {bladeText(one.blade)}</span>
                    <span title={`Detected in ${one.persistence.k} of the ${one.persistence.n} frames that could show it`}>seen {one.persistence.k}/{one.persistence.n}</span>
                    <span>{visits} {visits === 1 ? "visit" : "visits"}</span>
                  </span>
                </span>
                <span class={`sure ${one.confidence ? certainty(one.confidence.value) : ""}`}>
                  {one.confidence ? <>{percent(one.confidence.value)}<small>{certainty(one.confidence.value)}</small></> : <small>no confidence</small>}
                </span>
              </button>
            </li>
          );
        })}
      </ul>
    </>
  );
}

function Nothing(): JSX.Element {
  const reasons = new Map<string, number>();
  for (const one of data.detections) if (one.state === "unplaced") reasons.set(one.reason ?? "unknown", (reasons.get(one.reason ?? "unknown") ?? 0) + 1);
  return (
    <div class="empty">
      <p><b>No finding is on the surface.</b></p>
      {data.message && <p>{data.message}</p>}
      {data.detections.length === 0 ? <p>The annotations hold no detection inside the video.</p> : <p>{counted(data.detections.length, "detection")} read. {reasons.size > 0 && "Without a place:"}</p>}
      <ul>{[...reasons].sort((a, b) => b[1] - a[1]).map(([code, count]) => <li key={code}>{count}: {reasonText(data, code)}</li>)}</ul>
      {data.models.length > 0 && <p>The findings of other models are on their own pages, linked above.</p>}
    </div>
  );
}

function counted(count: number, name: string): string {
  return `${count} ${name}${count === 1 ? " was" : "s were"}`;
}

function FindingFilters({ shown }: { readonly shown: number }): JSX.Element {
  const set = (name: keyof typeof filters.value) => (event: Event) => {
    filters.value = { ...filters.value, [name]: (event.currentTarget as HTMLInputElement | HTMLSelectElement).value };
  };
  const labels = [...new Set(data.defects.map((one) => one.label))].sort();
  const blades = [...new Set(data.defects.map((one) => String(one.blade ?? "")).filter(Boolean))].sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
  return (
    <div class="filters">
      <label>Sort
        <select value={sort.value} onChange={(event) => (sort.value = event.currentTarget.value as SortKey)}>
          {Object.entries(SORTS).map(([key, text]) => <option key={key} value={key}>{text}</option>)}
        </select>
      </label>
      <button type="button" class="square" onClick={() => (descending.value = !descending.value)} aria-label={descending.value ? "Largest first; sort the other way" : "Smallest first; sort the other way"}>{descending.value ? "↓" : "↑"}</button>
      <label>Label
        <select value={filters.value.label} onChange={set("label")}>
          <option value="">all</option>
          {labels.map((label) => <option key={label} value={label}>{label}</option>)}
        </select>
      </label>
      {blades.length > 0 && (
        <label>Blade
          <select value={filters.value.blade} onChange={set("blade")}>
            <option value="">all</option>
            {blades.map((one) => <option key={one} value={one}>{one}</option>)}
          </select>
        </label>
      )}
      <label>Confidence
        <select value={filters.value.confidence} onChange={set("confidence")}>
          <option value="">any</option><option value="0.4">at least medium</option><option value="0.75">high</option>
        </select>
      </label>
      <label>Review
        <select value={filters.value.review} onChange={set("review")}>
          <option value="">any</option><option value="open">open</option><option value="accepted">accepted</option><option value="rejected">rejected</option><option value="merged">merged</option>
        </select>
      </label>
      <output aria-live="polite">{shown} of {allFindings.value.length}</output>
    </div>
  );
}

function Frames(): JSX.Element {
  const inSight = useInSight(place.value.f);
  const registered = data.frames.filter((one) => one.registered).length;
  return (
    <>
      <p class="note">{registered} of {data.frames.length} frames have a camera in this model.</p>
      <ul class="rows">
        {order.map((one) => {
          const chosen = frame.value?.index === one.index;
          const boxes = detectionsOfFrame.get(one.index)?.length ?? 0;
          return (
            <li key={one.index}>
              <button type="button" class="row slim" aria-current={chosen} ref={chosen ? inSight : null} onClick={() => selectFrame(one.index)}>
                <Tile frame={one} width={48} />
                <span class="what">
                  <span class="head"><b>Frame {one.source_index}</b> {data.videos.length > 1 && <span>video {one.video}</span>} <span>{seconds(one.time_s)}</span></span>
                  <span class="facts">
                    <span>{boxes ? `${boxes} ${boxes === 1 ? "detection" : "detections"}` : "no detection"}</span>
                    {!one.registered && <span class="warn">not registered: {reasonText(data, one.reason ?? "not_registered")}</span>}
                  </span>
                </span>
              </button>
            </li>
          );
        })}
      </ul>
    </>
  );
}

function Detections(): JSX.Element {
  const inSight = useInSight(place.value.n);
  const unplaced = data.detections.filter((one) => one.state === "unplaced").length;
  const list = onlyUnplaced.value ? data.detections.filter((one) => one.state === "unplaced") : data.detections;
  return (
    <>
      <div class="filters">
        <label class="check"><input type="checkbox" checked={onlyUnplaced.value} onChange={() => (onlyUnplaced.value = !onlyUnplaced.value)} /> without a place ({unplaced})</label>
        <output aria-live="polite">{list.length} of {data.detections.length}</output>
      </div>
      <ul class="rows">
        {list.map((one) => {
          const chosen = detection.value?.id === one.id;
          return (
            <li key={one.id}>
              <button type="button" class="row slim" aria-current={chosen} ref={chosen ? inSight : null} onClick={() => selectDetection(one.id)}>
                <DetectionThumb detection={one} />
                <span class="what">
                  <span class="head"><LabelMark label={one.label} px={12} /> <bdi class="label">{one.label}</bdi> {one.time_s !== undefined && <span>{seconds(one.time_s)}</span>} {one.defect !== null && <b>D{one.defect}</b>}</span>
                  <span class="facts"><span class={one.state === "mapped" ? "" : "warn"}>{one.state}{one.reason ? `: ${reasonText(data, one.reason)}` : ""}</span></span>
                </span>
              </button>
            </li>
          );
        })}
      </ul>
    </>
  );
}

/** Says that one blade stands alone, and ends it. */
export function BladeAlone(): JSX.Element | null {
  if (blade.value === null) return null;
  const name = seenBlades.find(({ number }) => number === blade.value)?.name ?? blade.value;
  return <button type="button" onClick={() => go({ b: null }, true)}>Only blade {name} is shown: show all</button>;
}
