// The page of `twin resonance`.

const R = D.resonance, lines = key => [R.x[key], R.y[key]].filter(Boolean);
const setters = (title, all) => [make("h3", { textContent: title }), ...all.map(copyLine)];
const ways = lines("line_by_tool").length ? [["Least error of the tool on walls", lines("line_by_tool")], ["Least ringing at the worst place", lines("line")]] : [["Least ringing at the worst place", lines("line")]];
show("Frequencies over the reach",
  heading("Frequencies over the reach", `${D.machine}, ${D.model}, ${R.x_mm.length} by ${R.y_mm.length} places, from motor 1's axis`),
  tileRow(["x", "y", "z"].filter(axis => R[axis]).map(axis => [R[axis].band_Hz.map(v => v.toFixed(1)).join(" to "), "Hz", "frequency of " + axis])),
  card("Lines to set the shapers", make("div", { className: "pair" }, ...ways.map(([title, all]) => make("div", {}, ...setters(title, all))))),
  resonanceCards(R, D.model));
