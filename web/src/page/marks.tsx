/** Small pictures that several parts of the page share. */

import type { JSX } from "preact";
import type { Detection, Finding, Frame } from "../model/data";
import { data, detections, frames, marks, size } from "../session";
import { bestFrame } from "../state";

/** The shape and colour of a label; for the eye only, the label stands beside it. */
export function LabelMark({ label, px = 14 }: { readonly label: string; readonly px?: number }): JSX.Element {
  const mark = marks.get(label);
  return (
    <svg class="mark" width={px} height={px} viewBox="-1.3 -1.3 2.6 2.6" aria-hidden="true">
      <path d={mark?.shape ?? ""} fill={mark?.css ?? "gray"} stroke="#10151a" stroke-width=".22" />
    </svg>
  );
}

/** A frame from the sprite, or nothing where it has no tile. */
export function Tile({ frame, width = 64 }: { readonly frame: Frame | undefined; readonly width?: number }): JSX.Element | null {
  const sprite = data.sprite;
  if (!sprite || !frame || frame.tile === null) return <span class="tile none" style={{ width: `${width}px`, height: `${(width * size.height) / size.width}px` }} />;
  const scale = width / sprite.width;
  const [column, row] = [frame.tile % sprite.columns, Math.floor(frame.tile / sprite.columns)];
  return (
    <span class="tile" style={{ width: `${width}px`, height: `${sprite.height * scale}px` }}>
      <img
        src={sprite.file}
        alt=""
        style={{
          width: `${sprite.width * sprite.columns * scale}px`,
          left: `${-column * width}px`,
          top: `${-row * sprite.height * scale}px`,
        }}
      />
    </span>
  );
}

/** The part of the best picture that shows a finding. */
export function FindingThumb({ finding, width = 60 }: { readonly finding: Finding; readonly width?: number }): JSX.Element | null {
  const frame = frames.get(bestFrame(finding.id) ?? -1);
  const own = finding.detections.map((id) => detections.get(id)).find((one) => one !== undefined && one.frame === frame?.index);
  const best = finding.best && finding.best.frame === frame?.index && finding.best.x !== null && finding.best.y !== null ? finding.best : null;
  const at = best && { x: (best.x as number) * size.width, y: (best.y as number) * size.height };
  const box = own?.box ?? (at ? ([at.x - 40, at.y - 40, at.x + 40, at.y + 40] as const) : null);
  return <Thumb frame={frame} box={box} width={width} />;
}

export function DetectionThumb({ detection, width = 48 }: { readonly detection: Detection; readonly width?: number }): JSX.Element | null {
  return <Thumb frame={frames.get(detection.frame ?? -1)} box={detection.box} width={width} />;
}

function Thumb({ frame, box, width }: { readonly frame: Frame | undefined; readonly box: readonly [number, number, number, number] | null; readonly width: number }): JSX.Element | null {
  const height = width * 0.75;
  if (!frame?.picture || !box) return <Tile frame={frame} width={width} />;
  const [x0, y0, x1, y1] = box;
  const seen = Math.min(size.width, Math.max(60, 2 * (x1 - x0), 2.6 * (y1 - y0)));
  const scale = width / seen;
  const shift = (middle: number, half: number, full: number): number => Math.max(0, Math.min(full - 2 * half, middle - half));
  return (
    <span class="tile" style={{ width: `${width}px`, height: `${height}px` }}>
      <img
        src={frame.picture}
        alt=""
        loading="lazy"
        decoding="async"
        style={{
          width: `${size.width * scale}px`,
          height: `${size.height * scale}px`, // known before it loads, or a lazy picture is never near enough to load
          left: `${-scale * shift((x0 + x1) / 2, seen / 2, size.width)}px`,
          top: `${-scale * shift((y0 + y1) / 2, (seen * 0.75) / 2, size.height)}px`,
        }}
      />
    </span>
  );
}
