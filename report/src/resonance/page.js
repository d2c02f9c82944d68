// The page of `corehbot resonance`: what an accelerometer measured.

const most = D.most_Hz, FREQUENCY = { name: "frequency", unit: "Hz", from: 0, to: most, say: v => v.toFixed(1) }, DENSITY = "(mm/s\u00b2)\u00b2/Hz", parts = [];
const even = (values, step) => ({ x: values.map((_, i) => i * step), y: values });
const within = ({ x, y }) => { const n = after(x.length, i => x[i], most); return { x: x.slice(0, n), y: y.slice(0, n) }; };
const spectrum = (name, values, step, more = {}) => ({ name, ...within(even(values, step)), ...more });
const marksOf = recordings => recordings.flatMap(r => r.fit ? r.fit.modes.map(m => ({ x: m.frequency_Hz, name: m.frequency_Hz.toFixed(1) + " Hz" })) : []);
const modes = recordings => table(["File", "Mode", "Damping", "Of the motion"], recordings.flatMap(r => r.fit ? r.fit.modes.map(m => [r.file, `${m.frequency_Hz.toFixed(2)} \u00b1 ${(2 * m.frequency_error_Hz).toFixed(2)} Hz`, m.damping_ratio.toFixed(4), percent(m.part)]) : []));
const remarks = recordings => { const all = recordings.flatMap(r => r.remarks.map(text => r.file + ": " + text)); return all.length ? [remarkList(all)] : []; };
const graph = options => new Graph({ height: 260, low: 0, ...options }).element;
const hertz = v => v.toFixed(1) + " Hz", tone = (light, dark = light) => () => rgb(OKABE_ITO[isDark() ? dark : light]);
const files = [...D.axes.flatMap(a => a.recordings), ...(D.belts ? D.belts.recordings : [])].map(r => r.file).concat(D.profile ? [D.profile.runs.length + " runs"] : []);

