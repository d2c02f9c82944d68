// The page of `twin run`: the tool's path with its error, curves over time, corners, motors, and the machine's resonance.

const R = D.report, end = Math.max(D.error.length * D.bin_s, 1e-3), slips = R.motors.reduce((sum, m) => sum + m.slips, 0);
const least = Math.min(...Object.values(R.tension_N).map(([a]) => a)), margin = Math.min(...R.motors.map(m => m.margin)), um = v => (1000 * v).toFixed(1), WORST = 12;

// ---- The path, coloured by error; the scale ends where 99 of 100 lines do
const STEPS = 48, { x: X, y: Y, error_um: E } = D.path;
const topE = Math.max(1, Float64Array.from(E).sort()[Math.floor(E.length * 0.99)] || 1);
const camera = new Camera(), canvas = make("canvas"), out = make("output", { textContent: "\u00a0" });
const stage = make("div", { className: "stage", tabIndex: 0, role: "img", ariaLabel: "Path of the tool, coloured by its error; arrow keys move it, + and \u2212 zoom, 0 fits. The corners below show the same places." }, canvas);
const times = make("input", { type: "range", min: 0, max: 300, value: 50 }), timesNow = make("output");
const sx = x => camera.toScreen([x, 0, 0])[0], sy = y => camera.toScreen([0, y, 0])[1];
const box = [[...[X, Y].map(v => bounds(v)[0]), 0], [...[X, Y].map(v => bounds(v)[1]), 0]];
const fit = () => { camera.fit(box); drawPath(); };
function drawPath() {
  const d = devicePixelRatio || 1, w = stage.clientWidth, h = stage.clientHeight, g = canvas.getContext("2d", { willReadFrequently: true });
  if (!w) return;
  const isFirst = camera.width === 1;
  Object.assign(camera, { width: w, height: h });
  if (isFirst) camera.fit(box);
  if (canvas.width !== Math.round(w * d) || canvas.height !== Math.round(h * d)) Object.assign(canvas, { width: Math.round(w * d), height: Math.round(h * d) });
  g.setTransform(d, 0, 0, d, 0, 0);
  g.clearRect(0, 0, w, h);
  drawGrid(g, camera, [D.reach_x, D.reach_y]);
  g.lineCap = g.lineJoin = "round";
  // The exaggerated way lies below, so that it hides no colour.
  const T = D.trail, k = times.value / 1000;
  timesNow.textContent = times.value + "\u00d7";
  if (k > 0 && T.x.length) {
    g.strokeStyle = curveColour(1); g.lineWidth = 1; g.beginPath();
    for (let i = 0; i < T.x.length; i++) g.lineTo(sx(T.x[i] + k * T.off_x_um[i]), sy(T.y[i] + k * T.off_y_um[i]));
    g.stroke();
  }
  g.lineWidth = 2;
  let last = -1;
  for (let i = 1; i < X.length; i++) {
    const key = Math.min(STEPS - 1, Math.floor(E[i] / topE * STEPS));
    if (key !== last) { if (last >= 0) g.stroke(); g.beginPath(); g.moveTo(sx(X[i - 1]), sy(Y[i - 1])); g.strokeStyle = rgb(viridis((last = key) / (STEPS - 1))); }
    g.lineTo(sx(X[i]), sy(Y[i]));
  }
  if (last >= 0) g.stroke();
  g.textAlign = "center";
  R.corners.slice(0, WORST).forEach((c, i) => {
    const [px, py] = [sx(c.x_mm), sy(c.y_mm)];
    g.fillStyle = css("--card"); g.strokeStyle = css("--bad"); g.lineWidth = 1.5;
    g.beginPath(); g.arc(px, py, 8, 0, 7); g.fill(); g.stroke();
    g.fillStyle = css("--ink"); g.fillText(i + 1, px, py + 4);
  });
}
/** Fingers and the mouse: one pans, two zoom; at rest the mouse reads the nearest line. */
function hands() {
  const fingers = new Map();
  const apart = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  const go = fn => { fn(); drawPath(); };
  stage.addEventListener("pointerdown", e => { fingers.set(e.pointerId, [e.offsetX, e.offsetY]); stage.setPointerCapture(e.pointerId); });
  stage.addEventListener("pointermove", e => {
    const from = fingers.get(e.pointerId), at = [e.offsetX, e.offsetY];
    if (!from) { read(...at); return; }
    const before = fingers.size === 2 ? apart() : 0;
    fingers.set(e.pointerId, at);
    go(() => { camera.pan((at[0] - from[0]) / fingers.size, (at[1] - from[1]) / fingers.size); if (before) { const [a, b] = [...fingers.values()]; camera.zoom(apart() / before, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2); } });
  });
  for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, e => fingers.delete(e.pointerId));
  stage.addEventListener("pointerleave", () => { out.textContent = "\u00a0"; });
  stage.addEventListener("wheel", e => { e.preventDefault(); go(() => camera.zoom(Math.exp(-e.deltaY * 0.0015), e.offsetX, e.offsetY)); }, { passive: false });
  stage.addEventListener("keydown", e => {
    const keys = { ArrowLeft: () => camera.pan(40, 0), ArrowRight: () => camera.pan(-40, 0), ArrowUp: () => camera.pan(0, 40), ArrowDown: () => camera.pan(0, -40), "+": () => camera.zoom(1.4), "=": () => camera.zoom(1.4), "-": () => camera.zoom(1 / 1.4), 0: fit };
    if (!keys[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault(); go(keys[e.key]);
  });
}
function read(px, py) {
  let best = 0, least = 400;
  for (let i = 1; i < X.length; i++) { const far = (sx(X[i]) - px) ** 2 + (sy(Y[i]) - py) ** 2; if (far < least) { least = far; best = i; } }
  out.textContent = best ? `X ${X[best].toFixed(2)} Y ${Y[best].toFixed(2)} mm: error ${E[best].toFixed(1)} \u00b5m` : "\u00a0";
}
function showCorner(c) {
  camera.scale = Math.min(camera.width, camera.height) / 12;
  camera.centre = [c.x_mm, c.y_mm, 0];
  drawPath();
  stage.scrollIntoView({ behavior: "smooth", block: "center" });
}
const zoom = by => () => { camera.zoom(by); drawPath(); };
const path = make("section", { className: "card panel view", ariaLabel: "Error of the tool along its path" },
  make("div", { className: "bar" }, make("h2", { textContent: "Error of the tool along its path" }), buttonGroup("Zoom", pushButton("\u2212", "Zoom out", zoom(0.7)), pushButton("+", "Zoom in", zoom(1 / 0.7)), pushButton("Fit", "Show the whole path", fit)), scaleOf("0", (E.some(e => e > topE) ? "\u2265 " : "") + topE.toFixed(0) + " \u00b5m"), out),
  stage, make("div", { className: "bar" }, make("label", { style: "flex: 1 1 260px" }, "Error exaggerated, in orange", times), timesNow));
times.oninput = drawPath;
hands();
onScheme(stage, drawPath);
new ResizeObserver(drawPath).observe(stage);

// ---- Curves over time
const bins = Array.from(D.error, (_, i) => +((i + 0.5) * D.bin_s).toFixed(6)), time = { name: "time", unit: "s", from: 0, to: end, say: v => v.toFixed(3) };
const chart = (title, unit, curves, low) => new Graph({ title, unit, x: time, curves, low, sync: "time" });
const band = ({ name, low, high }) => ({ name, x: bins, y: high, low }), line = ({ name, high }) => ({ name, x: bins, y: high });
const graphs = [
  chart("Error of the tool", "\u00b5m", [{ name: "error", x: bins, y: D.error.map(v => +(1000 * v).toFixed(2)) }], 0),
  chart("Tension of the spans", "N", D.spans.map(band)),
  chart("Torque of the motors", "mN m", D.torques.map(line), 0),
  chart("Torque of all motors on the frame, counter-clockwise", "mN m", [band(D.motors_torque)], 0),
  ...(D.frame.length ? [chart("Displacement of the frame", "\u00b5m", D.frame.map(line), 0)] : []),
];
for (const graph of graphs) graph.onZoom = window => graphs.forEach(other => { if (other !== graph && other.window !== window) { other.window = window; other.plot?.setData(other.data, true); } });
const curves = make("section", { className: "card panel", ariaLabel: "Over time" }, make("div", { className: "bar" }, make("h2", { textContent: "Over time" }), note("drag for a window, double click or All for the whole"), make("span", { className: "grow" }), pushButton("All", "The whole time", () => graphs.forEach(graph => { graph.window = null; graph.plot?.setData(graph.data, true); }))), make("div", { className: "charts" }, ...graphs.map(({ element }) => element)));

// ---- Tables
const worst = R.corners.slice(0, WORST).map((c, i) => [pushButton(`${i + 1}.  ${c.x_mm.toFixed(2)}, ${c.y_mm.toFixed(2)}`, "Show this corner", () => showCorner(c)), seconds(c.time_s), c.turn_deg.toFixed(0) + "\u00b0", mm(c.rounding_mm), mm(c.overshoot_mm), c.bisector_mm === null ? "\u2013" : mm(c.bisector_mm)]);
const corners = card("Worst corners", worst.length ? table(["Place, mm", "Time", "Turn", "Inside", "Outside", "Bisector"], worst) : note("None."),
  note("Bisector: where the tool crossed the line that halves the corner, inside positive." + (R.corners_unmatched ? ` ${R.corners_unmatched} more corners could not be matched: their lines are too short, or the tool was nowhere near.` : "")));
const types = (R.by_type || []).map(t => [t.name, clock(t.seconds), t.rms_um.toFixed(1), t.mostly_um.toFixed(1), pushButton(t.max_um.toFixed(1), "Show the place", () => showCorner(t))]);
const byType = types.length ? card("Error by type of line, \u00b5m", table(["Type", "Time", "RMS", "99.9 %", "Greatest"], types, "figures"), note("99.9 %: not exceeded for so much of the time.")) : null;
const motors = table(["Motor", "Greatest torque", "Left", "Slips"], R.motors.map(m => [m.motor, m.torque_max_mNm.toFixed(1) + " mN m", percent(m.margin), m.slips ? `${m.slips}, ${m.full_steps_off} full steps off` : "0"]), "figures");
const belt = table(["", ""], [...Object.entries(R.tension_N).map(([name, [a, b]]) => [`span ${name}`, `${a.toFixed(1)} to ${b.toFixed(1)} N`]), ["residual commanded", mm(R.commanded_residual_mm)], ["residual", mm(R.residual_mm)]], "figures");
const slipped = R.motors.filter(m => m.slips).map(m => `motor ${m.motor} ${m.slips} times, ${m.full_steps_off} full steps off`).join("; ");
show(fileName(D.file),
  heading(fileName(D.file), `on the belts of a ${D.machine}, ${R.model} model: ${clock(R.duration_s)}`, slips ? slips + " slips" : R.slack_events ? `slack ${R.slack_events} times` : "no slip, no slack", { isGood: !slips && !R.slack_events, title: D.file }),
  slips ? alertCard("A motor slipped", [["Which", slipped], ["What to do", "lower the acceleration or raise the current; ", make("code", { textContent: "corehbot twin limits" }), " says how far each goes"]])
    : R.slack_events ? alertCard("A span of the belt went slack", [["How often", `${R.slack_events} times; the least tension is ${least.toFixed(1)} N`], ["What to do", "tighten the belt or lower the acceleration; ", make("code", { textContent: "corehbot twin limits" }), " says how far"]]) : null,
  tileRow([
    [um(R.contour.max_mm), "\u00b5m", "greatest error"], [um(R.contour.rms_mm), "\u00b5m", "RMS error"], [um(R.contour.rounding_max_mm), "\u00b5m", "inside of corners"], [um(R.contour.overshoot_max_mm), "\u00b5m", "outside of corners"],
    [least.toFixed(1), "N", "least tension"], [percent(margin).split(" ")[0], "%", "torque left"], [R.yaw_torque_Nm.toFixed(2), "N m", "greatest yaw torque"], [(1000 * R.frame_torque_Nm).toFixed(1), "mN m", "greatest torque on the frame"],
    [R.times_real_time.toFixed(0), "\u00d7", "real time"],
  ]),
  path, byType, curves,
  make("section", { className: "pair" }, corners, make("section", { className: "card panel" }, make("h2", { textContent: "Motors" }), motors, make("h2", { textContent: "Belt" }), belt)),
  resonanceCards(D.resonance, "with idlers and rotors"));
