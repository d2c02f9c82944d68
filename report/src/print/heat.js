// ---- Heat: over the time since the start, which goes on during waits, while motion time stands still
const H = D.heat, heatCharts = [];
/** When the tool got to a motion time. */
function clockOf(motion) {
  const i = after(H.motion.length, k => H.motion[k], motion - 1e-9);
  if (i >= H.motion.length) return H.end_s;
  const from = i ? H.motion[i - 1] : 0, share = H.motion[i] > from ? (motion - from) / (H.motion[i] - from) : 0;
  return Math.min((i + Math.max(share, 0)) * H.bin_s, H.end_s);
}
/** Motion time at a time since the start. */
function motionOf(time) {
  const i = Math.min(Math.max(Math.floor(time / H.bin_s), 0), H.motion.length - 1), from = i ? H.motion[i - 1] : 0;
  return from + (H.motion[i] - from) * Math.min(Math.max(time / H.bin_s - i, 0), 1);
}
/** Where the cursor was put into a wait. */
let heatNow = null;

/** Calls `each` with the left edge in px and the bins of every column that has any. */
function heatColumns(w, end, px, width, each) {
  const bins = H.motion.length, most = Math.max(1, Math.min(bins, Math.floor((w - LEFT - 4) / width)));
  for (let c = 0; c < most; c++) {
    const a = Math.floor(c * bins / most), b = Math.max(a + 1, Math.floor((c + 1) * bins / most));
    each(px(Math.min((a + b) / 2 * H.bin_s, end)), a, b);
  }
}
const most = (values, a, b) => { let m = -Infinity; for (let i = a; i < b; i++) if (values[i] !== null) m = Math.max(m, values[i]); return m; };
const least = (values, a, b) => { let m = Infinity; for (let i = a; i < b; i++) if (values[i] !== null) m = Math.min(m, values[i]); return m; };
const mean = (values, a, b) => { let s = 0; for (let i = a; i < b; i++) s += values[i]; return s / (b - a); };

/** Between the least and the greatest of every column. */
function drawTemperature({ g, w, px, py }, { low, high, target }, color) {
  const top = [], bottom = [];
  heatColumns(w, H.end_s, px, 1, (x, a, b) => { const v = most(high, a, b); if (v > -Infinity) { top.push([x, py(v)]); bottom.push([x, py(least(low, a, b))]); } });
  const shape = new Path2D();
  [...top, ...bottom.reverse()].forEach(([x, y], i) => i ? shape.lineTo(x, y) : shape.moveTo(x, y));
  g.strokeStyle = g.fillStyle = css(color); g.lineWidth = 1.4; g.lineJoin = "round";
  g.stroke(shape); g.fill(shape);
  const line = new Path2D();
  let last = 0;
  heatColumns(w, H.end_s, px, 1, (x, a, b) => {
    const v = most(target, a, b);
    if (v > 0) { if (last > 0) line.lineTo(x, py(last)); else line.moveTo(x, py(v)); line.lineTo(x, py(v)); }
    last = v;
  });
  g.setLineDash([5, 4]); g.lineWidth = 1; g.stroke(line); g.setLineDash([]);
}

/** The mean, over 2 s at least since relays switch for so long; a faint area up to the greatest. */
function drawDuty({ g, w, px, py }, { duty }, color, dash) {
  const line = new Path2D(), area = new Path2D(), back = [];
  const wide = Math.max(2, 2 / H.end_s * (w - LEFT));
  heatColumns(w, H.end_s, px, wide, (x, a, b) => {
    const y = py(mean(duty.mean, a, b));
    if (back.length) { line.lineTo(x, y); area.lineTo(x, y); } else { line.moveTo(x, y); area.moveTo(x, y); }
    back.push([x, py(most(duty.high, a, b))]);
  });
  back.reverse().forEach(([x, y]) => area.lineTo(x, y));
  g.fillStyle = g.strokeStyle = css(color); g.lineWidth = 1.4; g.lineJoin = "round";
  g.globalAlpha = .1; g.fill(area); g.globalAlpha = 1;
  g.setLineDash(dash); g.stroke(line); g.setLineDash([]);
}

