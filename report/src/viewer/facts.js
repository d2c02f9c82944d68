// Facts: what the print was, in numbers and tables; a failure comes first.

/** How a print ended: in a few words, and whether nothing was wrong. */
function ending({ data, fault }) {
  const { summary: S } = data, skips = S.belt?.skips.length ?? 0;
  if (!S.ok) return { words: S.failure || fault ? "failed" : S.violations_total + " violations", isGood: false };
  return skips ? { words: `${count(skips)} ${skips === 1 ? "skip" : "skips"} of motors`, isGood: false } : { words: "done, every step sound", isGood: true };
}

/** What skips have done to the tool; nothing if no motor skipped. */
function skipRows({ data }) {
  const { belt } = data.summary;
  if (!belt?.skips.length) return [];
  const where = belt.off_mm === null ? "not known, as it was not homed" : `${belt.off_mm.toFixed(3)} mm off in the end, ${belt.largest_off_mm.toFixed(3)} mm at most`;
  return [["The tool", where], ["First skip", data.belt.skips[0].text],
    ["What to do", "The firmware made every step, but motors did not follow. The torque margin below shows where it was used up: print with less acceleration or speed there, or give the motors more current. Remarks list all skips."]];
}

function header(record) {
  const { summary: S } = record.data, name = S.file.split("/").pop(), { words: badge, isGood } = ending(record);
  const F = record.data.filament, filament = F.mm > 0 ? `, ${(F.mm / 1000).toFixed(2)} m of filament, ${F.g.toFixed(F.g < 10 ? 2 : 1)} g` : "";
  return heading(name, `on ${S.machine}: ${clock(record.data.time.total)}${filament}`, badge, { isGood, title: S.file });
}

/** What happened, when, what to do, and where more of it is written. */
function faultCard(record, player) {
  const { data, fault } = record, S = data.summary;
  const skips = skipRows(record);
  if (S.ok && !fault && !skips.length) return "";
  const lines = [];
  const row = (...line) => lines.push(line);
  const title = fault ? (fault.code ? fault.code + ": " : "") + fault.text : S.failure ?? (S.ok ? ending(record).words : S.violations_total + " violations of the machine's limits");
  if (fault) {
    const go = make("button", { type: "button", textContent: "Show the place" });
    go.onclick = () => { player.stop(); player.setTime(fault.motion_s); };
    go.hidden = !record.moves.n;
    // Moves are taken in advance: the answer is to a later line than the one that the tool is in.
    const { moves } = record, line = moves.n && /^G[0-3]\b/.test(fault.command) ? moves.line[moves.indexAt(fault.motion_s)] : 0;
    const own = line && line !== fault.line ? `; the tool was in line ${count(line)} ` : "";
    row("When", `${clock(fault.time_s)} after the start, at ${clock(fault.motion_s)} of motion` + (fault.line ? `, line ${count(fault.line)}: ` : " "), ...(fault.command ? [make("code", { textContent: fault.command }), own || " "] : []), go);
  }
  if (fault?.cause) row("Cause", fault.cause);
  if (fault?.cure) row("What to do", fault.cure);
  const some = S.violations.slice(0, 5);
  if (some.length) row("Violations", remarkList(some), ...(S.violations_total > some.length ? [`and ${count(S.violations_total - some.length)} more`] : []));
  lines.push(...skips);
  const alert = alertCard(title, lines);
  if (fault && data.fault_page) alert.append(aboutFault(fault, data.fault_page));
  return alert;
}

/** The part of the documents about a fault, which a click opens at its row. */
function aboutFault(fault, text) {
  const [page] = fault.page.split("#");
  const isOwn = ([first]) => first === fault.code || !fault.code && first.startsWith("`") && fault.text.includes(first.slice(1, -1));
  const about = make("details", {}, make("summary", {}, "More: ", make("code", { textContent: fault.page })), documentPart(text, page, isOwn));
  about.ontoggle = () => { if (about.open) about.querySelector(".taken")?.scrollIntoView({ block: "nearest" }); };
  return about;
}

function tiles(record) {
  const { data } = record, S = data.summary, { filament: F, time: T } = data;
  const metre = mm => mm >= 10000 ? [(mm / 1000).toFixed(1), "m"] : [mm.toFixed(0), "mm"];
  const list = [
    [clock(T.total), "", `= motion ${clock(T.motion)} + heat ${clock(T.heat)} + waits ${clock(T.waits)}`],
    T.slicer && [clock(T.slicer), "", `the slicer's estimate; motion takes ${signedPercent(T.motion / T.slicer - 1)}`],
    F.mm > 0 && [...metre(F.mm), `filament of ${F.diameter_mm} mm, ${F.g.toFixed(F.g < 10 ? 2 : 1)} g at ${F.density_g_cm3} g/cm\u00b3${F.is_density_known === false ? ", the density of PLA" : ""}`],
    [...metre(S.path_mm), "path of the tool"],
    [count(S.moves), "", `moves of ${count(S.commands)} commands`],
    [S.peak_speed_mm_s.toFixed(0), "mm/s", "greatest speed, over 20 ms"],
    [(S.peak_event_rate_hz / 1000).toFixed(1), "kHz", `greatest step rate, of ${count(S.events)} steps`],
    [S.underruns, "", "underruns" + (S.look_ahead_low_water === null ? "" : ", \u2265 " + S.look_ahead_low_water + " moves ahead")],
  ];
  return tileRow(list);
}

const signedPercent = share => (share < 0 ? "\u2212" : "+") + Math.abs(100 * share).toFixed(0) + " %";

/** Filament in m, below one to the millimetre; pulled back it is negative. */
const metres = mm => (mm < 0 ? "\u2212" : "") + Math.abs(mm / 1000).toFixed(Math.abs(mm) < 1000 ? 3 : 2);

