// What the twin's pages have in common: small words, colours, and frequencies over the reach with their shapers.
const $ = id => document.getElementById(id);
const make = (tag, props, ...children) => { const e = Object.assign(document.createElement(tag), props); e.append(...children); return e; };
const row = (body, texts, className) => { const r = body.insertRow(); if (className) r.className = className; for (const t of texts) r.insertCell().textContent = t; };
const mm = v => Math.abs(v) < .1 ? (1000 * v).toFixed(1) + " \u00b5m" : v.toFixed(3) + " mm";
// ---- Colours
const VIRIDIS = [[68,1,84],[72,40,120],[62,73,137],[49,104,142],[38,130,142],[31,158,137],[53,183,121],[110,206,88],[181,222,43],[253,231,37]];
const isDark = matchMedia("(prefers-color-scheme: dark)");
function colour(part) {
  const [from, to] = isDark.matches ? [.2, 1] : [0, .86];
  const f = (from + (to - from) * Math.min(Math.max(part, 0), 1)) * 9, k = Math.min(8, Math.floor(f)), r = f - k;
  return "rgb(" + VIRIDIS[k].map((c, j) => Math.round(c + (VIRIDIS[k + 1][j] - c) * r)) + ")";
}
// ---- Resonance: a map and shapers for each axis
function drawResonance() {
  $("resonance").replaceChildren();
  for (const letter of ["x", "y", "z"].filter(axis => D.resonance[axis])) {
    const A = D.resonance[letter], [low, high] = A.band_Hz;
    const map = make("table", { className: "heatmap" });
    [...A.frequencies_Hz].reverse().forEach((line, j) => {
      const r = map.insertRow();
      r.insertCell().textContent = D.resonance.y_mm[D.resonance.y_mm.length - 1 - j].toFixed(0);
      for (const f of line) {
        const cell = r.insertCell(), part = high > low ? (f - low) / (high - low) : 0;
        cell.textContent = f.toFixed(1);
        cell.style.background = colour(part);
        cell.style.color = (isDark.matches ? .2 + .8 * part : .86 * part) > .55 ? "#111" : "#fff";
      }
    });
    const foot = map.insertRow();
    foot.insertCell();
    for (const x of D.resonance.x_mm) foot.insertCell().textContent = x.toFixed(0);
    const shapers = make("table", {}, make("thead", {}, make("tr", {}, ...["Shaper", "Frequency", "Leaves", "Rounds"].map(t => make("th", { textContent: t })))), make("tbody"));
    for (const s of A.shapers) row(shapers.tBodies[0], [s.type, s.frequency_Hz.toFixed(1) + " Hz", (100 * s.worst_residual).toFixed(1) + " %", mm(s.smoothing_mm)], A.suggestion && s.type === A.suggestion.type ? "taken" : "");
    const v = A.resonant_speeds;
    $("resonance").append(make("div", { className: "card panel" },
      make("h2", { textContent: "Frequency of " + letter + " over the reach, Hz, " + (D.model || "with idlers and rotors") }), map, shapers, make("pre", { textContent: A.line }),
      make("span", { className: "sub", textContent: "Rings at " + v.full_step_mm_s.toFixed(1) + " mm/s (full steps), " + v.electrical_turn_mm_s.toFixed(1) + " (electrical turns), " + v.tooth_mm_s.toFixed(1) + " (teeth)." })));
  }
  const panel = (title, text) => $("resonance").append(make("div", { className: "card panel" }, make("h2", { textContent: title }), make("span", { className: "sub", textContent: text })));
  (D.resonance.frame || []).forEach((F, i) => panel("Frame in " + "xy"[i], F.band_Hz.map(v => v.toFixed(1)).join(" to ") + " Hz, " + (100 * F.part).toFixed(1) + " % of the tool's ringing after a jump of speed." + (F.left_by_shaper === null ? "" : " The line for " + "XY"[i] + " leaves up to " + (100 * F.left_by_shaper).toFixed(0) + " % of it.")));
  if (!D.resonance.yaw) return;
  const Y = D.resonance.yaw, [least, most] = Y.band_Hz;
  panel("Yaw of the bar on its guides", least.toFixed(1) + " to " + most.toFixed(1) + " Hz. Moves along y excite it, the more so the further the head is from the middle. No line here is made for it" + (Y.left_by_y === null ? "." : "; that for Y leaves up to " + (100 * Y.left_by_y).toFixed(0) + " % of it."));
}