// ---- An axis
for (const A of D.axes) {
  const R = A.recordings, one = R.length === 1 ? R[0] : null, best = R.find(r => r.fit), T = A.tool, S = A.suggestion, K = A.klipper.suggestion, strongest = best?.fit.modes[0];
  parts.push(heading(A.axis ? "Axis " + A.axis : "Unknown axis", R.map(r => r.lasts_s === null ? "a spectrum" : `${r.lasts_s.toFixed(1)} s at ${r.rate_Hz.toFixed(0)} Hz`).join(", ")), tileRow([
    S && [percent(S.remaining_vibration, 1), "", "of the measured vibration is left"], S && [S.shaper, hertz(S.frequency_Hz), "suggested shaper"], S && [S.suggested_acceleration_mm_s2.toFixed(0), "mm/s\u00b2", "suggested acceleration"],
    strongest && [strongest.frequency_Hz.toFixed(2), "Hz", "strongest mode"], strongest && [strongest.damping_ratio.toFixed(3), "", "its damping ratio"],
    T?.suggested && [T.suggested.worst_wall.rms_um.toFixed(1), "\u00b5m RMS", "error of the wall, at worst"], T && [T.unshaped_wall.rms_um.toFixed(1), "\u00b5m RMS", "without a shaper"],
    K && !K.in_firmware && [K.shaper, hertz(K.frequency_Hz), "Klipper's choice"],
  ]));
  if (!S) parts.push(card("Line to set the shaper", note("No shaper is suggested: nothing rings within the sweep.")));
  else parts.push(card("Line to set the shaper", S.line ? copyLine(S.line) : note(A.axis ? "Shapers are set for x and y." : "No file name tells the axis: give --axis x or --axis y."), note(S.why.replace(/\bum\b/g, "\u00b5m").replace(/a\/w\^2/g, "a/\u03c9\u00b2"))));
  const step = one?.spectrum.step_Hz;
  const measured = one
    ? [...["x", "y", "z"].map((name, i) => spectrum(name, one.spectrum.xyz_mm2_s4_Hz[i], step, { isThin: true, colour: [tone("sky"), tone("green"), tone("grey")][i] })), spectrum("sum of all", one.spectrum.sum_mm2_s4_Hz, step, { colour: tone("blue", "yellow") })]
    : R.map(r => spectrum(r.file, r.spectrum.sum_mm2_s4_Hz, r.spectrum.step_Hz));
  const left = A.curves.map((c, i) => ({ name: c.name, ...even(c.left, most / (c.left.length - 1)), isRight: true, dash: true, colour: tone(["vermilion", "purple", "grey"][i]) }));
  parts.push(card("Spectrum", graph({ title: "Power spectral density of the acceleration" + (left.length ? ", and the part of it that shapers leave" : ""), unit: DENSITY, x: FREQUENCY, curves: [...measured, ...left], marks: marksOf(R), right: left.length ? "left by the shaper, of 1" : undefined }), ...remarks(R)));
  if (best) {
    const fits = R.filter(r => r.fit).flatMap((r, i) => [
      { name: (one ? "" : r.file + " ") + "measured", x: r.fit.frequencies_Hz, y: r.fit.measured, isThin: true, colour: () => curveColour(i) },
      { name: (one ? "" : r.file + " ") + "fitted", x: r.fit.frequencies_Hz, y: r.fit.fitted, dash: true, colour: () => curveColour(one ? 1 : i) }]);
    parts.push(card("Response", graph({ title: "Response of the tool to the sweep, and the fit", unit: "tool over command", x: { ...FREQUENCY, to: Math.max(...best.fit.frequencies_Hz) }, curves: fits, marks: marksOf(R) }), modes(R), note(`The fit is within ${best.fit.fit_error_dB.toFixed(1)} dB, RMS. ${best.fit.belt_damping_share_error < 0.25 ? `${percent(best.fit.belt_damping_share)} \u00b1 ${percent(2 * best.fit.belt_damping_share_error)} of the damping acts in the belts.` : ""}`)));
  }
  parts.push(...A.over_time.flatMap((seen, i) => !seen ? [] : card("Spectrogram" + (one ? "" : ": " + R[i].file), spectrogram(seen, R[i]), note("The bright slope is the sweep itself; flatter slopes are its harmonics. An upright line is something that runs by itself all the time, as a fan does."))));
  const klippers = A.klipper.shapers, ranked = T?.shapers;
  parts.push(make("section", { className: "pair" }, card("Klipper\u2019s ranking: how the shaper rounds the command",
    table(["Shaper", "Vibration", "Frequency", "Smoothing", "Score", "Acceleration"], klippers.map(s => [s.shaper, percent(s.remaining_vibration, 1), hertz(s.frequency_Hz), s.smoothing_mm.toFixed(3) + " mm", s.score.toFixed(4), s.suggested_acceleration_mm_s2.toFixed(0) + " mm/s\u00b2"]), "", i => K?.shaper === klippers[i].shaper),
    note("Klipper never suggests ZVD. This firmware does not have 3HUMP_EI. Smoothing is at 5000 mm/s\u00b2; the acceleration rounds by 0.12 mm.")),
  ...(T ? [card("Ranking by what the tool does",
    table(["Shaper", "Vibration", "Frequency", "Net rounding", "Error, RMS", "At worst", "Acceleration"], ranked.map(s => [s.shaper, percent(s.remaining_vibration, 1), hertz(s.frequency_Hz), s.net_rounding_a_per_w2.toFixed(2) + " a/\u03c9\u00b2", s.wall.rms_um.toFixed(1) + " \u00b5m", s.worst_wall.rms_um.toFixed(1) + " \u00b5m", s.suggested_acceleration_mm_s2.toFixed(0) + " mm/s\u00b2"]), "", i => T.nearest.shaper === ranked[i].shaper),
    note(`Walls of a 10 mm square and an 8 mm hole at ${T.print.acceleration_mm_s2.toFixed(0)} mm/s\u00b2, ${T.print.speed_mm_s.toFixed(0)} mm/s, corners at ${T.print.corner_speed_mm_s.toFixed(0)} mm/s. At most ${percent(T.most_ringing, 1)} of the ringing is left at the measured frequency. At worst: over ${percent(T.uncertainty, 1)} of uncertainty of it.`))] : [])));
}

