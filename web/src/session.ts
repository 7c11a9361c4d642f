/** The one inspection that this page shows, opened when the script starts. */

import { bytesOf, SCHEMA_VERSION, type Delivered, type Detection, type Finding, type Frame, type ViewerData, type Visit } from "./model/data";
import { readGlb } from "./model/glb";
import { makeLens } from "./model/lens";
import { marksOf } from "./model/marks";
import { bladesOf } from "./model/row";
import { Questions } from "./scene/questions";
import { Surface } from "./scene/surface";

declare global {
  interface Window {
    BLADEATLAS?: Delivered;
  }
}

const EMPTY: ViewerData = {
  schema_version: SCHEMA_VERSION,
  title: "Inspection",
  model: { index: 0, count: 0, unit: "model", scale: null },
  models: [],
  videos: [],
  camera: null,
  frames: [],
  sprite: null,
  detections: [],
  defects: [],
  events: [],
  row: { status: "unknown" },
  verdict: "unknown",
  flags: [],
  surface: null,
  surface_reason: null,
  up: null,
};

const delivered = window.BLADEATLAS;

/** Why nothing can be shown at all; null when the data is there. */
export const failure: string | null = !delivered
  ? "The file data.js is not beside this page, or it could not be read. Open index.html in the folder that the inspection wrote."
  : delivered.viewer.schema_version !== SCHEMA_VERSION
    ? `This page reads data of version ${SCHEMA_VERSION}; the data beside it has version ${String(delivered.viewer.schema_version)}.`
    : null;

/** Whether the browser keeps what is done here; not where the data says that the next person shall find nothing of it. */
export const keeps = !delivered?.forgets;

export const data: ViewerData = failure || !delivered ? EMPTY : delivered.viewer;
export const marks = marksOf([...data.defects.map((one) => one.label), ...data.detections.map((one) => one.label)]);
export const findings: ReadonlyMap<number, Finding> = new Map(data.defects.map((one) => [one.id, one]));
export const frames: ReadonlyMap<number, Frame> = new Map(data.frames.map((one) => [one.index, one]));
export const detections: ReadonlyMap<number, Detection> = new Map(data.detections.map((one) => [one.id, one]));
export const detectionsOfFrame: ReadonlyMap<number, readonly Detection[]> = grouped(data.detections, (one) => one.frame);
export const seenBlades = bladesOf(data.row);
export const visitsOfFinding: ReadonlyMap<number, readonly Visit[]> = grouped(data.events, (one) => one.defect_id);

/** Frames by video and time. */
export const order: readonly Frame[] = [...data.frames].sort((a, b) => a.video - b.video || a.time_s - b.time_s);
export const position: ReadonlyMap<number, number> = new Map(order.map((frame, k) => [frame.index, k]));

let failed: string | null = null;
export const surface: Surface | null = openSurface();
/** Why there is no surface, in words; null when there is one. */
export const surfaceReason: string | null = surface ? null : (failed ?? data.surface_reason ?? "The result has no surface.");

export const size = {
  width: data.camera?.width ?? data.videos[0]?.width ?? 960,
  height: data.camera?.height ?? data.videos[0]?.height ?? 720,
};
export const questions = new Questions(
  data.camera && makeLens(data.camera.model, data.camera.params),
  data.camera?.crop ?? data.crop ?? [0, 0, size.width, size.height],
  data.frames,
  surface,
  data.surface?.spacing ?? 0,
);

/** Times go on from video to video on the axis of the timeline. */
export const videoStart: readonly number[] = starts();

function openSurface(): Surface | null {
  if (!delivered?.surface || failure) return null;
  try {
    const colors = new Map(data.defects.map((one) => [one.id, marks.get(one.label)?.index ?? 0]));
    const made = new Surface(readGlb(bytesOf(delivered.surface)), colors);
    delivered.surface = null; // the text is as large as the mesh
    return made;
  } catch (error) {
    failed = `The surface could not be read: ${error instanceof Error ? error.message : String(error)}.`;
    return null;
  }
}

function starts(): number[] {
  const from = [0];
  const count = Math.max(data.videos.length, 1 + Math.max(0, ...data.frames.map((one) => one.video)));
  for (let video = 0; video < count; video++) {
    const last = Math.max(0, ...data.frames.filter((one) => one.video === video).map((one) => one.time_s));
    from.push((from[video] as number) + Math.max(data.videos[video]?.duration_s ?? 0, last));
  }
  return from;
}

function grouped<Row>(rows: readonly Row[], key: (row: Row) => number | null): Map<number, Row[]> {
  const groups = new Map<number, Row[]>();
  for (const row of rows) {
    const at = key(row);
    if (at === null) continue;
    const group = groups.get(at);
    if (group) group.push(row);
    else groups.set(at, [row]);
  }
  return groups;
}
