/** One selection that list, surface, frame and timeline share, and its copy in the address. */

import { batch, computed, effect, signal, untracked } from "@preact/signals";
import type { Finding, Vec3 } from "./model/data";
import { formatHash, NOWHERE, parseHash, type Layer, type Place, type Tab } from "./model/hash";
import { byRank, type SortKey } from "./model/sorting";
import { findingName, type Units } from "./model/words";
import type { VisibleFrame, SurfaceHit } from "./scene/questions";
import { data, detections, detectionsOfFrame, findings, frames, order, position, questions, surface, visitsOfFinding } from "./session";

export const place = signal<Place>(NOWHERE);
export const tab = computed(() => place.value.tab);
export const layer = computed(() => place.value.layer);
/** Findings that people made, by numbers below zero; filled by `review.ts`. */
export const made = signal<ReadonlyMap<number, Finding>>(new Map());
export const allFindings = computed<readonly Finding[]>(() => [...data.defects, ...made.value.values()]);
export const findingOf = (id: number): Finding | undefined => findings.get(id) ?? made.value.get(id);
export const finding = computed(() => (place.value.d === null ? null : (findingOf(place.value.d) ?? null)));
export const frame = computed(() => (place.value.f === null ? null : (frames.get(place.value.f) ?? null)));
export const detection = computed(() => (place.value.n === null ? null : (detections.get(place.value.n) ?? null)));
export const blade = computed(() => place.value.b);

export type Boxes = "outlines" | "filled" | "off";
export const boxes = signal<Boxes>("outlines");
/** Of the surface laid over the frame, 0 to 1. */
export const overlay = signal(0);
export const frusta = signal(false);
/** Share of the surface's depth that the clip plane takes away from the viewer's side, 0 = off. */
export const clip = signal(0);
export const measuring = signal(false);
export const measured = signal<readonly Vec3[]>([]);
export const playing = signal(false);
/** A box that is being drawn on the current frame, px: of a finding to be added, or around the new place of one. */
export const drawing = signal<{ readonly what: "add" | "move"; readonly box: readonly [number, number, number, number] } | null>(null);
export const helpOpen = signal(false);
/** In which lengths are shown where a scale is known; the browser keeps it where it may. */
export const units = signal<Units>(keptUnits());
/** What the pixel clicked last shows. */
export const asked = signal<{ readonly frame: number; readonly x: number; readonly y: number; readonly shown: SurfaceHit } | null>(null);
/** The camera that an address asks for: on opening, on Back, by a link. */
export const addressed = signal<readonly number[] | null>(null);
/** Spoken to screen readers. */
export const announcement = signal("");

export const sort = signal<SortKey>("size");
export const descending = signal(true);
export const filters = signal({ label: "", blade: "", confidence: "", review: "", words: "" });
export const onlyUnplaced = signal(false);

/** Frames that show what is selected, best first: of a point, else of a finding. */
export const visibleFrames = computed<readonly VisibleFrame[]>(() => {
  const p = place.value.p;
  if (p && surface) {
    const near = surface.nearest(p);
    return near ? questions.visibleFrames(near.point, near.normal) : [];
  }
  const one = finding.value;
  return one ? one.frames.map(({ frame_index, quality }) => ({ frame: frame_index, quality, x: NaN, y: NaN })) : [];
});

const UNITS_KEY = "bladeatlas-units";

function keptUnits(): Units {
  try {
    return localStorage.getItem(UNITS_KEY) === "in" ? "in" : "mm";
  } catch {
    return "mm"; // a page opened as a file may keep nothing
  }
}

export function setUnits(wanted: Units): void {
  units.value = wanted;
  try {
    localStorage.setItem(UNITS_KEY, wanted);
  } catch {
    // The page shows them as long as it is open.
  }
}

type Change = Partial<Place>;

/** Changes the state; a step of its own for Back unless `quiet`. */
export function go(change: Change, quiet = false): void {
  const next = { ...place.peek(), ...change };
  const fragment = formatHash(next);
  place.value = next;
  if (fragment === (location.hash || "#")) return;
  if (quiet) location.replace(fragment);
  else location.hash = fragment;
}

export function selectFinding(id: number | null, at: { frame?: number } = {}): void {
  const one = id === null ? undefined : findingOf(id);
  batch(() => {
    asked.value = null;
    if (!one) return go({ d: null, n: null, p: null });
    const current = place.peek().f;
    const shown = at.frame ?? bestFrame(one.id) ?? current;
    go({ d: one.id, f: shown, n: null, p: null, cam: null });
    announcement.value = `Finding ${findingName(one.id)}, ${one.label}${shown === null ? "" : `, frame ${shown}`}`;
  });
}

/** The frame that shows a finding best: one with its box, if there is any. */
export function bestFrame(id: number): number | null {
  const one = findingOf(id);
  if (!one) return null;
  const detected = one.frames.find((sighting) => sighting.detected)?.frame_index;
  const own = one.detections.map((k) => detections.get(k)?.frame).find((k) => k !== null && k !== undefined);
  return one.best?.frame ?? one.best_frames[0] ?? detected ?? own ?? one.frames[0]?.frame_index ?? null;
}

export function selectFrame(index: number | null, quiet = false): void {
  if (index === null || !frames.has(index)) return;
  const chosen = detection.peek();
  batch(() => {
    if (asked.peek()?.frame !== index) asked.value = null;
    go({ f: index, n: chosen?.frame === index ? chosen.id : null }, quiet);
  });
}

export function selectDetection(id: number): void {
  const one = detections.get(id);
  if (!one) return;
  asked.value = null;
  const known = one.defect !== null && findings.has(one.defect);
  go({ n: id, d: known ? one.defect : null, f: one.frame ?? place.peek().f, p: null });
  announcement.value = `Detection ${id}, ${one.label}, ${one.state}`;
}

