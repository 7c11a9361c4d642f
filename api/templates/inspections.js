// The service's start page: inspections of the account, and the form that makes one. Texts are only ever set as text.
"use strict";
const PIECE = 8 << 20; // bytes of one request of an upload
const ACTIVE = ["queued", "running", "cancelling"];
const VIDEO = /\.(mp4|m4v|mov|avi|mkv|webm|ts|mpg|mpeg|wmv|flv|h26[45]|mjpe?g)$/i;
const at = (id) => document.getElementById(id);
const made = (tag, text, more = {}) => Object.assign(document.createElement(tag), text === undefined ? {} : { textContent: text }, more);
const verdicts = new Map(); // by inspection and attempt
let chosen = []; // {file, kind, holds}
let older = []; // pages behind the first
let cursor = null;
let timer = 0;

class Problem extends Error {
  constructor(answer, told) {
    super(told?.detail ?? `the service answers ${answer.status}`);
    this.status = answer.status;
  }
}

async function ask(method, path, { headers = {}, body, json } = {}) {
  const write = method === "GET" || method === "HEAD" ? {} : { "X-BladeAtlas-Write": "1" };
  const type = json === undefined ? {} : { "Content-Type": "application/json" };
  const answer = await fetch(path, { method, credentials: "same-origin", headers: { ...write, ...type, ...headers }, body: json === undefined ? body : JSON.stringify(json) });
  if (answer.ok) return answer;
  throw new Problem(answer, await answer.json().catch(() => null));
}

function say(error) {
  at("said").textContent = error instanceof Error ? error.message : error;
}

// ---- who asks

async function enter() {
  try {
    const session = await (await ask("GET", "v1/session")).json();
    at("who").textContent = `Account ${session.account}`;
    at("sign-out").hidden = localStorage.getItem("bladeatlas signed in") !== "1";
    at("sign-in").hidden = true;
    at("inside").hidden = false;
    at("new").hidden = !session.scopes.includes("submit");
    await refresh();
  } catch (error) {
    if (error.status !== 401) return say(error);
    at("who").textContent = "";
    at("sign-out").hidden = at("inside").hidden = true;
    at("sign-in").hidden = false;
    at("key").focus();
  }
}

at("sign-in").addEventListener("submit", async (event) => {
  event.preventDefault();
  const key = at("key").value.trim();
  at("key").value = "";
  say("");
  try {
    await ask("POST", "v1/session", { headers: { Authorization: `Bearer ${key}` } });
    localStorage.setItem("bladeatlas signed in", "1");
    await enter();
  } catch (error) {
    say(error);
  }
});

at("sign-out").addEventListener("click", async () => {
  await ask("DELETE", "v1/session").catch(say);
  localStorage.removeItem("bladeatlas signed in");
  at("list").replaceChildren();
  await enter();
});

// ---- the list

async function refresh() {
  clearTimeout(timer);
  let page;
  try {
    page = await (await ask("GET", "v1/inspections?limit=25")).json();
    if (!older.length) cursor = page.next_cursor;
    const list = [...page.inspections, ...older.filter((one) => !page.inspections.some((own) => own.id === one.id))];
    await Promise.all(list.map(judge));
    show(list);
  } catch (error) {
    if (error.status === 401) return void enter();
    say(error);
  }
  const busy = page?.inspections.some((one) => ACTIVE.includes(one.state));
  timer = setTimeout(refresh, document.visibilityState === "hidden" ? 30_000 : busy ? 2_000 : 10_000);
}

/** The verdict stands in the quality report, which is there once it is over. */
async function judge(one) {
  const name = `${one.id} ${one.attempt}`;
  if (ACTIVE.includes(one.state) || verdicts.has(name)) return;
  const quality = await ask("GET", `v1/inspections/${one.id}/quality`).then((answer) => answer.json(), () => null);
  if (quality) verdicts.set(name, quality.verdict ?? null);
}

function show(list) {
  const focused = document.activeElement?.dataset?.name;
  at("none").hidden = list.length > 0;
  at("older").hidden = cursor === null;
  at("list").replaceChildren(...list.map(item));
  if (focused) document.querySelector(`[data-name="${CSS.escape(focused)}"]`)?.focus();
}

