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
