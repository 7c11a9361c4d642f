/** What `viewer.json` holds; the stage `viewer` writes it. */

export type Vec3 = readonly [number, number, number];
export type Box = readonly [number, number, number, number];

export interface Frame {
  /** Row of frames.csv. */
  readonly index: number;
  readonly video: number;
  readonly source_index: number;
  readonly time_s: number;
  readonly name: string;
  readonly registered: boolean;
  /** Of a frame that is not registered. */
  readonly reason?: string | null;
  /** Row-major 3x4, COLMAP's. */
  readonly cam_from_world: readonly number[] | null;
  readonly picture: string | null;
  readonly picture_scale: number | null;
  readonly tile: number | null;
}

export interface Detection {
  readonly id: number;
  readonly frame: number | null;
  readonly label: string;
  readonly score?: number | null;
  /** Pixels of the source picture. */
  readonly box: Box;
  readonly polygon: readonly (readonly [number, number])[] | null;
  readonly state: string;
  readonly reason: string | null;
  readonly method: string | null;
  readonly confidence: number | null;
  readonly point: Vec3 | null;
  readonly sigma: number | null;
  readonly defect: number | null;
  readonly time_s?: number;
  readonly video?: number;
  readonly model?: number | null;
}

export interface Sighting {
  readonly frame_index: number;
  readonly quality: number;
  readonly detected: boolean;
}

export interface Finding {
  readonly id: number;
  readonly label: string;
  readonly model: number;
  readonly centroid: Vec3;
  readonly centroid_sigma?: number | null;
  readonly normal?: Vec3 | null;
  readonly confidence: { readonly value: number; readonly parts: Readonly<Record<string, number | null>> } | null;
  readonly persistence: { readonly k: number; readonly n: number; readonly share: number };
  readonly events: readonly number[];
  readonly detections: readonly number[];
  readonly frames: readonly Sighting[];
  readonly node: string | null;
  readonly best_frames: readonly number[];
  /** In shares of the source picture. */
  readonly best?: { readonly frame: number; readonly x: number | null; readonly y: number | null } | null;
  readonly size: number | null;
  readonly size_sigma: number | null;
  readonly size_unit?: string;
  readonly blade?: string | number | null;
  readonly side?: string | null;
  readonly span?: number | null;
  readonly span_sigma?: number | null;
  readonly chord?: number | null;
  readonly chord_sigma?: number | null;
  readonly length?: number | null;
  readonly length_sigma?: number | null;
  readonly width?: number | null;
  readonly width_sigma?: number | null;
  readonly area?: number | null;
  readonly area_sigma?: number | null;
  readonly depth?: number | null;
  readonly depth_sigma?: number | null;
  readonly edge_distance?: number | null;
  readonly edge_distance_sigma?: number | null;
  readonly root_distance?: number | null;
  readonly root_distance_sigma?: number | null;
  readonly length_unit?: string | null;
  /** How it compares with the limits of the shop, where these were told. */
  readonly limits?: { readonly verdict: string; readonly reason: string };
  /** Of a finding that a person drew: where, in shares of the source picture. */
  readonly drawn?: { readonly frame: number; readonly box: Box } | null;
}

export interface Visit {
  readonly event_id: number;
  readonly defect_id: number;
  readonly label: string;
  readonly start_s: number;
  readonly end_s: number;
  readonly n_detections: number;
  readonly n_frames: number;
  readonly video?: number;
}

export interface Flag {
  readonly code: string;
  readonly severity: string;
  readonly text: string;
  readonly advice?: string | null;
  readonly where?: string;
}

export interface Video {
  readonly name: string;
  readonly width: number | null;
  readonly height: number | null;
  readonly frames: number | null;
  readonly duration_s: number | null;
}

export interface CameraData {
  readonly model: string;
  readonly width: number;
  readonly height: number;
  readonly params: readonly number[];
  readonly crop?: Box | null;
}

export interface Sprite {
  readonly file: string;
  readonly width: number;
  readonly height: number;
  readonly columns: number;
}

export interface Row {
  readonly status: string;
  readonly reason?: string | null;
  readonly [key: string]: unknown;
}

export interface ViewerData {
  readonly schema_version: number;
  readonly title: string;
  readonly model: { readonly index: number; readonly count: number; readonly unit: string; readonly scale: number | null; readonly scale_sigma?: number | null; readonly findings?: readonly [number, number] | null };
  readonly models: readonly { readonly index: number; readonly href: string }[];
  readonly videos: readonly Video[];
  readonly camera: CameraData | null;
  readonly crop?: Box | null;
  readonly frames: readonly Frame[];
  readonly sprite: Sprite | null;
  readonly detections: readonly Detection[];
  readonly defects: readonly Finding[];
  readonly events: readonly Visit[];
  readonly row: Row;
  readonly verdict: string;
  readonly state?: string;
  readonly message?: string | null;
  readonly flags: readonly Flag[];
  readonly reasons?: Readonly<Record<string, string>>;
  readonly surface: { readonly file: string; readonly faces: number; readonly published_faces: number; readonly spacing?: number } | null;
  readonly surface_reason: string | null;
  readonly pictures_reason?: string | null;
  readonly fingerprint?: string | null;
  readonly up: Vec3 | null;
}

export interface Delivered {
  readonly viewer: ViewerData;
  /** Base64 of surface.glb. */
  surface: string | null;
  /** Nothing that is done to the page is kept; in the scenes of a study. */
  readonly forgets?: boolean;
}

/** The only version of `viewer.json` that this page reads. */
export const SCHEMA_VERSION = 1;

/** Bytes of a base64 text; decoded by hand, because fetching a data address is blocked where the page opens from a folder. */
export function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  return bytes;
}
