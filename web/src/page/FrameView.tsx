/** The frame pane: the picture, what was found on it, and the surface laid over it. */

import { effect, signal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { findingName, measured, percent, reasonText, seconds } from "../model/words";
import { Overlay } from "../scene/overlay";
import { data, detections, detectionsOfFrame, frames, marks, questions, size, surface, surfaceReason } from "../session";
import {
  allFindings, asked, askPixel, blade, boxes, detection, drawing, finding, frame, layer, overlay, place, visibleFrames, selectFrame, stepFrame, stepVisible, type Boxes,
} from "../state";
import { drawn as endDrawing } from "../review";
import { Tile } from "./marks";

/** Width of the picture on the screen over that at which the part of it that was used fills the pane. */
export const zoom = signal(1);
const fitted = signal(1);
let drawn: Overlay | null = null;

/** The one overlay, made when it is first asked for; null without a surface or without WebGL 2. */
export function overlayOn(canvas: HTMLCanvasElement): Overlay | null {
  if (!drawn && surface) {
    try {
      drawn = new Overlay(canvas, surface, questions, size);
    } catch {
      return null;
    }
  }
  return drawn;
}

const NEXT: Readonly<Record<Boxes, Boxes>> = { outlines: "filled", filled: "off", off: "outlines" };
export const stepBoxes = (): void => void (boxes.value = NEXT[boxes.peek()]);

export function FrameView(): JSX.Element {
  const pane = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const one = frame.value;
  useEffect(() => {
    const element = pane.current;
    if (!element) return undefined;
    const fit = (): void => {
      const across = Math.min(size.width, 1.03 * (questions.crop[2] - questions.crop[0]));
      const down = Math.min(size.height, 1.03 * (questions.crop[3] - questions.crop[1]));
      fitted.value = Math.max(80, size.width * Math.min(element.clientWidth / across, element.clientHeight / down));
      centre(element);
    };
    const observer = new ResizeObserver(fit);
    observer.observe(element);
    fit();
    const stop = effect(() => {
      const at = place.value.f;
      const looks = { layer: layer.value, finding: finding.value?.id ?? null, blade: blade.value };
      const width = Math.min(2048, fitted.value * zoom.value * Math.min(2, window.devicePixelRatio || 1));
      if (overlay.value > 0 && canvas.current && at !== null) overlayOn(canvas.current)?.draw(at, width, (width * size.height) / size.width, looks);
    });
    return () => {
      observer.disconnect();
      stop();
    };
  }, []);
  useEffect(() => centre(pane.current), [place.value.f, place.value.d, zoom.value, fitted.value]);
  const width = fitted.value * zoom.value;
  return (
    <section class="panel frame" aria-label="Frame">
      <div class="bar">
        <h2>Frame {one ? one.source_index : ""}</h2>
        {one && <span class="time">{data.videos.length > 1 ? `video ${one.video}, ` : ""}{seconds(one.time_s)}</span>}
        <div class="choice" role="group" aria-label="Frames of the video">
          <button type="button" onClick={() => stepFrame(-1)} aria-label="Previous frame of the video" title="Previous frame (,)">‹</button>
          <button type="button" onClick={() => stepFrame(1)} aria-label="Next frame of the video" title="Next frame (.)">›</button>
        </div>
        <div class="choice" role="group" aria-label="Frames that show the selection">
          <button type="button" disabled={!visibleFrames.value.length} onClick={() => stepVisible(-1)} aria-label="Previous frame that shows the selection" title="Previous frame of the selection ([)">«</button>
          <button type="button" disabled={!visibleFrames.value.length} onClick={() => stepVisible(1)} aria-label="Next frame that shows the selection" title="Next frame of the selection (])">»</button>
        </div>
        <button type="button" onClick={stepBoxes} title="Boxes and masks (X)" aria-label={`Boxes and masks: ${boxes.value}; change`}>Boxes: {boxes.value}</button>
        <label class="slide">Overlay <input type="range" min="0" max="1" step="0.05" value={overlay.value} disabled={!one?.registered || !surface} aria-label="How opaque the surface lies over the frame" onInput={(event) => (overlay.value = Number(event.currentTarget.value))} /></label>
        <div class="choice" role="group" aria-label="Size of the picture">
          <button type="button" onClick={() => (zoom.value = Math.max(0.5, zoom.value / 1.5))} aria-label="Smaller picture">−</button>
          <button type="button" onClick={() => (zoom.value = Math.min(8, zoom.value * 1.5))} aria-label="Larger picture">+</button>
        </div>
      </div>
      <div class={zoom.value > 1 ? "pane large" : "pane"} ref={pane} tabIndex={0} role="group" aria-label="Picture of the frame">
        <div class="picture" style={{ width: `${width}px`, height: `${(width * size.height) / size.width}px` }} onClick={clickPicture} onPointerDown={press} onPointerMove={drag} onPointerUp={release}>
          {one?.picture ? (
            <img src={one.picture} alt={alternative()} draggable={false} />
          ) : (
            <div class="why">{one && data.sprite ? <Tile frame={one} width={Math.min(fitted.value * 0.5, 320)} /> : null}<p>{data.pictures_reason ?? "No picture of this frame was kept."}</p></div>
          )}
          <canvas ref={canvas} class="over" style={{ opacity: String(one?.registered ? overlay.value : 0) }} aria-hidden="true" />
          <Drawn width={width} />
        </div>
      </div>
      <Said />
      <Ranked />
    </section>
  );
}

function alternative(): string {
  const one = frame.value;
  if (!one) return "";
  const labels = (detectionsOfFrame.get(one.index) ?? []).map((own) => own.label);
  return `Frame ${one.source_index} at ${seconds(one.time_s)}: ${labels.length ? labels.join(", ") : "no detection"}`;
}

/** Scrolls to what is selected when the picture is larger than the pane. */
function centre(pane: HTMLElement | null): void {
  const [x0, y0, x1, y1] = questions.crop;
  const at = (zoom.peek() > 1 && selectedPixel()) || ([(x0 + x1) / 2, (y0 + y1) / 2] as const);
  if (!pane) return;
  const scale = (fitted.peek() * zoom.peek()) / size.width;
  pane.scrollTo(at[0] * scale - pane.clientWidth / 2, at[1] * scale - pane.clientHeight / 2);
}

function selectedPixel(): readonly [number, number] | null {
  const { f, p } = place.peek();
  if (f === null) return null;
  const own = (detectionsOfFrame.get(f) ?? []).find((one) => (detection.peek() ? one.id === detection.peek()?.id : one.defect === finding.peek()?.id));
  if (own) return [(own.box[0] + own.box[2]) / 2, (own.box[1] + own.box[3]) / 2];
  const at = p ?? finding.peek()?.centroid;
  return at ? questions.pixelOf(f, at) : null;
}

/** Pixel of the source picture under the pointer. */
function pixelAt(event: MouseEvent): readonly [number, number] {
  const box = (event.currentTarget as HTMLElement).getBoundingClientRect();
  return [((event.clientX - box.left) / box.width) * size.width, ((event.clientY - box.top) / box.height) * size.height];
}

let held: readonly [number, number] | null = null;
/** The click that follows a drawing asks nothing. */
let drew = false;

function press(event: PointerEvent): void {
  if (!drawing.peek() || event.button) return;
  event.preventDefault();
  (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId);
  held = pixelAt(event);
}

function drag(event: PointerEvent): void {
  const now = drawing.peek();
  if (!now || !held) return;
  const [x, y] = pixelAt(event);
  const box = now.what === "move" ? ([x - 6, y - 6, x + 6, y + 6] as const) : ([Math.min(x, held[0]), Math.min(y, held[1]), Math.max(x, held[0]), Math.max(y, held[1])] as const);
  if (box[2] - box[0] > 2 && box[3] - box[1] > 2) drawing.value = { ...now, box };
}

function release(event: PointerEvent): void {
  if (!drawing.peek() || !held) return;
  drag(event);
  held = null;
  drew = true;
  endDrawing();
}

/** The box that is being drawn. */
function Pending({ unit }: { readonly unit: number }): JSX.Element | null {
  const now = drawing.value;
  if (!now) return null;
  const [x0, y0, x1, y1] = now.box;
  return <><rect class="halo" x={x0} y={y0} width={x1 - x0} height={y1 - y0} fill="none" stroke="#000" stroke-width={4 * unit} /><rect class="pending" x={x0} y={y0} width={x1 - x0} height={y1 - y0} stroke-width={2 * unit} /></>;
}

function clickPicture(event: MouseEvent): void {
  if (!drawing.peek() && !drew) askPixel(...pixelAt(event));
  drew = false;
}

/** Boxes, masks, and the selected place, drawn by the page on the clean picture. */
function Drawn({ width }: { readonly width: number }): JSX.Element | null {
  const one = frame.value;
  if (!one) return null;
  const unit = size.width / Math.max(1, width);
  const chosen = finding.value?.id;
  const { p } = place.value;
  const at = p ?? (finding.value ? finding.value.centroid : null);
  const pixel = at && one.registered ? questions.pixelOf(one.index, at) : null;
  const click = asked.value?.frame === one.index ? asked.value : null;
  return (
    <svg class="drawn" viewBox={`0 0 ${size.width} ${size.height}`} aria-hidden="true">
      {boxes.value !== "off" && (detectionsOfFrame.get(one.index) ?? []).map((own) => {
        const mark = marks.get(own.label);
        const [x0, y0, x1, y1] = own.box;
        const atRight = x0 > 0.7 * size.width;
        const strong = own.defect !== null && own.defect === chosen || own.id === detection.value?.id;
        const style = { stroke: mark?.css ?? "gray", fill: boxes.value === "filled" ? (mark?.css ?? "gray") : "none" };
        const dash = own.state === "mapped" ? "none" : `${5 * unit} ${4 * unit}`;
        const shape = (extra: object, name: string): JSX.Element => own.polygon
          ? <polygon class={name} points={own.polygon.map((corner) => corner.join(",")).join(" ")} {...extra} />
          : <rect class={name} x={x0} y={y0} width={x1 - x0} height={y1 - y0} {...extra} />;
        return (
          <g key={own.id}>
            {shape({ fill: "none", stroke: "#000", "stroke-opacity": 0.6, "stroke-width": (strong ? 5 : 3.4) * unit }, "halo")}
            {shape({ ...style, "fill-opacity": 0.3, "stroke-width": (strong ? 3 : 1.6) * unit, "stroke-dasharray": dash }, strong ? "box strong" : "box")}
            <text x={atRight ? x1 : x0} text-anchor={atRight ? "end" : "start"} y={Math.max(14 * unit, y0 - 5 * unit)} font-size={12.5 * unit} stroke-width={3 * unit} class="name">{own.defect !== null ? `${findingName(own.defect)} ` : ""}{own.label}</text>
          </g>
        );
      })}
      {boxes.value !== "off" && allFindings.value.map((own) => own.drawn?.frame === one.index && (
        <g key={own.id}>
          <rect class="halo" x={own.drawn.box[0] * size.width} y={own.drawn.box[1] * size.height} width={(own.drawn.box[2] - own.drawn.box[0]) * size.width} height={(own.drawn.box[3] - own.drawn.box[1]) * size.height} fill="none" stroke="#000" stroke-opacity={0.6} stroke-width={4 * unit} />
          <rect class="by-hand" x={own.drawn.box[0] * size.width} y={own.drawn.box[1] * size.height} width={(own.drawn.box[2] - own.drawn.box[0]) * size.width} height={(own.drawn.box[3] - own.drawn.box[1]) * size.height} stroke-width={2 * unit} />
          <text x={own.drawn.box[0] * size.width} y={own.drawn.box[3] * size.height + 14 * unit} font-size={12.5 * unit} stroke-width={3 * unit} class="name">{findingName(own.id)} {own.label}</text>
        </g>
      ))}
      <Pending unit={unit} />
      {pixel && <path class="spot" d={cross(pixel[0], pixel[1], 9 * unit)} stroke-width={1.6 * unit} />}
      {click && click.shown.reason !== null && <path class="spot miss" d={`M${click.x - 7 * unit} ${click.y - 7 * unit}l${14 * unit} ${14 * unit}m0 ${-14 * unit}l${-14 * unit} ${14 * unit}`} stroke-width={2 * unit} />}
      <rect class="used" x={questions.crop[0]} y={questions.crop[1]} width={questions.crop[2] - questions.crop[0]} height={questions.crop[3] - questions.crop[1]} stroke-width={unit} stroke-dasharray={`${2 * unit} ${5 * unit}`} />
    </svg>
  );
}

function cross(x: number, y: number, r: number): string {
  return `M${x - r} ${y}H${x - r / 3}M${x + r / 3} ${y}H${x + r}M${x} ${y - r}V${y - r / 3}M${x} ${y + r / 3}V${y + r}`;
}

/** What the last click found, or why the frame shows nothing on the surface. */
function Said(): JSX.Element {
  const one = frame.value;
  const click = asked.value;
  let text = "";
  if (one && !one.registered) text = `Not registered: ${reasonText(data, one.reason ?? "not_registered")}. The surface cannot be laid over it.`;
  else if (surfaceReason) text = surfaceReason;
  else if (click?.shown.reason === null) {
    const { distance, incidence_deg, finding: on, support } = click.shown;
    const unit = data.model.unit === "model" ? "" : ` ${data.model.unit}`;
    text = `${on >= 0 ? `Finding ${findingName(on)}` : "The surface"}: ${measured(distance, null, data.model.unit)}${unit ? "" : " model units"} from the camera, seen at ${Math.round(incidence_deg)}° from straight on, ${support >= 0.5 ? "well observed" : "weakly observed"}.`;
  } else if (click) text = `Nothing there: ${reasonText(data, click.shown.reason)}.`;
  else text = "Click the picture: its place on the surface is shown. Click the surface: the frames that see it are ranked here.";
  return <p class="said" role="status">{text}</p>;
}

/** Frames that see what is selected, best first. */
function Ranked(): JSX.Element | null {
  const list = visibleFrames.value;
  if (!list.length) return null;
  const subject = place.value.p ? "this point" : findingName(finding.value?.id ?? 0);
  const detected = new Set(finding.value?.detections.map((id) => detections.get(id)?.frame) ?? []);
  return (
    <div class="ranked" role="group" aria-label={`Frames that see ${subject}, best first`}>
      <span class="lead">{list.length} {list.length === 1 ? "frame sees" : "frames see"} {subject}</span>
      <ol>
        {list.slice(0, 60).map((one) => {
          const own = frames.get(one.frame);
          return own ? (
            <li key={one.frame}>
              <button type="button" aria-current={place.value.f === one.frame} onClick={() => selectFrame(one.frame)} aria-label={`Frame ${own.source_index}, view quality ${percent(one.quality)}${detected.has(one.frame) ? ", detected there" : ""}`}>
                <Tile frame={own} width={44} />
                <small>{own.source_index}{detected.has(one.frame) ? " ■" : ""}</small>
              </button>
            </li>
          ) : null;
        })}
      </ol>
    </div>
  );
}