/** Time and filament by line type, and time by layer. */
function timeCards(record, player) {
  const { data } = record, cards = [], types = (data.by_type ?? []).filter(row => row.seconds > 0 || row.moves > 0).sort((a, b) => b.seconds - a.seconds);
  const whole = types.reduce((sum, row) => sum + row.seconds, 0) || 1, F = data.filament;
  const colours = typeColours(data.types), gram = mm => F && F.mm > 0 ? (F.g * mm / F.mm).toFixed(2) : "";
  if (types.length) {
    const rows = types.map(row => {
      const bar = make("i", { className: "share" }), type = data.types[row.type] ?? { name: "?" };
      bar.style.cssText = `width:${100 * row.seconds / whole}%;background:${rgb(colours[row.type] ?? ROLES.other)}`;
      return [type.name, clock(row.seconds), make("span", {}, (100 * row.seconds / whole).toFixed(1) + " %", bar), Math.abs(row.filament_mm) >= 0.5 ? metres(row.filament_mm) : "", row.filament_mm > 0 ? gram(row.filament_mm) : "", count(row.moves)];
    });
    cards.push(card("Time and filament by line type", table(["Line type", "Time", "Share of motion", "Filament, m", "g", "Moves"], rows, "figures shares")));
  }
  const layers = data.by_layer ?? [];
  if (layers.length > 1) {
    const say = n => `layer ${n}, Z ${layers[n - 1].height_mm.toFixed(2)} mm`;
    const chart = new Graph({ title: "Time by layer", unit: "s", x: { name: "layer", from: 0.5, to: layers.length + 0.5, say }, curves: [{ name: "time", x: layers.map((_, i) => i + 1), y: layers.map(layer => layer.seconds) }], isBars: true, low: 0, height: 200 });
    chart.onPick = i => { player.single = true; player.setLayers(i, i); };
    chart.place.ariaLabel += " A click or Enter shows the layer.";
    const box = make("section", { className: "card panel", ariaLabel: "Time by layer" }, chart.element, make("p", { className: "sub", textContent: `Before the layers ${clock(data.before_layers.seconds)}, after them ${clock(data.after_layers.seconds)}.` }));
    cards.push(box);
  }
  return cards.length ? make("section", { className: cards.length > 1 ? "pair" : "" }, ...cards) : "";
}

/** Motors, remarks, answers, and the hash of the trace. */
function endCards(record) {
  const { data } = record, S = data.summary;
  const motors = table(["Motor", "Drives", "Steps", "Net steps"], data.motors.map(m => [m.name, m.drives, count(m.steps), count(m.net)]), "figures");
  const remarks = [...S.violations, ...S.warnings, ...S.pauses, ...(data.belt?.accidents.map(accident => "accident " + accident.text) ?? []), ...(data.belt?.skips.map(skip => "skipped: " + skip.text) ?? [])];
  const list = remarks.length ? remarkList(remarks) : make("span", { className: "sub", textContent: S.ok ? "None: limits kept, no step strains the belt, end position exact." : "None." });
  const answers = S.answers.map(answer => [(answer.line ? count(answer.line) + ": " : "") + answer.command, ...answer.replies].join("\n"));
  const answered = answers.length ? [make("h2", { textContent: "Answers" }), remarkList(answers, "Answers")] : [];
  return make("section", { className: "pair" }, card("Motors", motors), make("section", { className: "card panel" }, make("h2", { textContent: "Remarks" }), list, ...answered, make("h2", { textContent: "Trace SHA-256" }), make("div", { className: "hash", textContent: S.trace_sha256 })));
}

/** What the pointer says of a move. */
function teller(record) {
  const { data, moves, motors } = record;
  return i => {
    const type = data.types[moves.type[i]]?.name ?? "", v = x => short(x) + " mm/s", length = moves.length(i), rows = [];
    rows.push([moves.line[i] ? "Line " + count(moves.line[i]) : "Firmware's own", type]);
    rows.push(["Layer", `${moves.layer[i] + 1}, ${clock(moves.begin[i])}`]);
    rows.push(["Commanded", v(moves.feed[i])], ["Reached", v(moves.top[i])], ["Entry, exit", `${short(moves.entry[i])}, ${v(moves.exit[i])}`]);
    const isSlower = moves.top[i] < moves.feed[i] * 0.995, limit = data.limits[moves.limit[i]];
    // A move below its feed is not limited by it: the record does not know the reason.
    rows.push([isSlower ? "No faster because of" : "Limited by", isSlower && limit === "feed" ? "unknown" : limit]);
    rows.push(["Acceleration", short(moves.acceleration(i)) + " mm/s\u00b2"], ["Length, time", `${length.toFixed(3)} mm, ${(1000 * moves.duration(i)).toFixed(2)} ms`]);
    if (moves.e[i]) rows.push(["Filament", `${moves.e[i].toFixed(4)} mm, ${short(moves.flow(i))} mm\u00b3/s`]);
    if (moves.points[4 * i + 3] > 0) rows.push(["Line width", moves.points[4 * i + 3].toFixed(2) + " mm"]);
    if (motors.length) {
      const u = direction(moves, i, length), s = length > 0 ? length : Math.abs(moves.e[i]) > 0 ? 1 : 0;
      const rates = motors.map(m => [m.name, m.steps_per_mm.reduce((sum, row, axis) => sum + row * u[axis], 0) * (s ? moves.top[i] : 0)]).filter(([, rate]) => Math.abs(rate) >= 1);
      if (rates.length) rows.push(["Motors, steps/s", rates.map(([name, rate]) => `${name} ${rate < 0 ? "\u2212" : ""}${short(Math.abs(rate))}`).join("  ")]);
    }
    return rows;
  };
}