function item(one) {
  const row = made("li");
  row.dataset.id = one.id;
  const head = made("h3");
  head.append(made("bdi", one.label || one.external_id || one.id.slice(0, 8)), made("span", one.state, { className: `badge ${one.state}` }));
  const verdict = verdicts.get(`${one.id} ${one.attempt}`);
  if (verdict && !ACTIVE.includes(one.state)) head.append(made("span", `verdict ${verdict}`, { className: `badge ${verdict}` }));
  row.append(head);
  if (ACTIVE.includes(one.state)) row.append(made("progress", undefined, { max: 1, value: one.progress, ariaLabel: `Progress of ${one.label || one.id}` }), made("p", doing(one), { className: "facts" }));
  if (one.error) row.append(made("p", one.error.detail, { className: "facts failed" }));
  const told = [`made ${new Date(one.created_at).toLocaleString()}`, one.videos.length > 1 ? `${one.videos.length} videos` : "", `preset ${one.parameters?.preset ?? "default"}`, one.external_id];
  row.append(made("p", told.filter(Boolean).join(" · "), { className: "facts" }));
  const metadata = Object.entries(one.metadata).map(([name, text]) => `${name.replaceAll("_", " ")}: ${text}`);
  if (metadata.length) row.append(made("p", metadata.join(" · "), { className: "facts" }));
  if (one.warnings.length) row.append(made("p", `${one.warnings.length} ${one.warnings.length === 1 ? "warning" : "warnings"} of the checks`, { className: "facts partial" }));
  row.append(acts(one));
  return row;
}

function doing(one) {
  const parts = [`${Math.round(100 * one.progress)} %`, one.stage ? `stage ${one.stage}` : "", one.queue ? `place ${one.queue.position} of the queue` : ""];
  if (one.eta_s) parts.push(`${minutes(one.eta_s[0])} to ${minutes(one.eta_s[1])} left`);
  return parts.filter(Boolean).join(" · ");
}

const minutes = (seconds) => (seconds < 90 ? `${Math.round(seconds)} s` : `${Math.round(seconds / 60)} min`);

function acts(one) {
  const box = made("div", undefined, { className: "acts" });
  const name = one.label || one.id.slice(0, 8);
  const button = (text, path, method, sure) => {
    const made_ = made("button", text, { type: "button", ariaLabel: `${text} ${name}` });
    made_.dataset.name = `${one.id} ${text}`;
    made_.addEventListener("click", async () => {
      if (sure && !(await confirmed(sure))) return;
      say("");
      await ask(method, path).catch(say);
      older = older.filter((each) => each.id !== one.id || method !== "DELETE");
      await refresh();
    });
    box.append(made_);
  };
  const own = `v1/inspections/${one.id}`;
  if (!ACTIVE.includes(one.state) && verdicts.has(`${one.id} ${one.attempt}`)) {
    for (const [text, file] of [["View", "viewer/index.html"], ["Report", "report.pdf"]]) {
      const link = made("a", text, { href: `${own}/${file}`, ariaLabel: `${text} ${name}` });
      link.dataset.name = `${one.id} ${text}`;
      box.append(link);
    }
  }
  if (one.cancellable) button("Cancel", `${own}/cancel`, "POST");
  if (!ACTIVE.includes(one.state)) button("Retry", `${own}/retry`, "POST");
  button("Delete", own, "DELETE", `Delete ${name} with all its results and reviews?`);
  return box;
}

function confirmed(text) {
  at("sure-text").textContent = text;
  at("sure").returnValue = "no";
  at("sure").showModal();
  return new Promise((done) => at("sure").addEventListener("close", () => done(at("sure").returnValue === "yes"), { once: true }));
}

at("older").addEventListener("click", async () => {
  try {
    const page = await (await ask("GET", `v1/inspections?limit=25&cursor=${encodeURIComponent(cursor)}`)).json();
    older.push(...page.inspections);
    cursor = page.next_cursor;
    await refresh();
  } catch (error) {
    say(error);
  }
});

// ---- the form: what was understood is shown before anything is sent

async function take(files) {
  for (const file of files) {
    if (chosen.some((one) => one.file.name === file.name && one.file.size === file.size)) continue;
    chosen.push(await look(file));
  }
  understood();
}

