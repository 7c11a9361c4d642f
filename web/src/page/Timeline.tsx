/** The timeline: registration, detections, visits to findings, and the playhead, drawn as one SVG. */

import { signal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Finding } from "../model/data";
import { findingName, reasonText, seconds } from "../model/words";
import { data, detections, detectionsOfFrame, frames, marks, order, position, videoStart, visitsOfFinding } from "../session";
import { finding, frame, play, playing, selectDetection, selectFinding, selectFrame, shownFindings, stepFrame } from "../state";

const width = signal(800);
const LEFT = 124;
const ROW = 18;
const TOP = 46;
/** Pixels that the words of a time take. */
const SCALE_WIDTH = 36;
const end = Math.max(videoStart[videoStart.length - 1] ?? 0, 0.001);
const x = (video: number, time_s: number): number => LEFT + (((videoStart[video] ?? 0) + time_s) / end) * (width.value - LEFT - 12);

/** Gap to the next frame, so that a band has no holes between frames. */
const lasting = order.map((one, k) => {
  const next = order[k + 1];
  return next && next.video === one.video ? next.time_s - one.time_s : (end - (videoStart[one.video] ?? 0) - one.time_s || 0.05);
});

export function Timeline(): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = box.current;
    if (!element) return undefined;
    const fit = (): void => void (width.value = Math.max(240, element.clientWidth));
    const observer = new ResizeObserver(fit);
    observer.observe(element);
    fit();
    return () => observer.disconnect();
  }, []);
  useEffect(() => {
    const row = shownFindings.peek().findIndex((one) => one.id === finding.peek()?.id);
    const element = box.current;
    if (!element || row < 0) return;
    const top = TOP + ROW * row;
    if (top < element.scrollTop || top + ROW > element.scrollTop + element.clientHeight) element.scrollTop = top - element.clientHeight / 2;
  }, [finding.value]);
  const at = frame.value;
  const height = TOP + ROW * Math.max(1, shownFindings.value.length) + 6;
  return (
    <section class="panel timeline" aria-label="Timeline">
      <div class="bar">
        <h2>Timeline</h2>
        <button type="button" aria-pressed={playing.value} onClick={() => play()} title="Play (P)">{playing.value ? "Stop" : "Play"}</button>
        <span class="time">{at ? `${seconds(at.time_s)}, frame ${at.source_index}` : "no frame"}</span>
        <span class="key"><i class="swatch registered" /> registered <i class="swatch lost" /> not registered <i class="swatch detected" /> detection <i class="swatch visit" /> visit to a finding</span>
      </div>
      <div class="tracks" ref={box} tabIndex={0} role="slider" aria-label="Playhead" aria-orientation="horizontal" aria-valuemin={0} aria-valuemax={Math.max(0, order.length - 1)} aria-valuenow={at ? (position.get(at.index) ?? 0) : 0} aria-valuetext={at ? `Frame ${at.source_index}, ${seconds(at.time_s)}` : "no frame"} onKeyDown={keys} onPointerDown={seek} onPointerMove={(event) => event.buttons === 1 && seek(event)}>
        <svg width={width.value} height={height} aria-hidden="true">
          <Bands height={height} wide={width.value} />
          <Tracks chosen={finding.value?.id ?? null} rows={shownFindings.value} wide={width.value} />
          {at && <path class="playhead under" d={`M${x(at.video, at.time_s)} 4V${height}`} />}
          {at && <path class="playhead" d={`M${x(at.video, at.time_s)} 4V${height}M${x(at.video, at.time_s) - 5} 2h10l-5 8z`} />}
        </svg>
      </div>
    </section>
  );
}

/** Whether a part has to be drawn again; it costs too much to do so with every frame that is played. */
function differs<Props extends object>(made: (props: Props) => JSX.Element): (props: Props) => JSX.Element {
  let last: { readonly props: Props; readonly drawn: JSX.Element } | null = null;
  return (props) => {
    const names = Object.keys(props) as (keyof Props)[];
    if (!last || names.some((name) => last?.props[name] !== props[name])) last = { props, drawn: made(props) };
    return last.drawn;
  };
}

/** Cameras and detections of the frames. */
const Bands = differs(({ height }: { readonly height: number; readonly wide: number }) => (
  <g>
    <defs><pattern id="lost" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)"><rect width="6" height="6" fill="#fff" /><rect width="3" height="6" fill="#d98c1f" /></pattern></defs>
    <Ticks height={height} />
    <text class="lane" x="4" y="27">cameras</text>
    <text class="lane" x="4" y="41">detections</text>
    {order.map((one, k) => (
      <rect key={one.index} class={one.registered ? "registered" : "lost"} x={x(one.video, one.time_s)} y="18" width={Math.max(1, x(one.video, one.time_s + (lasting[k] ?? 0)) - x(one.video, one.time_s))} height="11">
        {!one.registered && <title>{`Frame ${one.source_index}: ${reasonText(data, one.reason ?? "not_registered")}`}</title>}
      </rect>
    ))}
    {order.map((one) => {
      const own = detectionsOfFrame.get(one.index) ?? [];
      if (!own.length) return null;
      const all = own.every((each) => each.state === "mapped");
      return <rect key={`n${one.index}`} class={all ? "detected" : "detected some"} x={x(one.video, one.time_s) - 1} y="33" width="2.4" height="8"><title>{`${own.length} detections in frame ${one.source_index}${all ? "" : ", some without a place"}`}</title></rect>;
    })}
  </g>
));

