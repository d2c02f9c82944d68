// Shared: the frame of the pages that show no print, and frequencies over the reach with their shapers.

const mm = v => Math.abs(v) < 0.1 ? (1000 * v).toFixed(1) + " \u00b5m" : v.toFixed(3) + " mm";
const percent = (part, digits = 0) => (100 * part).toFixed(digits) + " %";
const seconds = v => v.toFixed(v < 100 ? 3 : 1) + " s";
const fileName = path => path.split("/").pop();
/** Puts parts into the page; the first one is its head. */
function show(title, ...parts) {
  document.title = title + " \u2013 corehbot";
  document.querySelector("main").append(...parts.filter(Boolean));
}
const bounds = values => { let a = Infinity, b = -Infinity; for (const v of values) if (v !== null) { a = Math.min(a, v); b = Math.max(b, v); } return [a, b]; };

/** A line that says what is known of the part of an element that a finger or the mouse is on: its `data-says`. */
function sayer(element) {
  const out = make("output", { className: "says", textContent: "\u00a0" }), say = e => { out.textContent = e.target.closest?.("[data-says]")?.getAttribute("data-says") ?? "\u00a0"; };
  for (const name of ["pointerdown", "pointermove"]) element.addEventListener(name, say);
  element.addEventListener("pointerleave", e => { if (e.pointerType === "mouse") out.textContent = "\u00a0"; });
  return out;
}

/** A map of a quantity over rows and columns, as a table of coloured cells; `corner` says what the rows and columns are. */
function heatmap({ label, unit, rows, columns, corner, value, range: [low, high], digits = 1, hint }) {
  const table = make("table", { className: "heatmap", ariaLabel: label });
  const paint = () => {
    table.replaceChildren();
    const head = table.createTHead().insertRow();
    head.append(make("th", { textContent: corner, scope: "col" }), ...columns.map(v => make("th", { textContent: v, scope: "col" })));
    rows.forEach((name, j) => {
      const line = table.insertRow();
      line.append(make("th", { textContent: name, scope: "row" }));
      columns.forEach((_, i) => {
        const v = value(i, j), cell = line.insertCell();
        if (v === null || v === undefined) return;
        cell.textContent = v.toFixed(digits);
        if (hint) cell.dataset.says = hint(i, j);
        shade(cell, high > low ? (v - low) / (high - low) : 0.5);
      });
    });
  };
  paint(); onScheme(table, paint);
  return [scaleOf(low.toFixed(digits), high.toFixed(digits) + " " + unit), ...(hint ? [sayer(table)] : []), make("div", { className: "wide", tabIndex: 0, role: "region", ariaLabel: label }, table)];
}

/** Cards of each axis: its frequency over the reach, and its shapers; then frame and yaw. */
function resonanceCards(R, model) {
  const cards = [], text = v => v.toFixed(1);
  for (const letter of ["x", "y", "z"].filter(axis => R[axis])) {
    const A = R[letter], { full_step_mm_s, electrical_turn_mm_s, tooth_mm_s } = A.resonant_speeds, rows = [...R.y_mm].reverse();
    const map = heatmap({ label: `Frequency of ${letter} over the reach`, unit: "Hz", rows: rows.map(v => v.toFixed(0)), columns: R.x_mm.map(v => v.toFixed(0)), corner: "Y, X mm", value: (i, j) => A.frequencies_Hz[rows.length - 1 - j][i], range: A.band_Hz });
    const shapers = table(["Shaper", "Frequency", "Leaves", "Rounds"], A.shapers.map(s => [s.type, text(s.frequency_Hz) + " Hz", percent(s.worst_residual, 1), mm(s.smoothing_mm)]), "", i => A.suggestion?.type === A.shapers[i].type);
    cards.push(card(`Frequency of ${letter} over the reach, Hz, ${model}`, ...map, shapers, copyLine(A.line),
      note(`Rings at ${text(full_step_mm_s)} mm/s (full steps), ${text(electrical_turn_mm_s)} mm/s (electrical turns), ${text(tooth_mm_s)} mm/s (teeth).`)));
  }
  (R.frame ?? []).forEach((F, i) => cards.push(card("Frame in " + "xy"[i], note(`${F.band_Hz.map(text).join(" to ")} Hz, ${percent(F.part, 1)} of the tool's ringing after a jump of speed.` + (F.left_by_shaper === null ? "" : ` The line for ${"XY"[i]} leaves up to ${percent(F.left_by_shaper)} of it.`)))));
  if (R.yaw) cards.push(card("Yaw of the bar on its guides", note(`${R.yaw.band_Hz.map(text).join(" to ")} Hz. Moves along y excite it, the more so the further the head is from the middle. No line here is made for it` + (R.yaw.left_by_y === null ? "." : `; that for Y leaves up to ${percent(R.yaw.left_by_y)} of it.`))));
  return make("section", { className: "pair" }, ...cards);
}
