/** What is known of the selected finding or detection, and the human's word on it. */

import type { ComponentChildren, JSX } from "preact";
import type { Detection, Finding } from "../model/data";
import { bladeText, certainty, confidenceReasons, findingName, measured, percent, reasonText, seconds } from "../model/words";
import { data, frames, seenBlades, surface, visitsOfFinding } from "../session";
import { reviewOf } from "../review";
import { Ask, Exports, ReviewBar, Said } from "./Reviewing";
import { blade, detection, finding, go, place, playVisit, selectFrame, units } from "../state";
import { LabelMark } from "./marks";

export function Detail(): JSX.Element {
  const [one, own] = [finding.value, detection.value];
  return (
    <section class="panel detail" aria-label="Selection">
      {one ? <OfFinding one={one} /> : own ? <OfDetection own={own} /> : <Coverage />}
      <Ask />
      <Exports />
    </section>
  );
}

/** With nothing selected: of each blade what was not seen, since a place without a finding may just not have been looked at. */
function Coverage(): JSX.Element {
  return (
    <>
      <p class="note">Nothing is selected. Choose a finding, click the surface, or click a box of the frame.</p>
      {seenBlades.length > 0 && (
        <div class="coverage">
          <h3>Not seen by two views</h3>
          <ul class="reasons">{seenBlades.map(({ name, seen }) => <li key={name}>{percent(1 - seen)} of blade {name}</li>)}</ul>
          <p class="note">Of the reconstructed surface, at a usable angle. What no view saw has no surface and is not counted.</p>
        </div>
      )}
    </>
  );
}

function OfFinding({ one }: { readonly one: Finding }): JSX.Element {
  const review = reviewOf(one.id);
  const unit = one.length_unit ?? one.size_unit ?? data.model.unit;
  const visits = visitsOfFinding.get(one.id) ?? [];
  const own = seenBlades.find(({ name }) => name === String(one.blade))?.number;
  return (
    <>
      <h2><LabelMark label={one.label} /> {findingName(one.id)} <bdi>{one.label}</bdi>{review.label && <span class="human"> → <bdi>{review.label}</bdi></span>}</h2>
      <ReviewBar one={one} />
      <Said review={review} />
      <dl>
        <Fact name="Size">{measured(one.size, one.size_sigma, unit, units.value)} <Unscaled unit={unit} /></Fact>
        {one.length !== undefined && <Fact name="Length × width">{measured(one.length, one.length_sigma, unit, units.value)} × {measured(one.width, one.width_sigma, unit, units.value)}</Fact>}
        {one.area !== undefined && one.area !== null && <Fact name="Area">{measured(one.area, one.area_sigma, unit === "model" ? "model" : `${unit}²`, units.value)}</Fact>}
        {one.depth !== undefined && one.depth !== null && <Fact name="Depth">{measured(one.depth, one.depth_sigma, unit, units.value)}</Fact>}
        <Fact name="Blade">
          {bladeText(one.blade)}{one.side ? `, ${one.side.replaceAll("_", " ")}` : ""}
          {own !== undefined && surface?.mesh.blade.some((each) => each === own) && (
            <button type="button" class="link" onClick={() => go({ b: blade.value === null ? own : null }, true)}>{blade.value === null ? "show it alone" : "show all"}</button>
          )}
        </Fact>
        {one.span !== undefined && <Fact name="Span, chord">{share(one.span, one.span_sigma)}, {share(one.chord, one.chord_sigma)}</Fact>}
        {one.root_distance !== undefined && one.root_distance !== null && <Fact name="From the root">{measured(one.root_distance, one.root_distance_sigma, unit, units.value)}</Fact>}
        {one.edge_distance !== undefined && one.edge_distance !== null && <Fact name="From an edge">{measured(one.edge_distance, one.edge_distance_sigma, unit, units.value)}</Fact>}
        {one.limits && <Fact name="Limits of the shop"><b>{one.limits.verdict.replaceAll("_", " ")}</b>: {one.limits.reason}. What it means for the part a person says.</Fact>}
        <Fact name="Persistence">detected in {one.persistence.k} of the {one.persistence.n} frames that could show it</Fact>
        <Fact name="Place">{one.centroid.every(Number.isFinite) ? one.centroid.map((value) => value.toFixed(3)).join(", ") : "none on the surface"}{one.centroid_sigma ? ` ± ${one.centroid_sigma.toPrecision(2)}` : ""}</Fact>
      </dl>
      <h3>Visits</h3>
      <ul class="chips">
        {visits.map((visit) => (
          <li key={visit.event_id}><button type="button" onClick={() => playVisit(visit.start_s, visit.end_s, visit.video ?? 0)} aria-label={`Play the visit from ${seconds(visit.start_s)} to ${seconds(visit.end_s)}`}>▶ {data.videos.length > 1 ? `video ${visit.video ?? 0}, ` : ""}{seconds(visit.start_s)} to {seconds(visit.end_s)} · {visit.n_detections}</button></li>
        ))}
      </ul>
      <h3>Best frames</h3>
      <ul class="chips">
        {one.best_frames.map((index, k) => (
          <li key={index}><button type="button" aria-current={place.value.f === index} onClick={() => selectFrame(index)}>{k === 0 ? "best: " : ""}frame {frames.get(index)?.source_index ?? index}</button></li>
        ))}
      </ul>
      <h3>Confidence {one.confidence ? `${percent(one.confidence.value)}, ${certainty(one.confidence.value)}` : "unknown"}</h3>
      <ul class="reasons">{confidenceReasons(one).map((text) => <li key={text}>{text}</li>)}</ul>
    </>
  );
}

function OfDetection({ own }: { readonly own: Detection }): JSX.Element {
  return (
    <>
      <h2><LabelMark label={own.label} /> Detection {own.id} <bdi>{own.label}</bdi></h2>
      <dl>
        <Fact name="State">{own.state}</Fact>
        {own.reason && <Fact name="Why">{reasonText(data, own.reason)}</Fact>}
        {own.score !== null && own.score !== undefined && <Fact name="Detector's score">{own.score.toFixed(2)}</Fact>}
        {own.confidence !== null && <Fact name="Confidence">{percent(own.confidence)}</Fact>}
        {own.frame === null && <Fact name="Frame">no frame of the run shows it</Fact>}
      </dl>
    </>
  );
}

function Fact({ name, children }: { readonly name: string; readonly children: ComponentChildren }): JSX.Element {
  return <div><dt>{name}</dt><dd>{children}</dd></div>;
}

function Unscaled({ unit }: { readonly unit: string }): JSX.Element | null {
  return unit === "model" ? <small>model units, unscaled</small> : null;
}

function share(value: number | null | undefined, sigma: number | null | undefined): string {
  return value === null || value === undefined ? "unknown" : `${percent(value)}${sigma ? ` ± ${Math.max(1, Math.round(100 * sigma))}` : ""}`;
}

