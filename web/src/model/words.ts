/** Numbers and codes as a reader wants them. */

import type { Finding, ViewerData } from "./data";

/** Name of a finding: of the method's by its number, of those that people made, whose numbers are below zero, in their order. */
export const findingName = (id: number): string => (id < 0 ? `H${-id}` : `D${id}`);

export function seconds(value: number): string {
  return `${value.toFixed(2)} s`;
}

export type Units = "mm" | "in";
const MM_PER_INCH = 25.4;

/** A value with its uncertainty, rounded so that the uncertainty keeps two digits; millimetres in inches where these are wanted. */
export function measured(value: number | null | undefined, sigma: number | null | undefined, unit: string, wanted: Units = "mm"): string {
  if (value === null || value === undefined) return "unknown";
  if (wanted === "in" && (unit === "mm" || unit === "mm²")) {
    const factor = unit === "mm" ? MM_PER_INCH : MM_PER_INCH ** 2;
    return measured(value / factor, sigma === null || sigma === undefined ? sigma : sigma / factor, unit.replace("mm", "in"));
  }
  const own = unit === "model" ? "" : ` ${unit}`;
  if (!sigma) return `${digits(value, 3)}${own}`;
  const places = Math.max(0, 1 - Math.floor(Math.log10(sigma)));
  return `${value.toFixed(Math.min(places, 9))} ± ${sigma.toFixed(Math.min(places, 9))}${own}`;
}

/** A length between places of the surface, which are in units of the model, in those that the scale gives; and its uncertainty. */
export function scaled(length: number, sigma: number, model: ViewerData["model"]): { readonly value: number; readonly sigma: number; readonly unit: string } {
  if (model.unit === "model" || !model.scale) return { value: length, sigma, unit: "model" };
  return { value: model.scale * length, sigma: Math.hypot(model.scale * sigma, (model.scale_sigma ?? 0) * length), unit: model.unit };
}

function digits(value: number, count: number): string {
  return String(Number(value.toPrecision(count)));
}

export function percent(share: number): string {
  return `${Math.round(100 * share)} %`;
}

/** Rank of a confidence in a word, so that colour is never the only sign of it. */
export function certainty(value: number): "high" | "medium" | "low" {
  return value >= 0.75 ? "high" : value >= 0.4 ? "medium" : "low";
}

/** What a confidence is made of, in sentences; the largest doubts first. */
export function confidenceReasons(finding: Finding): string[] {
  const parts = finding.confidence?.parts ?? {};
  const at = (name: string): number | null => parts[name] ?? null;
  const said: [number, string][] = [];
  const [visible, support, same] = [at("views_visible"), at("views_support"), at("views_same_label")];
  if (visible !== null && support !== null) {
    const share = visible > 0 ? support / visible : 0;
    const text = visible > 0 ? `${round(support)} of ${round(visible)} other views of the place show a box there` : "no other view could see the place";
    said.push([visible > 0 ? share : 0, `${text}.`]);
    if (support > 0 && same !== null) said.push([same / support, `${round(same)} of these ${round(support)} give it the same label.`]);
  }
  const peers = at("peers");
  if (peers !== null) said.push([peers > 0 ? 0.9 : 0.2, peers > 0 ? `${round(peers)} further observations lie at the same place.` : "It was observed once only."]);
  const cosine = at("cosine");
  if (cosine !== null) said.push([cosine, `It is seen at ${Math.round((Math.acos(Math.min(1, cosine)) * 180) / Math.PI)}° from straight on.`]);
  const depth = at("depth_agreement");
  if (depth !== null) said.push([depth, `${percent(depth)} of the depth map under the box agree with the surface.`]);
  const cloud = at("cloud_spacings");
  if (cloud !== null && cloud > 2) said.push([0.1, `The surface there is ${cloud.toFixed(1)} point spacings away from measured points.`]);
  const doubts = at("model_doubts");
  if (doubts) said.push([0, `The checks raise ${doubts === 1 ? "a warning" : `${round(doubts)} warnings`} about the whole model.`]);
  return said.sort((a, b) => a[0] - b[0]).map(([, text]) => text);
}

function round(value: number): string {
  return String(Math.round(value * 10) / 10);
}

/** Words for a code of `reasons`; the code itself with blanks where there are none. */
export function reasonText(data: ViewerData, code: string | null | undefined): string {
  if (!code) return "";
  return data.reasons?.[code] ?? OWN_REASONS[code] ?? code.replaceAll("_", " ");
}

const OWN_REASONS: Readonly<Record<string, string>> = {
  frame_not_registered: "the camera of this frame could not be found",
  not_registered: "the camera of this frame could not be found",
  outside_roi: "this pixel lies outside the part of the picture that was used",
  off_surface: "the reconstructed surface does not reach here",
  occluded: "the surface is seen from behind here: it lies in another blade's shadow or is no real front",
  no_surface: "the result has no surface",
};

/** Blade as a reader names it: unknown is said, not left out. */
export function bladeText(blade: string | number | null | undefined): string {
  return blade === null || blade === undefined || blade === "" || blade === 0 ? "unknown" : String(blade);
}
