// Compare: a second report over the first, where they differ first, and the time saved by layer.

/** The first move that differs, by `isSame`; -1 if none does. */
function firstDifference(a, b, isSame) {
  const n = Math.min(a.n, b.n);
  for (let i = 0; i < n; i++) if (!isSame(i)) return i;
  return a.n === b.n ? -1 : n;
}
const differs = (u, v, by) => Math.abs(u - v) > by;

/** A value of a key as text, without the digits that its rounding left. */
const valueOfKey = v => typeof v === "number" ? String(+v.toPrecision(9)) : typeof v === "string" ? v : JSON.stringify(v ?? undefined) ?? "\u2013";

/** Keys that two tables have with other values. A list is one value. */
function otherKeys(a, b, path = "", found = []) {
  const isTable = v => v && typeof v === "object" && !Array.isArray(v);
  if (isTable(a) && isTable(b)) for (const key of new Set([...Object.keys(a), ...Object.keys(b)])) otherKeys(a[key], b[key], path ? path + "." + key : key, found);
  else if (JSON.stringify(a) !== JSON.stringify(b)) found.push([path, ...[a, b].map(valueOfKey)]);
  return found;
}

/** Heights within this many mm are one layer: they are counted in steps. */
const SAME_HEIGHT_MM = 0.02;
/** Layers of two records by their height: seconds in either, and the number of the layer in the first. */
function layersOfBoth(a, b) {
  const rows = [];
  for (let i = 0, k = 0; i < a.length || k < b.length;) {
    const gap = i >= a.length ? Infinity : k >= b.length ? -Infinity : a[i].height_mm - b[k].height_mm;
    const [isFirst, isSecond] = [gap <= SAME_HEIGHT_MM, gap >= -SAME_HEIGHT_MM];
    rows.push({ height: (isFirst ? a[i] : b[k]).height_mm, first: isFirst ? a[i].seconds : 0, second: isSecond ? b[k].seconds : 0, layer: isFirst ? i : null });
    i += isFirst; k += isSecond;
  }
  return rows;
}

/** The first line in which two texts of whole lines differ, from 1; 0 if none does. */
async function firstOtherLine(...texts) {
  const parts = texts.map(blobs => inOrder(blobs)), rest = ["", ""], decoder = new TextDecoder();
  for (let line = 1; ;) {
    for (const k of [0, 1]) if (rest[k] === "") { const { value, done } = await parts[k].next(); rest[k] = done ? null : decoder.decode(value); }
    const [a, b] = rest;
    if (a === null || b === null) return a === b ? 0 : line;
    const n = Math.min(a.length, b.length), isSame = a.slice(0, n) === b.slice(0, n);
    for (let i = 0; i < n && (isSame || a[i] === b[i]); i++) line += a[i] === "\n";
    if (!isSame) return line;
    for (const k of [0, 1]) rest[k] = rest[k].slice(n);
    await breathe();
  }
}
/** What is said if two records are not of one file, whatever its name is; null if they are, as far as is known. */
async function otherFile(first, second) {
  const name = ({ data }) => data.summary.file.split("/").pop(), lines = ({ data }) => (data.gcode_chunks ?? []).reduce((sum, [, n]) => sum + n, 0);
  const isKnown = first.gcode.length > 0 && second.gcode.length > 0, from = isKnown ? await firstOtherLine(first.gcode, second.gcode) : 0;
  if (isKnown ? !from : name(first) === name(second)) return null;
  const of = one => name(one) + (isKnown ? ` (${count(lines(one))} lines)` : "");
  return `Two files: this report shows ${of(first)}, the second one ${of(second)}.` + (from ? ` They differ from line ${count(from)} on.` : "") + " So a difference may come from the files.";
}

/** What a text is that is no report of a print. */
function otherPage(text) {
  if (!/^\s*<(!doctype html|html)/i.test(text)) return "is no page: choose a report that `corehbot run --report` wrote";
  const isOurs = /<title>corehbot/i.test(text.slice(0, 1000));
  return isOurs ? "is another page of corehbot, or one of an older version: choose the report of a print (`corehbot run --report`)" : "is a page of something else: choose a report that `corehbot run --report` wrote";
}

/** Which run takes longer, and by how much of the first one's `time`. */
function timeSaved(time, saved) {
  if (saved === 0) return "Both take the same time. ";
  const by = Math.abs(saved), share = time > 0 ? ` (${(100 * by / time).toFixed(1)} %)` : "";
  return `The second run takes ${by < 60 ? clock(by) : by.toFixed(1) + " s"} ${saved > 0 ? "less" : "more"}${share}. `;
}