// ---- Belt paths
if (D.belts) {
  const C = D.belts.comparison, R = D.belts.recordings, names = R.map((r, i) => "AB"[i] + ", " + r.file), step = R[0].spectrum.step_Hz;
  parts.push(heading("Belt paths", C.verdict), tileRow([
    [C.similarity_percent.toFixed(1), "%", "similarity"], C.frequency_difference_percent !== null && [C.frequency_difference_percent.toFixed(1), "%", "frequency of A against B"],
    C.stiffness_difference_percent !== null && [C.stiffness_difference_percent.toFixed(1), "%", "stiffness of A against B"], [C.level_difference_dB.toFixed(1), "dB", "vibration of A against B"],
  ]));
  // Both paths at the same frequencies: equal paths lie on the straight line.
  const [a, b] = R.map(r => r.spectrum.sum_mm2_s4_Hz.slice(0, Math.floor(most / r.spectrum.step_Hz) + 1)), n = Math.min(a.length, b.length), top = Math.max(...a, ...b), isSame = Math.abs(R[1].spectrum.step_Hz - step) < 1e-6;
  const cross = isSame && graph({ title: "Path B over path A", unit: DENSITY, x: { name: "density of A", unit: DENSITY, from: 0, to: top }, curves: [{ name: "each frequency", x: a.slice(0, n), y: b.slice(0, n), labels: a.slice(0, n).map((_, i) => hertz(i * step)) }], line: [[0, 0], [top, top]] });
  parts.push(make("section", { className: cross ? "pair" : "" },
    card("Spectra of both paths", graph({ title: "Power spectral density of the acceleration", unit: DENSITY, x: FREQUENCY, curves: R.map((r, i) => spectrum(names[i], r.spectrum.sum_mm2_s4_Hz, r.spectrum.step_Hz)), marks: marksOf(R) }), ...remarks(R)),
    ...(cross ? [card("Path against path", cross, note("Equal paths lie on the dashed line; a loop off it is a mode that one path has elsewhere, or louder."))] : [])));
  const hz = p => p ? hertz(p.frequency_Hz) : "\u2013";
  const peaks = [...C.pairs.map(([a, b]) => [hz(a), hz(b), hertz(a.frequency_Hz - b.frequency_Hz), (10 * Math.log10(a.density_mm2_s4_Hz / b.density_mm2_s4_Hz)).toFixed(1) + " dB"]), ...C.alone[0].map(p => [hz(p), "\u2013", "\u2013", "\u2013"]), ...C.alone[1].map(p => ["\u2013", hz(p), "\u2013", "\u2013"])];
  parts.push(make("section", { className: "pair" }, card("Peaks", table(["Path A", "Path B", "Difference", "Level"], peaks)), card("Modes", modes(R))));
}