/** Waits, each with its command where it is wanted and there is room for it. */
function drawWaits({ g, h, px }, isNamed) {
  let free = isNamed ? 0 : Infinity;
  g.textAlign = "left";
  for (const { command, begin, end } of H.waits) {
    g.fillStyle = css("--travel"); g.globalAlpha = .16;
    g.fillRect(px(begin), 6, Math.max(px(end) - px(begin), 1), h - BOTTOM - 6);
    g.globalAlpha = 1;
    const x = px(begin) + 4, width = g.measureText(command).width;
    if (x < free || x + width > px(H.end_s)) continue;
    g.fillStyle = css("--soft"); g.fillText(command, x, 17);
    free = x + width + 6;
  }
}

function drawHeat(motion, time) {
  if (!H) return;
  const t = time ?? (motion === undefined ? heatNow : null) ?? clockOf(motion ?? now);
  const isHover = motion !== undefined || time !== undefined;
  for (const { canvas, out, top, unit, curves, draw, say } of heatCharts) {
    const f = frame(canvas, top, H.end_s, unit);
    drawWaits(f, unit !== " %");
    for (const curve of curves) draw(f, curve, curve.color, curve.dash);
    cursor(f, t, isHover);
    const i = Math.min(Math.max(Math.floor(t / H.bin_s), 0), H.motion.length - 1);
    out.textContent = [clock(t), ...curves.map(c => say(c, i))].join(" \u00b7 ");
  }
  const wait = H.waits.find(wait => wait.begin <= t && t < wait.end);
  $("waitNow").textContent = wait ? wait.command : "";
}

if (H) {
  const colors = { hotend: "--hot", bed: "--cool", chamber: "--second" };
  const heaters = H.heaters.map(heater => ({ ...heater, color: colors[heater.name], dash: [] }));
  const fans = H.fans.map((fan, i) => ({ ...fan, color: ["--accent", "--soft", "--second"][i % 3], dash: [[6, 3], [2, 2]][Math.floor(i / 3)] }));
  const legend = (id, curves) => { for (const { name, color } of curves) {
    const item = Object.assign(document.createElement("span"), { textContent: name });
    item.prepend(Object.assign(document.createElement("i"), { className: "swatch", style: "background:var(" + color + ")" }));
    $(id).append(item);
  } };
  const highest = Math.max(50, ...heaters.flatMap(({ high, target }) => [most(high, 0, high.length), most(target, 0, target.length)]));
  heatCharts.push(
    { canvas: $("temps"), out: $("tempsNow"), top: highest * 1.18, unit: " \u00b0C", curves: heaters, draw: drawTemperature,
      say: ({ name, low, high, target }, i) => name + " " + (high[i] === null ? "?" : ((low[i] + high[i]) / 2).toFixed(1)) + (target[i] ? " / " + target[i] : "") + " \u00b0C" },
    { canvas: $("duties"), out: $("dutiesNow"), top: 106, unit: " %", curves: [...heaters, ...fans], draw: drawDuty,
      say: ({ name, duty }, i) => name.replace(/ \(.*/, "") + " " + duty.mean[i].toFixed(0) + " %" });
  legend("tempsLegend", heaters);
  $("tempsLegend").append(Object.assign(document.createElement("span"), { textContent: "dashed: target, grey: wait; time since the start" }));
  legend("dutiesLegend", [...heaters, ...fans]);
  for (const { canvas } of heatCharts) {
    const time = e => Math.min(Math.max((e.offsetX - LEFT) / (canvas.clientWidth - LEFT - 4), 0), 1) * H.end_s;
    const go = t => { setTime(motionOf(t)); heatNow = t; drawHeat(); };
    canvas.addEventListener("pointermove", e => { const t = time(e); if (e.buttons) go(t); else { charts.forEach(c => drawChart(c, motionOf(t))); drawMarks(motionOf(t)); drawHeat(undefined, t); } });
    canvas.addEventListener("pointerdown", e => { canvas.setPointerCapture(e.pointerId); stop(); go(time(e)); });
    canvas.addEventListener("pointerleave", () => { drawCharts(); drawMarks(now); });
  }
} else $("heat").remove();
