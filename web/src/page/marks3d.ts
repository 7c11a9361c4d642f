/** Labels and lines over the 3D canvas, put where the view says; plain DOM, because it happens with every picture. */

import type { Vec3 } from "../model/data";
import { findingName } from "../model/words";
import { visibleRow } from "../model/row";
import type { View3D } from "../scene/view3d";
import { data, marks } from "../session";
import { allFindings, finding, measured, place, selectFinding } from "../state";

const buttons = new Map<number, HTMLButtonElement>();
const SVG = "http://www.w3.org/2000/svg";

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
  const [x, y] = [42, height - 42];
  const arrows: [string, Vec3][] = [];
  if (data.up) arrows.push(["up", data.up]);
  const row = visibleRow(data.row, view.surface.center);
  if (row) arrows.push(["tip", row.tip], ["root", [-row.tip[0], -row.tip[1], -row.tip[2]]]);
  if (!arrows.length) return [];
  const words: { readonly text: SVGElement; readonly dx: number; readonly dy: number }[] = [];
  const heads = arrows.map(([name, d]) => {
    const [right, up] = view.onScreen(d);
    const [dx, dy] = [17 * right, -17 * up];
    const beside = words.find((word) => Math.hypot(word.dx - dx, word.dy - dy) < 12); // they would lie on each other
    if (beside) beside.text.textContent += `, ${name}`;
    else {
      const text = document.createElementNS(SVG, "text");
      const flat = Math.hypot(dx, dy) || 1;
      text.setAttribute("x", String(x + dx + (9 * dx) / flat));
      text.setAttribute("y", String(y + dy + (8 * dy) / flat + 4));
      text.setAttribute("class", "way");
      text.textContent = name;
      words.push({ text, dx, dy });
    }
    return path(`M${x} ${y}l${dx} ${dy}m${-0.3 * dx - 0.2 * dy} ${-0.3 * dy + 0.2 * dx}l${0.3 * dx + 0.2 * dy} ${0.3 * dy - 0.2 * dx}l${-0.3 * dx + 0.2 * dy} ${-0.3 * dy - 0.2 * dx}`, "way");
  });
  const drawn = [...heads, ...words.map((word) => word.text)];
  return [path(`M${x - 33} ${y}a33 33 0 1 0 66 0a33 33 0 1 0-66 0`, "dial"), ...drawn];
}

function path(d: string, name: string): SVGPathElement {
  const made = document.createElementNS(SVG, "path");
  made.setAttribute("d", d);
  if (name) made.setAttribute("class", name);
  return made;
}