/** What a file seems to be; the service decides by its content. */
async function look(file) {
  if (file.type.startsWith("video/") || VIDEO.test(file.name)) return { file, kind: "video", holds: await film(file) };
  return { file, kind: "annotations", holds: await labels(file) };
}

function film(file) {
  return new Promise((done) => {
    const video = document.createElement("video");
    const address = URL.createObjectURL(file);
    const end = (text) => {
      URL.revokeObjectURL(address);
      done(text);
    };
    video.preload = "metadata";
    video.onloadedmetadata = () => end(video.videoWidth ? `${video.videoWidth} x ${video.videoHeight}, ${video.duration.toFixed(1)} s` : "no picture that this browser shows");
    video.onerror = () => end("not shown by this browser; the service looks into it");
    setTimeout(() => end("the service looks into it"), 5000);
    video.src = address;
  });
}

async function labels(file) {
  if (file.size > 64 << 20) return "the service looks into it";
  let value;
  try {
    value = JSON.parse(await file.text());
  } catch {
    return /\.json$/i.test(file.name) ? "no valid JSON" : "the service looks into it";
  }
  const found = new Map();
  const note = (label) => found.set(String(label), (found.get(String(label)) ?? 0) + 1);
  if (Array.isArray(value?.annotations) && Array.isArray(value?.categories)) {
    const names = new Map(value.categories.map((one) => [one.id, one.name]));
    for (const one of value.annotations) note(names.get(one.category_id) ?? one.category_id);
    return counted("COCO", found);
  }
  if (value && typeof value === "object" && !Array.isArray(value)) {
    for (const one of Object.values(value)) if (Array.isArray(one?.detections)) for (const own of one.detections) note(own?.label);
    if (found.size || Object.values(value).some((one) => Array.isArray(one?.detections))) return counted("our own form", found);
  }
  return "JSON; the service tells its form";
}

function counted(form, found) {
  const all = [...found.values()].reduce((sum, count) => sum + count, 0);
  const each = [...found].sort((a, b) => b[1] - a[1]).slice(0, 5).map(([label, count]) => `${label} ${count}`);
  return `${form}: ${all} ${all === 1 ? "detection" : "detections"}${each.length ? ` (${each.join(", ")}${found.size > 5 ? ", ..." : ""})` : ""}`;
}

/** Videos in order with their annotations: by name, else in the order in which they came. */
function pairs() {
  const stem = (file) => file.name.replace(/\.[^.]+$/, "").toLowerCase();
  const videos = chosen.filter((one) => one.kind === "video");
  const rest = chosen.filter((one) => one.kind === "annotations");
  const found = videos.map((video) => ({ video, annotations: rest.find((one) => stem(one.file).startsWith(stem(video.file)) || stem(video.file).startsWith(stem(one.file))) ?? null }));
  const left = rest.filter((one) => !found.some((pair) => pair.annotations === one));
  for (const pair of found) pair.annotations ??= left.shift() ?? null;
  return { found, left };
}

function understood() {
  const { found, left } = pairs();
  at("understood").hidden = !chosen.length;
  at("rows").replaceChildren(...chosen.map((one, k) => {
    const row = made("tr");
    const remove = made("button", "Remove", { type: "button", ariaLabel: `Remove ${one.file.name}` });
    remove.addEventListener("click", () => { chosen.splice(k, 1); understood(); });
    const kind = made("select", undefined, { ariaLabel: `What ${one.file.name} is` });
    for (const name of ["video", "annotations"]) kind.append(made("option", name, { selected: one.kind === name }));
    kind.addEventListener("change", () => { one.kind = kind.value; understood(); });
    const cells = [made("td"), made("td"), made("td", one.holds), made("td", size(one.file.size)), made("td")];
    cells[0].append(made("bdi", one.file.name));
    cells[1].append(kind);
    cells[4].append(remove);
    row.append(...cells);
    return row;
  }));
  const words = found.map(({ video, annotations }) => `${video.file.name} with ${annotations ? annotations.file.name : "no annotations: the surface alone"}`);
  for (const one of left) words.push(`${one.file.name} belongs to no video`);
  if (!found.length && chosen.length) words.push("A video is missing.");
  at("pairs").textContent = words.join("; ");
  at("send").disabled = !found.length || left.length > 0;
}