// ---- Speeds and angles
if (D.profile) {
  const P = D.profile, all = P.runs.map(r => r.vibration_mm_s2), top = Math.max(...all), speeds = P.speeds.map(s => s.speed_mm_s), fastest = Math.max(...speeds);
  const quiet = P.quiet_mm_s.map(([a, b]) => a === b ? a.toFixed(0) : a.toFixed(0) + " to " + b.toFixed(0)).join(", ");
  parts.push(heading("Vibration by speed and angle", `${P.runs.length} runs`), tileRow([[quiet || "none", "mm/s", "quiet along every angle"], [P.loud_mm_s.map(v => v.toFixed(0)).join(", ") || "none", "mm/s", "loud"], [top.toFixed(0), "mm/s\u00b2", "greatest vibration, RMS"]]));
  const by = (name, key, k) => ({ name, x: speeds, y: P.speeds.map(s => s[key]), colour: () => curveColour(k) });
  const angles = P.angles_deg.map(angle => P.runs.filter(r => r.angle_deg === angle).map(r => r.vibration_mm_s2));
  parts.push(make("section", { className: "pair" },
    card("By speed", graph({ title: "Vibration by speed", unit: "mm/s\u00b2 RMS", x: { name: "speed", unit: "mm/s", from: speeds.length > 1 ? Math.min(...speeds) : 0 }, curves: [by("loudest angle", "max_mm_s2", 1), by("mean of all angles", "mean_mm_s2", 0)] })),
    ...(P.angles_deg.length > 1 ? [card("By angle", graph({ title: "Vibration by angle", unit: "mm/s\u00b2 RMS", x: { name: "angle", unit: "\u00b0" }, curves: [
      { name: "loudest speed", x: P.angles_deg, y: angles.map(v => Math.max(...v)), colour: () => curveColour(1) }, { name: "mean of all speeds", x: P.angles_deg, y: angles.map(v => v.reduce((a, b) => a + b, 0) / v.length), colour: () => curveColour(0) }] }))] : [])));
  parts.push(make("section", { className: "pair" }, card("Vibration by direction, with the speed from the middle outwards, mm/s", scaleOf("0", top.toFixed(0) + " mm/s\u00b2"), ...polar(P, speeds, fastest, top), note("Both ways along an angle are one run. Point at a part, or touch it, for its numbers.")),
    card("Vibration in mm/s\u00b2 RMS, by speed and angle", ...heatmap({ label: "Vibration by speed and angle", unit: "mm/s\u00b2", rows: speeds.map(v => v.toFixed(0)), columns: P.angles_deg.map(v => v.toFixed(0) + "\u00b0"), corner: "mm/s", digits: 0, range: [0, top],
      value: (i, j) => runAt(P, speeds[j], P.angles_deg[i])?.vibration_mm_s2, hint: (i, j) => { const run = runAt(P, speeds[j], P.angles_deg[i]); return told(run) + ", " + run.file; } }), note("10 to 500 Hz. Point at a cell, or touch it, for its loudest frequency."))));
  if (P.symmetry) mirrored(P.symmetry);
  if (P.motors.length) motors(P.motors);
}
/** How alike directions are that mirror each other. */
function mirrored(S) {
  const W = S.worst, signed = (v, digits) => (v < 0 ? "\u2212" : "+") + Math.abs(v).toFixed(digits), firsts = [...new Set(S.pairs.map(p => p.angles_deg[0]))];
  const curves = firsts.flatMap((angle, k) => { const own = S.pairs.filter(p => p.angles_deg[0] === angle); return [0, 1].map(side => ({ name: own[0].angles_deg[side].toFixed(0) + "\u00b0", x: own.map(p => p.speed_mm_s), y: own.map(p => p.vibration_mm_s2[side]), dash: side === 1, colour: () => curveColour(firsts.length > 1 ? k : side) })); });
  const [a, b] = W.angles_deg.map(v => v.toFixed(0) + "\u00b0");
  parts.push(heading("Symmetry", "directions that mirror each other, as 45\u00b0 and 135\u00b0"), tileRow([[S.symmetry_percent.toFixed(0), "%", "symmetry"], [signed(S.level_difference_dB, 1), "dB", `${firsts.map(v => v.toFixed(0) + "\u00b0").join(", ")} against the mirror image`], S.shape_percent !== null && [S.shape_percent.toFixed(0), "%", "likeness of the shapes over the speeds"]]),
    card("Both sides", graph({ title: "Vibration of mirrored directions", unit: "mm/s\u00b2 RMS", x: { name: "speed", unit: "mm/s" }, curves, marks: [{ x: W.speed_mm_s, name: "most apart" }] }),
      note(`The symmetry is the part of the vibration that both sides have in common. They are most apart at ${W.speed_mm_s.toFixed(0)} mm/s: ${W.vibration_mm_s2[0].toFixed(0)} mm/s\u00b2 along ${a}, ${W.vibration_mm_s2[1].toFixed(0)} along ${b}. Like shapes at different levels are unlike currents or motors; unlike shapes are unlike belts, pulleys or guides. The sensor\u2019s noise is on both sides and makes a calm machine look symmetric.`)));
}
/** What each group of motors does to the tool, by frequency. */
function motors(all) {
  const REPEATS = { electrical_turn: "electrical turns", half_turn: "half turns", full_step: "full steps" }, best = all.map(M => M.modes[0]);
  const range = (v, error, digits) => v.toFixed(digits) + " \u00b1 " + (2 * error).toFixed(digits), along = M => `${M.motors}, along ${M.angle_deg.toFixed(0)}\u00b0`;
  parts.push(heading("Motor frequency profile", "directions along which one group of motors turns and the others stand"), tileRow(all.flatMap((M, i) => best[i] ? [[best[i].frequency_Hz.toFixed(1), "Hz", "main resonance of " + M.motors], [best[i].damping_ratio.toFixed(3), "", "its damping ratio"]] : [])));
  parts.push(card("By frequency", graph({ title: "Power spectral density, mean of all speeds", unit: DENSITY, x: { name: "frequency", unit: "Hz", from: 0, say: v => v.toFixed(1) }, curves: all.map(M => ({ name: along(M), ...even(M.density_mm2_s4_Hz, M.step_Hz) })), marks: best.filter(Boolean).map(m => ({ x: m.frequency_Hz, name: hertz(m.frequency_Hz) })) }),
    note("Where the tool vibrates, whatever speed it comes from. It grows with the frequency by itself, so its highest peak need not be the main resonance. The comb is the distance of the speeds.")));
  parts.push(make("section", { className: "pair" }, ...all.map(M => card(along(M), ...(M.orders.length ? [graph({ title: "Motion of the tool by the motors\u2019 frequency", unit: "\u00b5m", x: { ...FREQUENCY, from: undefined, to: M.modes[0]?.frequency_Hz < most / 2 ? most : undefined }, marks: M.modes.map(m => ({ x: m.frequency_Hz, name: hertz(m.frequency_Hz) })),
    curves: M.orders.flatMap((o, k) => [{ name: REPEATS[o.repeats], x: o.frequencies_Hz, y: o.amplitudes_um, isThin: true, colour: () => curveColour(k) }, ...(o.fitted_um.length ? [{ name: "fitted, " + REPEATS[o.repeats], x: o.frequencies_Hz, y: o.fitted_um, dash: true, colour: () => curveColour(k) }] : [])]) })] : []),
    ...(M.modes.length ? [table(["Mode", "Damping ratio"], M.modes.map(m => [range(m.frequency_Hz, m.frequency_error_Hz, 2) + " Hz", range(m.damping_ratio, m.damping_ratio_error, 4)]))] : []),
    ...(M.orders.length ? [table(["Motors\u2019 error", "At most", "Without resonance"], M.orders.map(o => [REPEATS[o.repeats], Math.max(...o.amplitudes_um).toFixed(1) + " \u00b5m", o.slow_um === null ? "\u2013" : o.slow_um.toFixed(1) + " \u00b5m"]))] : []),
    ...(M.fit_error_dB !== null ? [note(`The fit is within ${M.fit_error_dB.toFixed(1)} dB, RMS.`)] : []), ...(M.remarks.length ? [remarkList(M.remarks)] : [])))));
}
/** Power over frequency and time. */
function spectrogram({ levels, step_s, first_s, step_Hz, range_dB }, { file }) {
  const DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/", LEFT = 54, BOTTOM = 34, TOP = 6, RIGHT = 16;
  const n = levels[0]?.length ?? 0, end = first_s + step_s * (levels.length - 0.5), canvas = make("canvas", { role: "img", ariaLabel: `Power over frequency, 0 to ${most} Hz, and time, 0 to ${end.toFixed(0)} s, ${file}` }), out = make("output", { textContent: "\u00a0" });
  const shareAt = (i, j) => DIGITS.indexOf(levels[j][i]) / 63;
  const box = () => ({ w: canvas.clientWidth - LEFT - RIGHT, h: canvas.clientHeight - TOP - BOTTOM });
  const draw = () => {
    const d = devicePixelRatio || 1, { w, h } = box();
    if (w <= 0 || !n) return;
    Object.assign(canvas, { width: canvas.clientWidth * d, height: canvas.clientHeight * d });
    const g = canvas.getContext("2d", { willReadFrequently: true }), image = make("canvas", { width: n, height: levels.length }), dots = image.getContext("2d", { willReadFrequently: true }), pixels = dots.createImageData(n, levels.length);
    // Time goes up.
    for (let j = 0; j < levels.length; j++) for (let i = 0; i < n; i++) pixels.data.set([...viridis(shareAt(i, j)), 255], 4 * ((levels.length - 1 - j) * n + i));
    dots.putImageData(pixels, 0, 0);
    g.setTransform(d, 0, 0, d, 0, 0);
    g.drawImage(image, LEFT, TOP, w * (n - 1) * step_Hz / most, h);
    g.font = "11px system-ui, sans-serif"; g.fillStyle = css("--soft");
    const hz = nice(most / (w < 500 ? 5 : 10)), s = nice(end / 4);
    g.textAlign = "center";
    for (let f = 0; f <= most; f += hz) g.fillText(f, LEFT + w * f / most, TOP + h + 14);
    g.fillText("frequency, Hz", LEFT + w / 2, TOP + h + 30);
    g.textAlign = "right";
    for (let t = 0; t <= end; t += s) g.fillText(+t.toFixed(3) + " s", LEFT - 6, TOP + h - h * t / end + 4);
  };
  const look = e => {
    const { w, h } = box(), i = Math.round((e.offsetX - LEFT) / w * most / step_Hz), j = Math.floor((1 - (e.offsetY - TOP) / h) * levels.length);
    out.textContent = levels[j]?.[i] ? `${hertz(i * step_Hz)} at ${(first_s + j * step_s).toFixed(1)} s: ${((shareAt(i, j) - 1) * range_dB).toFixed(0).replace("-", "\u2212")} dB of the greatest` : "\u00a0";
  };
  for (const name of ["pointermove", "pointerdown"]) canvas.addEventListener(name, look);
  canvas.addEventListener("pointerleave", () => { out.textContent = "\u00a0"; });
  onScheme(canvas, draw);
  new ResizeObserver(draw).observe(canvas);
  return make("div", { className: "chart" }, make("div", { className: "bar" }, scaleOf(`\u2212${range_dB} dB`, "0 dB"), out), make("div", { className: "spectrogram" }, canvas));
}
/** What is known of a run. */
function told(run) { return `${run.angle_deg.toFixed(0)}\u00b0, ${run.speed_mm_s.toFixed(0)} mm/s: ${run.vibration_mm_s2.toFixed(0)} mm/s\u00b2, loudest at ${run.loudest_Hz.toFixed(0)} Hz`; }
function runAt(P, speed, angle) { return P.runs.find(run => run.angle_deg === angle && run.speed_mm_s === speed); }
/** Each run is a part of a ring, and both ways along an angle are one. */
function polar(P, speeds, fastest, top) {
  const picture = makeSvg("svg", { class: "polar", viewBox: "-200 -172 400 344", role: "img", "aria-label": "Vibration by direction and speed" }), radius = v => 150 * v / fastest;
  const between = (list, i) => [i ? (list[i - 1] + list[i]) / 2 : null, i + 1 < list.length ? (list[i] + list[i + 1]) / 2 : null];
  const at = (r, deg) => (r * Math.cos(deg * Math.PI / 180)).toFixed(1) + " " + (-r * Math.sin(deg * Math.PI / 180)).toFixed(1);
  const draw = () => {
    picture.replaceChildren();
    const A = P.angles_deg.filter(a => a < 180);
    for (const run of P.runs) {
      const i = A.indexOf(run.angle_deg % 180), j = speeds.indexOf(run.speed_mm_s);
      if (i < 0) continue;
      const before = A.length > 1 ? (A[i] - A.at(i - 1) + 180) % 180 / 2 : 10, behind = A.length > 1 ? (A[(i + 1) % A.length] - A[i] + 180) % 180 / 2 : 10;
      const [inner, outer] = between(speeds, j), w = j ? speeds[j] - inner : outer === null ? speeds[j] / 10 : outer - speeds[j];
      const r0 = radius(Math.max(inner ?? speeds[j] - w, 0)), r1 = radius(Math.min(outer ?? speeds[j] + w, fastest * 1.05));
      for (const turn of [0, 180]) {
        const a = run.angle_deg + turn - Math.min(before, 22.5), b = run.angle_deg + turn + Math.min(behind, 22.5);
        picture.append(makeSvg("path", { d: `M${at(r0, a)}L${at(r1, a)}A${r1.toFixed(1)} ${r1.toFixed(1)} 0 0 0 ${at(r1, b)}L${at(r0, b)}A${r0.toFixed(1)} ${r0.toFixed(1)} 0 0 1 ${at(r0, a)}z`, fill: rgb(viridis(run.vibration_mm_s2 / top)), "data-says": told(run) }));
      }
    }
    for (const v of [fastest / 3, 2 * fastest / 3, fastest]) picture.append(makeSvg("circle", { r: radius(v).toFixed(1) }), makeSvg("text", { x: 2, y: -radius(v) - 2 }, v.toFixed(0)));
    picture.append(makeSvg("text", { x: 160, y: 4 }, "x"), makeSvg("text", { x: -14, y: -160, "text-anchor": "end" }, "y"));
  };
  draw(); onScheme(picture, draw);
  return [sayer(picture), picture];
}
show("Resonance", heading("Resonance", files.join(", ")), ...parts);
