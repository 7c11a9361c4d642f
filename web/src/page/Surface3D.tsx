/** The 3D pane: canvas, labels that the surface can hide, measuring, orientation. */

import { effect, signal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Vec3 } from "../model/data";
import { LAYERS, type Layer } from "../model/hash";
import { bladeText, findingName, measured as amount, scaled } from "../model/words";
import { norm, sub } from "../model/pose";
import { pathAlong } from "../scene/along";
import { handle } from "../scene/orbit";
import { View3D } from "../scene/view3d";
import { data, marks, questions, surface, surfaceReason } from "../session";
import { addressed, blade, clip, finding, frame, frusta, go, layer, measured, measuring, place, selectPoint, setLayer, units } from "../state";
import { keepMeasured } from "../review";
import { drawMarks } from "./marks3d";

export const view = signal<View3D | null>(null);
const trouble = signal<string | null>(null);

const LAYER_NAMES: Readonly<Record<Layer, string>> = { picture: "Picture", support: "Support", defect: "Findings", blade: "Blades" };

export function Surface3D(): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const labels = useRef<HTMLDivElement>(null);
  const lines = useRef<SVGSVGElement>(null);
  useEffect(() => (canvas.current && labels.current && lines.current ? start(canvas.current, labels.current, lines.current) : undefined), []);
  const why = surfaceReason ?? trouble.value;
  const hasBlades = surface?.mesh.blade.some((one) => one > 0) ?? false;
  return (
    <section class="panel surface" aria-label="Surface">
      <div class="bar">
        <h2>Surface</h2>
        <div class="choice" role="group" aria-label="Shading">
          {LAYERS.filter((one) => one !== "blade" || hasBlades).map((one) => (
            <button key={one} type="button" aria-pressed={layer.value === one} disabled={!!why} onClick={() => setLayer(one)}>{LAYER_NAMES[one]}</button>
          ))}
        </div>
        <div class="choice" role="group" aria-label="View">
          <button type="button" disabled={!!why} onClick={home} title="Whole surface (H)">Whole</button>
          <button type="button" disabled={!!why || !finding.value} onClick={nearFinding} title="Zoom to the finding (F)">Finding</button>
          <button type="button" disabled={!!why || !frame.value?.registered} onClick={fromFrame} title="As the camera of the frame saw it (V)">Camera</button>
        </div>
        <button type="button" aria-pressed={frusta.value} disabled={!!why} onClick={() => (frusta.value = !frusta.value)} title="Camera frusta (C)">Frusta</button>
        <button type="button" aria-pressed={measuring.value} disabled={!!why} onClick={toggleMeasuring} title="Distance between two points (M)">Measure</button>
        <label class="slide">Cut <input type="range" min="0" max="1" step="0.01" value={clip.value} disabled={!!why} aria-label="Clip plane: how much of the near side is cut away" onInput={(event) => (clip.value = Number(event.currentTarget.value))} /></label>
      </div>
      <div class={measuring.value ? "stage measuring" : "stage"}>
        {why ? <div class="why" role="status"><p><b>No surface is shown.</b></p><p>{why}</p>{data.flags.filter((one) => one.severity === "error").map((one) => <p key={one.code}>{one.text}{one.advice ? ` ${one.advice}` : ""}</p>)}</div> : (
          <>
            <canvas ref={canvas} tabIndex={0} role="img" aria-label="The reconstructed surface. Arrow keys turn it, plus and minus zoom." onKeyDown={turnByKey} />
            <svg ref={lines} class="lines" aria-hidden="true" />
            <div ref={labels} class="labels" aria-hidden="true" />
            <Legend />
            <Measured />
            <Orientation />
          </>
        )}
      </div>
    </section>
  );
}

function start(canvas: HTMLCanvasElement, labels: HTMLDivElement, lines: SVGSVGElement): (() => void) | undefined {
  if (!surface) return undefined;
  let made: View3D;
  let settle = 0;
  const draw = (hide: boolean): void => drawMarks(made, labels, lines, hide);
  try {
    made = new View3D(canvas, surface, questions, data, () => {
      draw(false);
      clearTimeout(settle);
      settle = window.setTimeout(() => draw(true), 120);
    });
  } catch (error) {
    trouble.value = `This browser draws no 3D here (${error instanceof Error ? error.message : String(error)}). List, frames and timeline work without.`;
    return undefined;
  }
  view.value = made;
  const fit = (): void => made.resize(canvas.clientWidth, canvas.clientHeight);
  const observer = new ResizeObserver(fit);
  observer.observe(canvas);
  fit();
  const told = place.peek().cam;
  if (told) made.orbit.numbers = told;
  const release = handle(canvas, made.orbit, (x, y) => clicked(made, x, y));
  const remember = (): void => go({ cam: made.orbit.numbers.map((value) => Number(value.toPrecision(5))) }, true);
  const settled = (): void => void window.setTimeout(remember, 300);
  canvas.addEventListener("pointerup", settled);
  canvas.addEventListener("keyup", settled);
  let last: number | null = place.peek().cam ? place.peek().d : null;
  const stops = [
    effect(() => {
      made.show({ layer: layer.value, finding: finding.value?.id ?? null, blade: blade.value, frame: frame.value?.index ?? null, frusta: frusta.value, clip: clip.value });
      void measured.value;
      const id = place.value.d;
      if (id !== null && id !== last && finding.value) made.near(finding.value, place.peek().f);
      last = id;
    }),
    effect(() => {
      if (addressed.value) made.orbit.numbers = addressed.value;
    }),
  ];
  return () => {
    for (const stop of stops) stop();
    release();
    observer.disconnect();
    view.value = null;
  };
}

