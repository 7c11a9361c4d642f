/** Starts the page, and answers checks from outside by `window.bladeatlas`. */

import { render } from "preact";
import { listen } from "./keys";
import { App } from "./page/App";
import { overlayOn } from "./page/FrameView";
import { view } from "./page/Surface3D";
import { data, questions, surface } from "./session";
import { followAddress, place } from "./state";
import "./style.css";

followAddress();
const root = document.getElementById("app");
if (root) {
  root.replaceChildren();
  render(<App />, root);
}
listen();

/** What the tests of the page ask; it shows nothing that the page does not. */
const answers = {
  ready: true,
  place: () => place.peek(),
  pointAt: (frame: number, x: number, y: number) => questions.pointAt(frame, x, y),
  visibleFrames: (point: [number, number, number]) => {
    const near = surface?.nearest(point);
    return near ? questions.visibleFrames(near.point, near.normal) : [];
  },
  silhouette: (frame: number, width: number, height: number) =>
    Array.from(overlayOn(document.createElement("canvas"))?.silhouette(frame, width, height) ?? []).join(""),
  camera: () => view.peek()?.orbit.numbers ?? null,
  onCanvas: (point: [number, number, number]) => view.peek()?.screen(point, true) ?? null,
  findings: data.defects.length,
};
declare global {
  interface Window {
    bladeatlas: typeof answers;
  }
}
window.bladeatlas = answers;
