"use strict";
(() => {
  const { viewer } = window.BLADEATLAS;
  const add = (parent, name, text) => {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    parent.append(made);
    return made;
  };
  const app = document.getElementById("app");
  add(app, "h1", viewer.title);
  add(app, "p", `${viewer.verdict}: ${viewer.defects.length} findings, ${viewer.detections.length} detections`);
  if (viewer.surface_reason) add(app, "p", viewer.surface_reason);
  const table = add(app, "table");
  for (const one of viewer.defects) {
    const row = add(table, "tr");
    for (const text of [`D${one.id}`, one.label, one.size]) add(row, "td", String(text));
  }
})();