function clicked(made: View3D, x: number, y: number): void {
  const hit = made.pick(x, y);
  if (!hit) return;
  if (measuring.peek()) {
    measured.value = [...(measured.peek().length >= 2 ? [] : measured.peek()), hit.point];
    made.request();
    return;
  }
  selectPoint(hit.point, hit.finding);
}

export function home(): void {
  view.peek()?.whole();
  go({ cam: null }, true);
}
export function nearFinding(): void {
  if (finding.peek()) view.peek()?.near(finding.peek()!, place.peek().f);
}
export function fromFrame(): void {
  const at = place.peek().f;
  if (at !== null) view.peek()?.from(at);
}
export function toggleMeasuring(): void {
  measuring.value = !measuring.peek();
  if (!measuring.peek()) measured.value = [];
  view.peek()?.request();
}

function turnByKey(event: KeyboardEvent): void {
  const orbit = view.peek()?.orbit;
  const step = 0.12;
  const act: Record<string, () => void> = {
    ArrowLeft: () => orbit?.turn(step, 0),
    ArrowRight: () => orbit?.turn(-step, 0),
    ArrowUp: () => orbit?.turn(0, step),
    ArrowDown: () => orbit?.turn(0, -step),
    "+": () => orbit?.zoom(0.85),
    "=": () => orbit?.zoom(0.85),
    "-": () => orbit?.zoom(1.18),
    Enter: () => {
      const made = view.peek();
      if (made) clicked(made, made.canvas.clientWidth / 2, made.canvas.clientHeight / 2);
    },
  };
  const own = act[event.key];
  if (!own || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  event.stopPropagation();
  own();
}

function Legend(): JSX.Element | null {
  if (layer.value === "support") {
    return (
      <ul class="legend">
        <li><i class="swatch observed" /> observed</li>
        <li><i class="swatch weak" /> weak</li>
        <li><i class="swatch unseen" /> not seen: no finding says nothing</li>
      </ul>
    );
  }
  const labels = [...new Set(data.defects.map((one) => one.label))].sort();
  return (
    <ul class="legend">
      {labels.map((label) => (
        <li key={label}>
          <svg width="12" height="12" viewBox="-1.3 -1.3 2.6 2.6" aria-hidden="true"><path d={marks.get(label)?.shape ?? ""} fill={marks.get(label)?.css ?? "gray"} stroke="#10151a" stroke-width=".2" /></svg> <bdi>{label}</bdi>
        </li>
      ))}
    </ul>
  );
}

function Measured(): JSX.Element | null {
  if (!measuring.value) return null;
  const [a, b] = measured.value;
  const text = !a ? "Click the first point." : !b ? "Click the second point." : distances(a, b);
  return <p class="measured" role="status">{text}{a && b && finding.value && <> <button type="button" onClick={keepLength} title="Keep (U)">Keep for {findingName(finding.value.id)}</button></>}</p>;
}

/** Keeps the length that was measured: along the surface where there is a path. */
export function keepLength(): void {
  const [a, b] = measured.peek();
  if (!a || !b || !finding.peek()) return;
  const along = surface ? pathAlong(surface, a, b) : null;
  const straight = norm(sub(a, b));
  keepMeasured(along === null ? straight : Math.max(along, straight), along !== null, Math.SQRT2 * questions.spacing);
}

function distances(a: Vec3, b: Vec3): string {
  // Each end may lie anywhere between two neighbouring points of the surface.
  const error = Math.SQRT2 * questions.spacing;
  const straight = norm(sub(a, b));
  const along = surface ? pathAlong(surface, a, b) : null;
  const say = (length: number): string => {
    const { value, sigma, unit } = scaled(length, error, data.model);
    return `${amount(value, sigma, unit, units.value)}${unit === "model" ? " model units (unscaled)" : ""}`;
  };
  return `Straight ${say(straight)}${along === null ? "; no path along the surface" : `; along the surface ${say(Math.max(along, straight))}`}`;
}

/** What is known of root, tip and blades; unknown is said. */
function Orientation(): JSX.Element {
  const row = data.row;
  const known = row.status === "estimated" || row.status === "user";
  return (
    <p class="orientation">
      {known ? <>Row: {row.status === "user" ? "told by the user" : "estimated"}</> : <>Root, tip, blades: unknown{row.reason ? ` (${String(row.reason).replaceAll("_", " ")})` : ""}</>}
      {finding.value && known && <> · D{finding.value.id}: blade {bladeText(finding.value.blade)}</>}
    </p>
  );
}