function compareCard(record, stage, player) {
  const result = make("div", { className: "panel flat" }), file = make("input", { type: "file", accept: ".html,.htm", ariaLabel: "Second report" });
  const status = make("output", { role: "status" });
  const choose = make("label", { className: "drop" }, "Choose or drop a second report of the same file: other settings, or another version. ", file);
  const section = card("Compare with another run", choose, status, result);
  async function take(text, name) {
    status.textContent = "reading " + name;
    await breathe();
    const found = recordOfText(text);
    if (!found) { status.textContent = `${name} ${otherPage(text)}`; return; }
    try {
      const second = await loadRecord(found.data, found.streams, share => { status.textContent = `reading ${name}: ${(100 * share).toFixed(0)} %`; });
      second.gcode = found.streams.gcode;
      const warning = await otherFile(record, second);
      status.textContent = "";
      show(second, name, warning);
    } catch (error) { status.textContent = `${name} cannot be read: ${error.message}`; }
  }
  function show(second, name, warning) {
    if (stage.second) stage.lines.remove(stage.second.body);
    stage.second = { record: second, body: stage.lines.add(second.moves, OKABE_ITO.vermilion) };
    stage.redraw();
    const a = record.moves, b = second.moves;
    const isPlace = i => [0, 1, 2, 4, 5, 6].every(k => !differs(a.points[4 * i + k], b.points[4 * i + k], 0.002)) && !differs(a.e[i], b.e[i], 0.002);
    const path = firstDifference(a, b, isPlace), speed = firstDifference(a, b, i => isPlace(i) && !differs(a.top[i], b.top[i], 0.05) && !differs(a.entry[i], b.entry[i], 0.05) && !differs(a.exit[i], b.exit[i], 0.05));
    const jump = i => {
      if (i < 0) return "none";
      if (!a.n) return "this report has no moves";
      const at = Math.min(i, a.n - 1), go = make("button", { type: "button", textContent: `line ${count(a.line[at])}, move ${count(a.made(i + 1))}` });
      go.onclick = () => { player.stop(); player.setMove(at + 1); stage.element.scrollIntoView({ block: "nearest" }); };
      return go;
    };
    const A = record.data, B = second.data, time = data => data.time.total, saved = time(A) - time(B), whole = [record, second].every(({ data, fault }) => !data.summary.failure && !fault), ends = [record, second].map(ending);
    const part = of => [A, B].map(data => clock(of(data)));
    const rows = [
      ["File", A.summary.file, B.summary.file], ["Machine", A.summary.machine, B.summary.machine], ["Ended", ...ends.map(({ words }) => words)], ["Time", ...part(time)], ["Motion", ...part(data => data.summary.motion_time_s)], ["Heat", ...part(data => data.time.heat)], ["Waits", ...part(data => data.time.waits)],
      ["Before the first layer", clock(A.before_layers.seconds), clock(B.before_layers.seconds)], ["After the last one", clock(A.after_layers.seconds), clock(B.after_layers.seconds)],
      ["Moves", count(a.made(a.n)), count(b.made(b.n))], ["Greatest speed, mm/s", A.summary.peak_speed_mm_s.toFixed(1), B.summary.peak_speed_mm_s.toFixed(1)], ["Filament, m", ((A.filament?.mm ?? 0) / 1000).toFixed(2), ((B.filament?.mm ?? 0) / 1000).toFixed(2)], ["Trace SHA-256", A.summary.trace_sha256.slice(0, 12) + "\u2026", B.summary.trace_sha256.slice(0, 12) + "\u2026"],
    ];
    const sides = select("What is drawn", [["both", "both paths"], ["first", "this report"], ["second", "the second one"]], side => { stage.sides = side; stage.redraw(); });
    stage.sides = "both";
    const end = make("button", { type: "button", textContent: "End the comparison" });
    end.onclick = () => { stage.lines.remove(stage.second.body); stage.second = null; stage.sides = "both"; result.replaceChildren(); stage.redraw(); };
    // Reports of earlier versions have a part of the settings, by other names.
    const keys = A.settings && B.settings ? otherKeys(A.settings, B.settings) : otherKeys(A.machine ?? {}, B.machine ?? {});
    result.replaceChildren(
      ...(warning ? [make("p", { className: "warning", role: "alert", textContent: warning })] : []),
      make("div", { className: "bar" }, make("span", { className: "legend" }, dot(OKABE_ITO.vermilion), name), sides, end),
      make("p", {}, whole ? timeSaved(time(A), saved) : "Times are not compared, because a run ended early. ", "First difference of the path: ", jump(path), ", of speeds: ", jump(speed), "."),
      table(["", "this report", "second report"], rows, "figures"),
      ...(keys.length ? [make("h3", { textContent: "Settings that differ" }), table(["Key of the machine file", "this report", "second report"], keys, "figures")] : []));
    if (!whole) return;
    const both = layersOfBoth(A.by_layer ?? [], B.by_layer ?? []), layers = both.length, gain = both.map(({ first, second }) => first - second);
    if (!layers) return;
    const say = n => `layer ${n}, Z ${both[n - 1].height.toFixed(2)} mm`;
    const chart = new Graph({ title: "Time saved by layer", unit: "s", x: { name: "layer", from: 0.5, to: layers + 0.5, say }, curves: [{ name: "time saved", x: gain.map((_, i) => i + 1), y: gain }], isBars: true, low: 0, height: 200 });
    chart.onPick = i => { const { layer } = both[i]; if (layer !== null) { player.single = true; player.setLayers(layer, layer); } };
    result.append(chart.element);
  }
  const open = async f => { if (f) await take(await f.text(), f.name); };
  file.onclick = () => { file.value = ""; };
  file.onchange = () => open(file.files[0]);
  section.addEventListener("dragover", e => { e.preventDefault(); section.classList.add("dropping"); });
  section.addEventListener("dragleave", () => section.classList.remove("dropping"));
  section.addEventListener("drop", e => { e.preventDefault(); section.classList.remove("dropping"); open(e.dataTransfer.files[0]); });
  return section;
}
