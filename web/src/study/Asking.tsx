/** One task: the question first, the scene when the person is ready, then the answer and how sure it is. */

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Condition } from "./plan";
import { answer, data, read, run, type TaskData } from "./progress";
import type { Block } from "./record";
import { INTRODUCTIONS, NAMES } from "./words";

const ADDRESS: Readonly<Record<Condition, string>> = { gallery: "gallery/index.html", page: "viewer/index.html" };
const addressOf = (scene: string, condition: Condition): string => `scenes/${scene}/${ADDRESS[condition]}`;

/** A scene in a frame of its own. Its origin stays that of this page: without one, a page from a folder may not read its own files. */
function Scene({ scene, condition, times, ready }: { readonly scene: string; readonly condition: Condition; readonly times: number; readonly ready?: () => void }): JSX.Element {
  return <iframe key={times} class="scene" title={`The ${NAMES[condition]}`} src={addressOf(scene, condition)} sandbox="allow-scripts allow-same-origin" onLoad={ready} />;
}

export function Introduction({ number, block }: { readonly number: number; readonly block: Block }): JSX.Element {
  return (
    <main class={data.practice ? "tall" : ""}>
      <h1>Part {number + 1} of 2: the {NAMES[block.condition]}</h1>
      <p>{INTRODUCTIONS[block.condition]}</p>
      <p>Each question is shown before the scene. Time runs from the moment at which you ask for the scene until you answer; be quick, but rather right than quick.</p>
      {data.practice && <p>This is another scene, to look around in: take as long as you like.</p>}
      <p><button type="button" class="next" onClick={() => read(number)}>I am ready</button></p>
      {data.practice && <Scene scene="practice" condition={block.condition} times={0} />}
    </main>
  );
}

interface Clock {
  started: number;
  hiddenSince: number | null;
  hidden: number;
}

export function Asking({ number, position, block }: { readonly number: number; readonly position: number; readonly block: Block }): JSX.Element {
  const task = data.tasks.find((one) => one.id === block.order[position]) as TaskData;
  const [ready, setReady] = useState(false);
  const [shown, setShown] = useState(false);
  const [times, setTimes] = useState(0);
  const [done, setDone] = useState<{ readonly answer: string | null; readonly seconds: number; readonly hidden: number } | null>(null);
  const clock = useRef<Clock>({ started: 0, hiddenSince: null, hidden: 0 });
  useEffect(() => watched(clock.current), []);
  const show = (): void => {
    clock.current.started = performance.now();
    clock.current.hidden = 0;
    setShown(true);
  };
  const give = (said: string | null): void => setDone({ answer: said, seconds: (performance.now() - clock.current.started) / 1000, hidden: clock.current.hidden / 1000 });
  const box = data.scenes.find((one) => one.name === block.scene)?.box ?? "";
  return (
    <main class="tall">
      <div class="question">
        <p class="where">Part {number + 1} of 2, question {position + 1} of {block.order.length}</p>
        <h1>{task.text.replace("{box}", box)}</h1>
        {done ? (
          <Sureness told={(confidence) => answer(number, { task: task.id, answer: done.answer, seconds: done.seconds, confidence, hidden_s: done.hidden, reopened: times })} />
        ) : shown ? (
          <Field task={task} give={give} reopen={() => setTimes(times + 1)} />
        ) : (
          <button type="button" class="next" disabled={!ready} onClick={show}>{ready ? "Show the scene" : "The scene is being opened"}</button>
        )}
      </div>
      <div class={shown && !done ? "stand" : "stand covered"} inert={!shown || !!done}>
        <Scene scene={block.scene} condition={block.condition} times={times} ready={() => setReady(true)} />
      </div>
      {!shown && <p class="cover">Read the question. The scene appears when you ask for it.</p>}
    </main>
  );
}

/** Adds up how long the window is hidden; ends with the task. */
function watched(clock: Clock): () => void {
  const changed = (): void => {
    if (document.hidden) clock.hiddenSince = performance.now();
    else if (clock.hiddenSince !== null) {
      clock.hidden += performance.now() - clock.hiddenSince;
      clock.hiddenSince = null;
    }
  };
  document.addEventListener("visibilitychange", changed);
  return () => document.removeEventListener("visibilitychange", changed);
}

function Field({ task, give, reopen }: { readonly task: TaskData; readonly give: (said: string | null) => void; readonly reopen: () => void }): JSX.Element {
  const [text, setText] = useState("");
  const form = (event: Event): void => {
    event.preventDefault();
    if (text) give(task.kind === "finding" ? `D${text}` : text);
  };
  return (
    <form class="answer" onSubmit={form}>
      {task.kind === "end" ? (
        <fieldset>
          <legend>Your answer</legend>
          {["root", "tip"].map((end) => <label key={end}><input type="radio" name="end" checked={text === end} onChange={() => setText(end)} /> {end}</label>)}
        </fieldset>
      ) : (
        <label>Your answer {task.kind === "finding" ? "D" : ""}<input type="number" min="0" max="999999" step="1" value={text} onInput={(event) => setText(event.currentTarget.value)} /> {task.kind === "finding" ? "(number of the finding)" : task.unit}</label>
      )}
      <button type="submit" class="next" disabled={!text}>This is my answer</button>
      <button type="button" onClick={() => give(null)}>{data.not_told}</button>
      <button type="button" class="aside" onClick={reopen}>Open the scene anew</button>
    </form>
  );
}

function Sureness({ told }: { readonly told: (confidence: number) => void }): JSX.Element {
  const [sure, setSure] = useState(0);
  return (
    <form class="answer" onSubmit={(event) => { event.preventDefault(); if (sure) told(sure); }}>
      <fieldset>
        <legend>How sure are you of your answer?</legend>
        <span>guessed</span>
        {[1, 2, 3, 4, 5, 6, 7].map((mark) => <label key={mark}><input type="radio" name="sure" checked={sure === mark} onChange={() => setSure(mark)} /> {mark}</label>)}
        <span>certain</span>
      </fieldset>
      <button type="submit" class="next" disabled={!sure}>Next</button>
    </form>
  );
}

/** How much is done, for people and for screen readers. */
export function Progress(): JSX.Element | null {
  const now = run.value;
  if (!now || now.ended) return null;
  const all = now.blocks.reduce((sum, one) => sum + one.order.length, 0);
  const done = now.blocks.reduce((sum, one) => sum + one.answers.length, 0);
  return <span class="progress"><progress max={all} value={done} aria-label="Questions answered" /> {done} of {all}</span>;
}
