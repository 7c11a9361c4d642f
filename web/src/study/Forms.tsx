/** Consent, what is asked of the person, the two questionnaires, and the end. */

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { begin, data, forget, found, kept, run, tell, tellOfBlock } from "./progress";
import { csvOf, jsonOf, type Block, type Run } from "./record";
import { BACKGROUND, CONSENT, NAMES, PREFERENCE, SUS, TLX, type Choice } from "./words";

export function Consent(): JSX.Element {
  const [agreed, setAgreed] = useState(false);
  const [number, setNumber] = useState("");
  const participant = /^[1-9]\d{0,3}$/.test(number) ? Number(number) : 0;
  return (
    <main>
      <h1>Two ways to look at an inspection</h1>
      {CONSENT.map((text) => <p key={text}>{text}</p>)}
      {data.contact && <p>Who answers questions: <bdi>{data.contact}</bdi></p>}
      <form class="column" onSubmit={(event) => { event.preventDefault(); if (agreed && participant) begin(participant); }}>
        <label class="line"><input type="checkbox" checked={agreed} onChange={() => setAgreed(!agreed)} /> I have read this, I am of age, and I take part of my own will.</label>
        <label class="line">The number that you were given <input type="number" min="1" max="9999" step="1" value={number} onInput={(event) => setNumber(event.currentTarget.value)} /></label>
        <p><button type="submit" class="next" disabled={!agreed || !participant}>Begin</button></p>
      </form>
    </main>
  );
}

/** Somebody began and did not end: nobody goes on with another's answers without a word. */
export function Found({ now }: { readonly now: Run }): JSX.Element {
  return (
    <main>
      <h1>Number {now.participant} {now.ended ? "has ended" : "has begun and not ended"}</h1>
      <p>{now.ended ? "The answers are still in this browser." : "The answers up to there are in this browser. A question that was open is asked again, and its time begins again."}</p>
      <p><button type="button" class="next" onClick={() => (found.value = false)}>{now.ended ? "To the answers" : "Go on"}</button> <button type="button" onClick={forget}>Delete them and begin anew</button></p>
    </main>
  );
}

function Choices({ choices, told, children }: { readonly choices: readonly Choice[]; readonly told: (said: Record<string, string>) => void; readonly children?: JSX.Element }): JSX.Element {
  const [said, setSaid] = useState<Record<string, string>>({});
  const all = choices.every((one) => said[one.name]);
  return (
    <form class="column" onSubmit={(event) => { event.preventDefault(); if (all) told(said); }}>
      {choices.map((one) => (
        <fieldset key={one.name}>
          <legend>{one.question}</legend>
          {one.options.map((option) => <label key={option}><input type="radio" name={one.name} checked={said[one.name] === option} onChange={() => setSaid({ ...said, [one.name]: option })} /> {option}</label>)}
        </fieldset>
      ))}
      {children}
      <p><button type="submit" class="next" disabled={!all}>Next</button></p>
    </form>
  );
}

export const Background = (): JSX.Element => (
  <main><h1>Three questions about you</h1><Choices choices={BACKGROUND} told={(said) => tell({ background: said })} /></main>
);

export function Preference(): JSX.Element {
  const [why, setWhy] = useState("");
  return (
    <main>
      <h1>Which would you take?</h1>
      <Choices choices={PREFERENCE} told={(said) => tell({ preference: { ...said, why: why.trim() }, ended: new Date().toISOString() })}>
        <label class="column">Why? (may stay empty)<textarea rows={4} maxLength={2000} value={why} onInput={(event) => setWhy(event.currentTarget.value)} /></label>
      </Choices>
    </main>
  );
}

export function Sus({ number, block }: { readonly number: number; readonly block: Block }): JSX.Element {
  const [marks, setMarks] = useState<readonly number[]>(SUS.map(() => 0));
  const all = marks.every(Boolean);
  return (
    <main>
      <h1>What do you think of the {NAMES[block.condition]}?</h1>
      <p>“System” means the {NAMES[block.condition]} that you have just used. 1: strongly disagree, 5: strongly agree.</p>
      <form class="column" onSubmit={(event) => { event.preventDefault(); if (all) tellOfBlock(number, { sus: marks }); }}>
        {SUS.map((text, k) => (
          <fieldset key={text}>
            <legend>{text}</legend>
            {[1, 2, 3, 4, 5].map((mark) => <label key={mark}><input type="radio" name={`sus${k}`} checked={marks[k] === mark} onChange={() => setMarks(marks.map((one, at) => (at === k ? mark : one)))} /> {mark}</label>)}
          </fieldset>
        ))}
        <p><button type="submit" class="next" disabled={!all}>Next</button></p>
      </form>
    </main>
  );
}

export function Tlx({ number, block }: { readonly number: number; readonly block: Block }): JSX.Element {
  const [marks, setMarks] = useState<Readonly<Record<string, number>>>({});
  const all = TLX.every((one) => marks[one.name] !== undefined);
  return (
    <main>
      <h1>How was it to answer the questions with the {NAMES[block.condition]}?</h1>
      <p>Put every mark where it belongs; also a mark that shall stay in the middle has to be touched.</p>
      <form class="column" onSubmit={(event) => { event.preventDefault(); if (all) tellOfBlock(number, { tlx: marks }); }}>
        {TLX.map((one) => {
          const set = (event: Event): void => setMarks({ ...marks, [one.name]: Number((event.currentTarget as HTMLInputElement).value) });
          return (
            <label key={one.name} class="scale">
              <b>{one.title}</b> {one.question}
              <span class="line"><small>{one.ends[0]}</small><input type="range" min="0" max="100" step="5" value={marks[one.name] ?? 50} class={marks[one.name] === undefined ? "unset" : ""} onInput={set} onClick={set} /><small>{one.ends[1]}</small></span>
              <small>{marks[one.name] === undefined ? "not marked yet" : "marked"}</small>
            </label>
          );
        })}
        <p><button type="submit" class="next" disabled={!all}>Next</button></p>
      </form>
    </main>
  );
}

export function End({ now }: { readonly now: Run }): JSX.Element {
  const name = `study-${now.study}-${String(now.participant).padStart(2, "0")}`;
  return (
    <main>
      <h1>Thank you</h1>
      <p>That was all. Save both files; then the answers may be deleted from this browser.</p>
      <p>
        <button type="button" class="next" onClick={() => save(`${name}.json`, "application/json", jsonOf(now))}>Save as JSON</button>{" "}
        <button type="button" class="next" onClick={() => save(`${name}.csv`, "text/csv", csvOf(now))}>Save as CSV</button>
      </p>
      {!kept.value && <p class="warn">This browser keeps nothing for this page: save before you close it.</p>}
      <p><button type="button" onClick={forget}>They are saved: delete them here</button></p>
    </main>
  );
}

function save(name: string, type: string, text: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** At every moment: stop, and delete what was recorded. */
export function Stop(): JSX.Element | null {
  const [asked, setAsked] = useState(false);
  if (!run.value || run.value.ended) return null;
  return asked ? (
    <span role="group" aria-label="Stop">Delete all your answers? <button type="button" onClick={() => { setAsked(false); forget(); }}>Yes, stop and delete</button> <button type="button" onClick={() => setAsked(false)}>No</button></span>
  ) : <button type="button" onClick={() => setAsked(true)}>Stop</button>;
}