/** A place of the surface, and the finding that it belongs to. */
export function selectPoint(p: Vec3, on: number, at?: number): void {
  batch(() => {
    const known = findings.has(on);
    const near = at === undefined && surface ? surface.nearest(p) : null;
    const current = place.peek().f;
    const list = near ? questions.visibleFrames(near.point, near.normal) : [];
    // A finding brings its best frame; elsewhere the current frame stays as long as it sees the place.
    const shown = at ?? (known ? bestFrame(on) : list.some((one) => one.frame === current) ? current : (list[0]?.frame ?? current));
    asked.value = null;
    go({ p: [p[0], p[1], p[2]], d: known ? on : null, n: null, f: shown });
    announcement.value = known ? `Finding ${findingName(on)}` : "Point of the surface";
  });
}

/** Asks what a pixel of the current frame shows, and selects that. */
export function askPixel(x: number, y: number): void {
  const index = place.peek().f;
  if (index === null) return;
  const shown = questions.pointAt(index, x, y);
  const hit = (detectionsOfFrame.get(index) ?? []).find(({ box }) => x >= box[0] && x <= box[2] && y >= box[1] && y <= box[3]);
  batch(() => {
    if (shown.reason === null) selectPoint(shown.point, hit?.defect ?? shown.finding, index);
    else if (hit) selectDetection(hit.id);
    if (hit) go({ n: hit.id }, true);
    asked.value = { frame: index, x, y, shown };
  });
}

export function stepFrame(by: number): void {
  const at = place.peek().f;
  const now = at === null ? -1 : (position.get(at) ?? -1);
  selectFrame(order[Math.max(0, Math.min(order.length - 1, now + by))]?.index ?? null, true);
}

/** Next or previous frame, by time, among those that show what is selected. */
export function stepVisible(by: number): void {
  const among = visibleFrames.peek().map((one) => one.frame).sort((a, b) => (position.get(a) ?? 0) - (position.get(b) ?? 0));
  const now = position.get(place.peek().f ?? -1) ?? -1;
  const next = by > 0 ? among.find((k) => (position.get(k) ?? 0) > now) : among.filter((k) => (position.get(k) ?? 0) < now).pop();
  if (next !== undefined) selectFrame(next);
}

export function stepFinding(by: number, wanted: (id: number) => boolean = () => true): void {
  const list = shownFindings.peek();
  const at = list.findIndex((one) => one.id === place.peek().d);
  for (let k = at + by; k >= 0 && k < list.length; k += by) {
    const one = list[at < 0 && by < 0 ? list.length - 1 : k];
    if (one && wanted(one.id)) return selectFinding(one.id);
  }
}

export const setTab = (value: Tab): void => go({ tab: value }, true);
export const setLayer = (value: Layer): void => go({ layer: value }, true);

/** State of review by finding; filled by `review.ts`, which the list's filter asks. */
export const reviewState = signal<ReadonlyMap<number, string>>(new Map());

export const shownFindings = computed(() => {
  const { label, blade: on, confidence, review, words } = filters.value;
  const found = words.trim().toLowerCase();
  const kept = allFindings.value.filter(
    (one) =>
      (!label || one.label === label) &&
      (!on || String(one.blade ?? "") === on) &&
      (!confidence || (one.confidence?.value ?? 0) >= Number(confidence)) &&
      (!review || (reviewState.value.get(one.id) ?? "open") === review) &&
      (!found || `${findingName(one.id).toLowerCase()} ${one.label} ${one.blade ?? ""} ${one.side ?? ""}`.toLowerCase().includes(found)),
  );
  return [...kept].sort(byRank(sort.value, descending.value, visitsOfFinding));
});

/** Follows the address: reload, Back, and links from elsewhere. */
export function followAddress(): void {
  const read = (): void => {
    if (formatHash(place.peek()) === (location.hash || "#")) return;
    const told = parseHash(location.hash);
    place.value = told;
    addressed.value = told.cam;
  };
  place.value = parseHash(location.hash);
  window.addEventListener("hashchange", read);
  const { d, f, n } = place.peek();
  if (f === null) {
    const own = n === null ? undefined : detections.get(n)?.frame;
    const first = data.frames.find((one) => one.registered && one.picture) ?? order[0];
    place.value = { ...place.peek(), f: own ?? (d === null ? null : bestFrame(d)) ?? first?.index ?? null };
  }
}

/** Runs frames from one time to another at the pace of the video; a second call stops. */
export function play(from?: number, to?: number): void {
  if (playing.peek()) {
    playing.value = false;
    return;
  }
  const start = from ?? position.get(place.peek().f ?? -1) ?? 0;
  const end = to ?? order.length - 1;
  playing.value = true;
  let at = start;
  const next = (): void => {
    if (!playing.peek() || at > end) {
      playing.value = false;
      return;
    }
    const now = order[at];
    if (now) selectFrame(now.index, true);
    const later = order[at + 1];
    const wait = now && later && later.video === now.video ? 1000 * (later.time_s - now.time_s) : 100;
    at += 1;
    setTimeout(next, Math.max(40, Math.min(500, wait)));
  };
  next();
}

/** Plays a visit with two seconds before and after it. */
export function playVisit(start_s: number, end_s: number, video: number): void {
  const inside = order.flatMap((one, k) => (one.video === video && one.time_s >= start_s - 2 && one.time_s <= end_s + 2 ? [k] : []));
  const [first, last] = [inside[0], inside[inside.length - 1]];
  if (first !== undefined && last !== undefined) play(first, last);
}

effect(() => {
  const name = finding.value ? `${findingName(finding.value.id)} ${finding.value.label} · ` : "";
  untracked(() => (document.title = `${name}${data.title}`));
});
