/** Labels and lines over the 3D canvas, put where the view says; plain DOM, because it happens with every picture. */

import type { Vec3 } from "../model/data";
import { findingName } from "../model/words";
import { visibleRow } from "../model/row";
import type { View3D } from "../scene/view3d";
import { data, marks } from "../session";
import { allFindings, finding, measured, place, selectFinding } from "../state";

const buttons = new Map<number, HTMLButtonElement>();
const SVG = "http://www.w3.org/2000/svg";
/** Radius of the compass, length of its arrows, and half of what a letter on it takes, in pixels. */
const [DIAL, ARROW, LETTER] = [46, 14, 3.4];

/** @param hide whether to find out what the surface hides: rays are cast only when the view rests */
export function drawMarks(view: View3D, labels: HTMLDivElement, lines: SVGSVGElement, hide: boolean): void {
  for (const one of allFindings.peek()) {
    if (!one.centroid.every(Number.isFinite)) continue;
    const button = buttons.get(one.id) ?? makeButton(one.id, one.label, labels);
    const at = view.screen(one.centroid, hide);
    // Until the view rests again, a label stays hidden or not as it was.
    if (!at) button.hidden = true;
    else if (hide) button.hidden = at.hidden;
    if (at) button.style.transform = `translate(${at.x.toFixed(1)}px, ${at.y.toFixed(1)}px)`;
    button.classList.toggle("chosen", finding.peek()?.id === one.id);
  }
  const shapes: SVGElement[] = [];
  const p = place.peek().p;
  const at = p && view.screen(p, false);
  if (at) shapes.push(path(`M${at.x - 9} ${at.y}h18M${at.x} ${at.y - 9}v18`, "cross under"), path(`M${at.x - 9} ${at.y}h18M${at.x} ${at.y - 9}v18`, "cross"));
  const ends = measured.peek().map((end) => view.screen(end, false));
  for (const end of ends) if (end) shapes.push(path(`M${end.x - 5} ${end.y}a5 5 0 1 0 10 0a5 5 0 1 0-10 0`, "end"));
  const [a, b] = ends;
  if (a && b) shapes.push(path(`M${a.x} ${a.y}L${b.x} ${b.y}`, "cross under"), path(`M${a.x} ${a.y}L${b.x} ${b.y}`, "span"));
  shapes.push(...compass(view, view.canvas.clientHeight));
  lines.replaceChildren(...shapes);
}

function makeButton(id: number, label: string, parent: HTMLElement): HTMLButtonElement {
  const button = document.createElement("button");
  button.type = "button";
  button.tabIndex = -1; // the list is the way by keyboard
  button.className = "tag";
  const mark = document.createElementNS(SVG, "svg");
  mark.setAttribute("viewBox", "-1.3 -1.3 2.6 2.6");
  const shape = path(marks.get(label)?.shape ?? "", "");
  shape.setAttribute("fill", marks.get(label)?.css ?? "gray");
  mark.append(shape);
  const text = document.createElement("span");
  text.textContent = findingName(id);
  button.append(mark, text);
  button.title = `${findingName(id)} ${label}`;
  button.addEventListener("click", () => selectFinding(id));
  buttons.set(id, button);
  parent.append(button);
  return button;
}

/** Arrows for the pictures' up, and for root and tip when the row is known. */
function compass(view: View3D, height: number): SVGElement[] {
  const [x, y] = [DIAL + 8, height - DIAL - 8];
  const arrows: [string, Vec3][] = [];
  if (data.up) arrows.push(["up", data.up]);
  const row = visibleRow(data.row, view.surface.center);
  if (row) arrows.push(["tip", row.tip], ["root", [-row.tip[0], -row.tip[1], -row.tip[2]]]);
  if (!arrows.length) return [];
  const words: { text: string; readonly dx: number; readonly dy: number }[] = [];
  const heads = arrows.map(([name, d]) => {
    const [right, up] = view.onScreen(d);
    const [dx, dy] = [ARROW * right, -ARROW * up];
    const beside = words.find((word) => Math.hypot(word.dx - dx, word.dy - dy) < 12); // they would lie on each other
    if (beside) beside.text += `, ${name}`;
    else words.push({ text: name, dx, dy });
    return path(`M${x} ${y}l${dx} ${dy}m${-0.3 * dx - 0.2 * dy} ${-0.3 * dy + 0.2 * dx}l${0.3 * dx + 0.2 * dy} ${0.3 * dy - 0.2 * dx}l${-0.3 * dx + 0.2 * dy} ${-0.3 * dy - 0.2 * dx}`, "way");
  });
  const drawn = [...heads, ...words.map((word) => wordAt(x, y, word.dx, word.dy, word.text))];
  return [path(`M${x - DIAL} ${y}a${DIAL} ${DIAL} 0 1 0 ${2 * DIAL} 0a${DIAL} ${DIAL} 0 1 0-${2 * DIAL} 0`, "dial"), ...drawn];
}

/** A word beyond the head of an arrow from the middle of the dial; nearer where it would reach over the edge. */
function wordAt(x: number, y: number, dx: number, dy: number, words: string): SVGElement {
  const flat = Math.hypot(dx, dy) || 1;
  const [right, down] = [dx / flat, dy / flat];
  const [half, high] = [LETTER * words.length, 6.5]; // of the box around the word
  // The far corner of a box whose middle lies r out is hypot(r |right| + half, r |down| + high) from that of the dial.
  const reach = Math.abs(right) * half + Math.abs(down) * high;
  const free = Math.sqrt(Math.max(0, reach ** 2 + (DIAL - 2) ** 2 - half ** 2 - high ** 2)) - reach;
  const out = Math.max(0, Math.min(flat + 2 + reach, free));
  const text = document.createElementNS(SVG, "text");
  text.setAttribute("x", String(x + out * right));
  text.setAttribute("y", String(y + out * down + 4));
  text.setAttribute("class", "way");
  text.textContent = words;
  return text;
}

function path(d: string, name: string): SVGPathElement {
  const made = document.createElementNS(SVG, "path");
  made.setAttribute("d", d);
  if (name) made.setAttribute("class", name);
  return made;
}
