"""Style and script of the gallery page. Both are inline: the page needs no network."""

from __future__ import annotations

STYLE = """
:root { color-scheme: light dark; --bg: #f5f6f7; --card: #fff; --ink: #1c2126; --dim: #5c6670; --line: #d9dde1;
  --accent: #b3261e; --focus: #1f6feb; --ok: #1a7f45; --warn: #9a5b00; }
@media (prefers-color-scheme: dark) { :root { --bg: #15181b; --card: #1e2226; --ink: #e7eaed; --dim: #9aa4ae;
  --line: #343a41; --accent: #ff8a80; --focus: #6cb0ff; --ok: #5fd08f; --warn: #f0b45a; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--bg); color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
main, header, footer { max-width: 1500px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 28px; }
h1 { font-size: 24px; margin: 0; letter-spacing: -0.01em; }
h2 { font-size: 17px; margin: 32px 0 10px; }
p.lead, footer { color: var(--dim); margin: 4px 0 20px; }
:focus-visible { outline: 3px solid var(--focus); outline-offset: 2px; }
.views { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 420px), 1fr)); gap: 16px; }
.views img { width: 100%; height: auto; display: block; border-radius: 8px; border: 1px solid var(--line); }
.scroll { overflow-x: auto; background: var(--card); border: 1px solid var(--line); border-radius: 8px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: 7px 12px; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
th { font-weight: 600; font-size: 13px; color: var(--dim); }
tr:last-child td { border-bottom: 0; }
th.t, td.t { text-align: left; }
tr.on td { background: color-mix(in srgb, var(--accent) 12%, transparent); }
button, select { font: inherit; color: inherit; background: var(--card); border: 1px solid var(--line);
  border-radius: 6px; padding: 4px 10px; cursor: pointer; }
button[aria-pressed="true"] { border-color: var(--accent); color: var(--accent); font-weight: 600; }
.filters { position: sticky; top: 0; z-index: 2; display: flex; flex-wrap: wrap; gap: 10px 18px; align-items: end;
  padding: 10px 0; background: var(--bg); border-bottom: 1px solid var(--line); margin-bottom: 16px; }
.filters label { display: grid; font-size: 13px; color: var(--dim); }
.filters output { margin-left: auto; color: var(--dim); }
.grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 300px), 1fr)); gap: 16px; }
figure { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
figure[hidden] { display: none; }
figure a.picture { display: block; }
figure img { width: 100%; height: auto; display: block; background: #000; }
figcaption { padding: 8px 12px 10px; }
figcaption ul { list-style: none; margin: 4px 0 0; padding: 0; }
figcaption li { display: flex; gap: 8px; align-items: baseline; font-size: 14px; overflow-wrap: anywhere; }
.dot { flex: none; width: 10px; height: 10px; border-radius: 3px; }
.mapped { color: var(--ok); } .approximate, .unplaced { color: var(--warn); }
.state { margin-left: auto; font-size: 13px; text-align: right; }
dialog { border: 0; padding: 0; background: #000; color: #fff; max-width: 96vw; max-height: 96vh; }
dialog::backdrop { background: rgba(0, 0, 0, .8); }
dialog img { display: block; max-width: 96vw; max-height: 86vh; margin: 0 auto; }
dialog p { margin: 8px 16px; text-align: center; }
""".strip()

SCRIPT = """
'use strict';
const figures = [...document.querySelectorAll('figure[data-frame]')];
const label = document.getElementById('label'), outcome = document.getElementById('outcome');
const defect = document.getElementById('defect'), shown = document.getElementById('shown');
const buttons = [...document.querySelectorAll('button[data-defect]')];
function matches(item) {
  return (!label.value || item.dataset.label === label.value)
    && (!outcome.value || item.dataset.outcome === outcome.value)
    && (!defect.value || item.dataset.defect === defect.value);
}
function apply() {
  let frames = 0;
  for (const figure of figures) {
    const hit = [...figure.querySelectorAll('li')].some(matches);
    figure.hidden = !hit;
    frames += hit ? 1 : 0;
  }
  for (const button of buttons) {
    const on = button.dataset.defect === defect.value;
    button.setAttribute('aria-pressed', String(on));
    button.closest('tr').classList.toggle('on', on);
  }
  shown.textContent = frames + ' of ' + figures.length + ' frames';
}
for (const field of [label, outcome, defect]) field.addEventListener('change', apply);
for (const button of buttons) button.addEventListener('click', () => {
  defect.value = defect.value === button.dataset.defect ? '' : button.dataset.defect;
  apply();
});
document.getElementById('reset').addEventListener('click', () => {
  label.value = outcome.value = defect.value = '';
  apply();
});
const dialog = document.querySelector('dialog'), big = dialog.querySelector('img'), text = dialog.querySelector('p');
let current = null;
function show(figure) {
  current = figure;
  big.src = figure.querySelector('a.picture').href;
  big.alt = figure.querySelector('img').alt;
  text.textContent = big.alt;
  if (!dialog.open) dialog.showModal();
}
for (const figure of figures) figure.querySelector('a.picture').addEventListener('click', (event) => {
  event.preventDefault();
  show(figure);
});
dialog.addEventListener('click', () => dialog.close());
dialog.addEventListener('keydown', (event) => {
  const step = {ArrowLeft: -1, ArrowRight: 1}[event.key];
  if (!step) return;
  const visible = figures.filter((figure) => !figure.hidden);
  const next = visible[visible.indexOf(current) + step];
  if (next) show(next);
});
dialog.addEventListener('close', () => current && current.querySelector('a.picture').focus());
apply();
""".strip()