/** Visits and detections of every finding. */
const Tracks = differs(({ chosen, rows, wide }: { readonly chosen: number | null; readonly rows: readonly Finding[]; readonly wide: number }) => (
  <g>
    {rows.map((one, k) => {
      const y = TOP + ROW * k;
      const mark = marks.get(one.label);
      return (
        <g key={`d${one.id}`} class={chosen === one.id ? "track chosen" : "track"}>
          {chosen === one.id && <rect class="ground" x="0" y={y} width={wide} height={ROW} />}
          <path class="mark" transform={`translate(11 ${y + ROW / 2}) scale(5)`} d={mark?.shape ?? ""} fill={mark?.css ?? "gray"} />
          <text class="lane" x="21" y={y + 13} data-finding={one.id}>{short(`${findingName(one.id)} ${one.label}`)}</text>
          {(visitsOfFinding.get(one.id) ?? []).map((visit) => {
            const from = x(visit.video ?? 0, visit.start_s);
            return (
              <rect key={visit.event_id} class="visit" data-finding={one.id} data-time={visit.start_s} x={from - 2} y={y + 3} width={Math.max(5, x(visit.video ?? 0, visit.end_s) - from + 4)} height={ROW - 6} rx="3" style={{ fill: mark?.css ?? "gray" }}>
                <title>{`${findingName(one.id)} from ${seconds(visit.start_s)} to ${seconds(visit.end_s)}: ${visit.n_detections} detections`}</title>
              </rect>
            );
          })}
          {one.detections.map((id) => {
            const shot = frames.get(detections.get(id)?.frame ?? -1);
            return shot ? <rect key={id} class="tick" x={x(shot.video, shot.time_s) - 0.6} y={y + 5} width="1.2" height={ROW - 10} /> : null;
          })}
        </g>
      );
    })}
    {!rows.length && <text class="lane" x={LEFT} y={TOP + 13}>No finding has a visit here.</text>}
  </g>
));

function Ticks({ height }: { readonly height: number }): JSX.Element {
  const step = [0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1800].find((one) => end / one <= Math.max(4, width.value / 90)) ?? 3600;
  const marksAt: JSX.Element[] = [];
  for (let video = 0; video < videoStart.length - 1; video++) {
    const own = (videoStart[video + 1] ?? end) - (videoStart[video] ?? 0);
    if (video) marksAt.push(<path key={`v${video}`} class="border" d={`M${x(video, 0)} 0V${height}`} />);
    for (let time = 0; time <= own + 1e-6; time += step) {
      const left = x(video, time);
      const late = left > width.value - SCALE_WIDTH;
      marksAt.push(<g key={`${video}-${time}`}><path class="grid" d={`M${left} 14V${height}`} /><text class="scale" x={late ? left - 2 : left + 2} y="12" text-anchor={late ? "end" : "start"}>{data.videos.length > 1 && time === 0 ? `video ${video}` : `${Number(time.toFixed(1))} s`}</text></g>);
    }
  }
  return <>{marksAt}</>;
}

function detectedIn(id: number): ReadonlySet<number> | null {
  const within = order.filter((one) => detectionsOfFrame.get(one.index)?.some((each) => each.defect === id));
  return within.length ? new Set(within.map((one) => one.index)) : null;
}

/** A name that fits beside the tracks. */
function short(name: string): string {
  return name.length > 14 ? `${name.slice(0, 13)}…` : name;
}

function keys(event: KeyboardEvent): void {
  const act: Record<string, () => void> = {
    ArrowLeft: () => stepFrame(-1),
    ArrowDown: () => stepFrame(-1),
    ArrowRight: () => stepFrame(1),
    ArrowUp: () => stepFrame(1),
    PageDown: () => stepFrame(-10),
    PageUp: () => stepFrame(10),
    Home: () => selectFrame(order[0]?.index ?? null),
    End: () => selectFrame(order[order.length - 1]?.index ?? null),
  };
  const own = act[event.key];
  if (!own || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  event.stopPropagation();
  own();
}

/** The frame nearest to a place of the timeline; a visit or a name there also selects its finding. */
function seek(event: PointerEvent): void {
  const box = (event.currentTarget as HTMLElement).getBoundingClientRect();
  const left = event.clientX - box.left;
  const target = event.target as Element;
  const named = event.type === "pointerdown" ? target.getAttribute("data-finding") : null;
  let best: number | null = null;
  let least = Infinity;
  // On a visit the nearest frame that was detected in, since that shows the finding.
  const own = named !== null && target.hasAttribute("data-time") ? detectedIn(Number(named)) : null;
  for (const one of order) {
    if (own && !own.has(one.index)) continue;
    const away = Math.abs(x(one.video, one.time_s) - left);
    if (away < least) [best, least] = [one.index, away];
  }
  if (named !== null) {
    const visit = target.hasAttribute("data-time");
    selectFinding(Number(named), visit && best !== null ? { frame: best } : {});
    return;
  }
  if (left < LEFT - 8 || best === null) return;
  if (event.type === "pointerdown" && event.offsetY > 30 && event.offsetY < 43) {
    const own = detectionsOfFrame.get(best)?.[0];
    if (own) return selectDetection(own.id);
  }
  selectFrame(best, true);
}
