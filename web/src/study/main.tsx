/** The study that asks people: consent, eight tasks with the gallery and eight with the page, what they think of each. */

import { render, type JSX } from "preact";
import "../style.css";
import { Asking, Introduction, Progress } from "./Asking";
import { Background, Consent, End, Found, Preference, Stop, Sus, Tlx } from "./Forms";
import { failure, found, run, step } from "./progress";
import "./study.css";

function Study(): JSX.Element {
  if (failure) return <main><h1>There is no study here</h1><p role="alert">{failure}</p></main>;
  return <div class="study"><header><Progress /><span class="stop"><Stop /></span></header><Screen /></div>;
}

function Screen(): JSX.Element {
  const [now, at] = [run.value, step.value];
  if (!now) return <Consent />;
  if (found.value) return <Found now={now} />;
  if (at.what === "background") return <Background />;
  if (at.what === "preference") return <Preference />;
  const number = "block" in at ? at.block : -1;
  const block = now.blocks[number];
  if (!block) return <End now={now} />;
  if (at.what === "introduction") return <Introduction key={number} number={number} block={block} />;
  if (at.what === "task") return <Asking key={`${number} ${at.position}`} number={number} position={at.position} block={block} />;
  return at.what === "sus" ? <Sus key={number} number={number} block={block} /> : <Tlx key={number} number={number} block={block} />;
}

const root = document.getElementById("app");
if (root) {
  root.replaceChildren();
  render(<Study />, root);
}