const size = (bytes) => (bytes < 1 << 20 ? `${Math.ceil(bytes / 1024)} kB` : `${(bytes / (1 << 20)).toFixed(1)} MB`);

for (const name of ["dragenter", "dragover"]) at("drop").addEventListener(name, (event) => { event.preventDefault(); at("drop").classList.add("over"); });
for (const name of ["dragleave", "drop"]) at("drop").addEventListener(name, () => at("drop").classList.remove("over"));
at("drop").addEventListener("drop", (event) => { event.preventDefault(); void take(event.dataTransfer.files); });
at("files").addEventListener("change", (event) => { void take(event.target.files).then(() => { event.target.value = ""; }); });

// ---- sending, by tus: what was cut off goes on where it stopped, also after the page was closed

async function upload(file, told) {
  const known = `bladeatlas upload ${file.name} ${file.size} ${file.lastModified}`;
  const headers = { "Tus-Resumable": "1.0.0" };
  let place = localStorage.getItem(known);
  let offset = place ? await reached(place, headers) : null;
  if (offset === null) {
    const name = btoa(String.fromCharCode(...new TextEncoder().encode(file.name)));
    const answer = await ask("POST", "v1/uploads", { headers: { ...headers, "Upload-Length": String(file.size), "Upload-Metadata": `filename ${name}` } });
    place = answer.headers.get("Location").replace(/^.*\/(?=v1\/uploads\/)/, "");
    localStorage.setItem(known, place);
    offset = 0;
  }
  for (let failures = 0; offset < file.size; ) {
    try {
      const answer = await ask("PATCH", place, { headers: { ...headers, "Upload-Offset": String(offset), "Content-Type": "application/offset+octet-stream" }, body: file.slice(offset, offset + PIECE) });
      offset = Number(answer.headers.get("Upload-Offset"));
      failures = 0;
    } catch (error) {
      if ((error.status && error.status < 500 && error.status !== 409) || ++failures > 20) throw error;
      told(offset, "waiting for the service");
      await new Promise((done) => setTimeout(done, Math.min(10_000, 500 * 2 ** failures)));
      offset = (await reached(place, headers)) ?? offset;
    }
    told(offset);
  }
  return { id: place.split("/").pop(), done: () => localStorage.removeItem(known) };
}

/** Bytes of an upload that are safe; null when it is gone. */
async function reached(place, headers) {
  return ask("HEAD", place, { headers }).then((answer) => Number(answer.headers.get("Upload-Offset")), () => null);
}

at("new").addEventListener("submit", async (event) => {
  event.preventDefault();
  const { found } = pairs();
  const files = found.flatMap(({ video, annotations }) => [video.file, ...(annotations ? [annotations.file] : [])]);
  const whole = files.reduce((sum, file) => sum + file.size, 0);
  at("send").disabled = true;
  at("sent").hidden = false;
  say("");
  try {
    let before = 0;
    const sent = new Map();
    for (const file of files) {
      const told = (offset, words) => {
        at("sent").value = whole ? (before + offset) / whole : 1;
        at("sending").textContent = words ?? `${file.name}: ${size(offset)} of ${size(file.size)}`;
      };
      sent.set(file, await upload(file, told));
      before += file.size;
    }
    const videos = found.map(({ video, annotations }) => ({ video_upload: sent.get(video.file).id, ...(annotations ? { annotations_upload: sent.get(annotations.file).id } : {}) }));
    at("sending").textContent = "the service looks into it";
    const body = { ...(videos.length > 1 ? { videos } : videos[0]), parameters: parameters() };
    await ask("POST", "v1/inspections", { json: body });
    for (const one of sent.values()) one.done();
    chosen = [];
    at("new").reset();
  } catch (error) {
    say(error);
  }
  at("sent").hidden = true;
  at("sending").textContent = "";
  understood();
  await refresh();
});

function parameters() {
  const given = new FormData(at("new"));
  const metadata = {};
  for (const [name, value] of given) if (name.startsWith("metadata.") && value) metadata[name.slice(9)] = value;
  return { preset: given.get("preset"), label: given.get("label"), external_id: given.get("external_id"), metadata };
}

void enter();
