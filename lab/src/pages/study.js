// The page of a study (`corehbot-lab sweep`): the figures, how each goes with each number, and points of all samples.

const S = D.summary, MOST_KEYS = 3;
// What is less than a billionth of any unit here is what rounding left: it is no result, and has no correlation.
const clean = v => v !== null && Math.abs(v) < 1e-9 ? 0 : v;
for (const point of D.points) point.figures = point.figures.map(clean);
for (const f of S.figures) for (const key of ["least", "median", "greatest"]) f[key] = clean(f[key]);
/** Whether values span more than rounding: a billionth of themselves. */
const varies = (least, greatest) => greatest - least > 1e-9 * Math.max(Math.abs(least), Math.abs(greatest));

/** The title and the unit of a key or a figure. */
function named(name) {
  const [title, unit] = D.titles[name];
  return [title, unit.replace(/([ms])2/g, "$1\u00b2").replace(/^um/, "\u00b5m").replace("ohm", "\u03a9") || undefined];
}
const several = new Set(S.figures.map(f => f.machine)).size > 1;
const rows = S.figures.map(f => [f.name + (several ? ", " + f.machine : ""), ...[f.least, f.median, f.greatest].map(valueText), ...D.keys.map(key => {
  const rho = varies(f.least, f.greatest) ? f.rank_correlation[key] : undefined;
  if (rho === undefined) return "";
  // From no to full correlation, either way.
  const cell = make("span", { className: "rho", textContent: (rho <= -0.005 ? "\u2212" : "") + Math.abs(rho).toFixed(2) });
  cell.style.background = faint(curveColour(rho < 0 ? 1 : 0), Math.abs(rho) * 0.6);
  return cell;
})]);

// ---- A plot for each figure that varies and each number
const drawn = D.figures.map((name, f) => ({ name, f, range: bounds(D.points.map(p => p.figures[f])) })).filter(({ range: [a, b] }) => a <= b);
const same = drawn.filter(({ range }) => !varies(...range)), shown = drawn.filter(({ range }) => varies(...range));
const list = make("div", { className: "charts" });
const plot = ({ name, f }, k) => { const [title, unit] = named(name), [key, keyUnit] = named(D.keys[k]); return new Graph({
  title, unit, x: { name: key, unit: keyUnit },
  curves: D.machines.map((machine, m) => { const points = D.points.filter(p => p.machine === m && p.figures[f] !== null); return { name: machine, x: points.map(p => p.values[k]), y: points.map(p => p.figures[f]), labels: points.map(p => "sample " + p.sample) }; }).filter(({ x }) => x.length),
}).element; };
const draw = which => list.replaceChildren(...shown.flatMap(figure => D.keys.map((_, k) => k).filter(k => which === "all" || +which === k).map(k => plot(figure, k))));
// A phone shows one number at a time, as a study of many numbers does.
const first = D.keys.length > MOST_KEYS || matchMedia("(max-width: 700px)").matches ? "0" : "all";
const over = select("Number to draw over", [["all", "all numbers"], ...D.keys.map((key, k) => [String(k), key])], draw);
over.value = first;
draw(first);
show(fileName(D.file),
  heading(fileName(D.file), `${count(S.samples)} samples` + (D.points.length + S.failed < S.samples ? `, ${count(D.points.length)} of them drawn` : ""), S.failed ? S.failed + " without figures" : "all have figures", { isGood: !S.failed, title: D.file }),
  S.failed > 0 && alertCard(`${count(S.failed)} of ${count(S.samples)} samples have no figures`, [["The first", S.first_failure ?? "unknown"], ["What to do", "the table of the study says why in each line; leave such values out of the ranges"]]),
  card("Figures, and the rank correlation of each with each number", note("Rank correlation after Spearman: 1 if a figure always grows with the number, \u22121 if it always falls, 0 if neither."), table(["Figure", "Least", "Median", "Greatest", ...D.keys], rows)),
  make("section", { className: "card panel", ariaLabel: "Samples" }, make("div", { className: "bar" }, make("h2", { textContent: "Samples" }), make("span", { className: "grow" }), make("label", {}, "over", over)),
    same.length ? note("The same in all samples: " + same.map(({ name, range: [v] }) => `${name} ${valueText(v)}`).join(", ") + ".") : "", list));
