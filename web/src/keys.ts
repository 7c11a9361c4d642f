/** Everything by keyboard. The keys can be switched off, for people who speak to their computer. */

import { signal } from "@preact/signals";
import { act, asking, draw, drawn, stepOpen, undo, type Asked } from "./review";
import { fromFrame, home, keepLength, nearFinding, toggleMeasuring, view } from "./page/Surface3D";
import { stepBoxes } from "./page/FrameView";
import {
  bestFrame, drawing, finding, frusta, go, helpOpen, overlay, place, play, playing, selectFinding, selectFrame, setLayer, stepFinding, stepFrame, stepVisible,
} from "./state";
import { keeps, size, surface } from "./session";

interface Key {
  readonly keys: readonly string[];
  readonly says: string;
  readonly group: string;
  readonly run: () => void;
}

const ask = (what: Asked): void => {
  if (finding.peek()) asking.value = what;
};

export const KEYS: readonly Key[] = [
  { group: "Findings", keys: ["ArrowDown", "j"], says: "next finding of the list", run: () => stepFinding(1) },
  { group: "Findings", keys: ["ArrowUp", "k"], says: "previous finding", run: () => stepFinding(-1) },
  { group: "Findings", keys: ["Escape"], says: "select nothing", run: () => { selectFinding(null); } },
  { group: "Review", keys: ["ArrowRight"], says: "next finding without a review", run: () => stepOpen(1) },
  { group: "Review", keys: ["ArrowLeft"], says: "previous finding without a review", run: () => stepOpen(-1) },
  { group: "Review", keys: ["a"], says: "accept", run: () => act("accept") },
  { group: "Review", keys: ["r"], says: "reject, with a reason", run: () => ask("reject") },
  { group: "Review", keys: ["l"], says: "give another label", run: () => ask("relabel") },
  { group: "Review", keys: ["n"], says: "write a note", run: () => ask("note") },
  { group: "Review", keys: ["s"], says: "severity: what shall be done", run: () => ask("severity") },
  { group: "Review", keys: ["t"], says: "tell its blade", run: () => ask("set_blade") },
  { group: "Review", keys: ["g"], says: "merge it into another finding", run: () => ask("merge") },
  { group: "Review", keys: ["y"], says: "split detections off", run: () => { if ((finding.peek()?.detections.length ?? 0) > 1) ask("split"); } },
  { group: "Review", keys: ["w"], says: "move it: arrows or a click in the frame, Enter keeps", run: () => draw("move") },
  { group: "Review", keys: ["d"], says: "add a finding: draw it on the frame, Enter keeps", run: () => draw("add") },
  { group: "Review", keys: ["u"], says: "keep the measured length", run: keepLength },
  { group: "Review", keys: ["z"], says: "take the last action back", run: undo },
  { group: "Frame", keys: ["."], says: "next frame of the video", run: () => stepFrame(1) },
  { group: "Frame", keys: [","], says: "previous frame of the video", run: () => stepFrame(-1) },
  { group: "Frame", keys: ["]"], says: "next frame that shows the selection", run: () => stepVisible(1) },
  { group: "Frame", keys: ["["], says: "previous frame that shows the selection", run: () => stepVisible(-1) },
  { group: "Frame", keys: ["b"], says: "best frame of the finding", run: () => { if (finding.peek()) selectFrame(bestFrame(finding.peek()!.id)); } },
  { group: "Frame", keys: ["o"], says: "surface over the frame: off, half, full", run: () => { overlay.value = overlay.peek() === 0 ? 0.5 : overlay.peek() < 1 ? 1 : 0; } },
  { group: "Frame", keys: ["x"], says: "boxes and masks: outlines, filled, off", run: stepBoxes },
  { group: "Frame", keys: ["p"], says: "play or stop", run: () => play() },
  { group: "Surface", keys: ["v"], says: "view from the camera of the frame", run: fromFrame },
  { group: "Surface", keys: ["f"], says: "zoom to the finding", run: nearFinding },
  { group: "Surface", keys: ["h"], says: "whole surface", run: home },
  { group: "Surface", keys: ["1"], says: "shading by picture", run: () => setLayer("picture") },
  { group: "Surface", keys: ["2"], says: "shading by support: what was observed", run: () => setLayer("support") },
  { group: "Surface", keys: ["3"], says: "shading by finding", run: () => setLayer("defect") },
  { group: "Surface", keys: ["4"], says: "shading by blade", run: () => { if (surface?.mesh.blade.some((one) => one > 0)) setLayer("blade"); } },
  { group: "Surface", keys: ["c"], says: "camera frusta", run: () => { frusta.value = !frusta.peek(); } },
  { group: "Surface", keys: ["m"], says: "measure: Enter or a click sets a point", run: toggleMeasuring },
  { group: "Surface", keys: ["+"], says: "nearer", run: () => view.peek()?.orbit.zoom(0.85) },
  { group: "Surface", keys: ["-"], says: "farther", run: () => view.peek()?.orbit.zoom(1.18) },
  { group: "Page", keys: ["?"], says: "this list", run: () => { helpOpen.value = !helpOpen.peek(); } },
];

/** Moves the box that is being drawn, or with Shift its far corner; Enter ends the drawing, Escape leaves it. */
function drawByKey(event: KeyboardEvent): boolean {
  const now = drawing.peek();
  const by = ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] } as Record<string, readonly [number, number]>)[event.key];
  if (event.key === "Enter") drawn();
  else if (event.key === "Escape") drawing.value = null;
  else if (!now || !by) return false;
  else {
    const [x, y] = by.map((one) => (one * size.width) / 100) as [number, number];
    const [x0, y0, x1, y1] = now.box;
    const keep = event.shiftKey;
    const box = [x0 + (keep ? 0 : x), y0 + (keep ? 0 : y), x1 + x, y1 + y] as const;
    if (box[2] - box[0] > 2 && box[3] - box[1] > 2) drawing.value = { ...now, box };
  }
  event.preventDefault();
  return true;
}

const STORED = "bladeatlas keys off";
export const keysOn = signal(stored());

export function setKeys(on: boolean): void {
  keysOn.value = on;
  if (!keeps) return;
  try {
    localStorage.setItem(STORED, on ? "" : "1");
  } catch {
    // A browser that keeps nothing asks again next time.
  }
}

function stored(): boolean {
  if (!keeps) return true;
  try {
    return localStorage.getItem(STORED) !== "1";
  } catch {
    return true;
  }
}

export function listen(): void {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const target = event.target as HTMLElement;
    const typing = target.matches("input:not([type=range],[type=checkbox]), select, textarea");
    const sliding = target.matches("input[type=range]") && event.key.startsWith("Arrow");
    if (typing || sliding || (helpOpen.peek() && event.key !== "?" && event.key !== "Escape")) return;
    if (drawing.peek() && drawByKey(event)) return;
    if (event.key === "Escape") {
      if (helpOpen.peek()) return void (helpOpen.value = false);
      playing.value = false;
      asking.value = null;
      return place.peek().d !== null || place.peek().p ? selectFinding(null) : go({ n: null }, true);
    }
    if (!keysOn.peek() && event.key !== "?") return;
    const one = KEYS.find(({ keys }) => keys.includes(event.key) || keys.includes(event.key.toLowerCase()));
    if (!one) return;
    event.preventDefault();
    one.run();
  });
}
