// Motion: the charts over motion time.

/** A function of a window whose last answer is kept, so that charts of one window share it. */
function shared(compute) {
  let key = "", answer = null;
  return (from, to, n, isWanted) => {
    const now = [from, to, n].join();
    if (now !== key || !answer) {
      key = now;
      answer = compute(from, to, n, isWanted);
      answer.then(found => { if (!found && key === now) answer = null; });
    }
    return answer;
  };
}
/** Bins of a fixed width as a chart's data. */
const fixed = (bin_s, curves, end) => {
  const time = curves[0].map((_, i) => Math.min((i + 0.5) * bin_s, end)), data = [time, ...curves.flatMap(values => [values, values])];
  return async (from, to, n) => {
    // A window of many bins shows the least and the greatest of each column.
    const a = Math.max(Math.floor(from / bin_s) - 1, 0), b = Math.min(Math.ceil(to / bin_s) + 1, time.length), every = Math.max(1, Math.floor((b - a) / n));
    if (every === 1) return data.map(values => values.slice(a, b));
    const columns = Math.ceil((b - a) / every), out = data.map(() => new Float64Array(columns));
    for (let c = 0; c < columns; c++) {
      const p = a + c * every, q = Math.min(p + every, b);
      out[0][c] = time[Math.floor((p + q) / 2)] ?? time[p];
      for (let k = 1; k < data.length; k++) { const part = data[k].slice(p, q); out[k][c] = (k % 2 ? Math.min : Math.max)(...part); }
    }
    return out;
  };
};

function motionCharts(record, player) {
  const { data, moves, motors, marks } = record, whole = [0, Math.max(moves.whole, 1e-3)], same = t => t;
  const skips = data.belt?.skips.map(skip => ({ time_s: skip.time_s, code: "skip" })) ?? [];
  const accidents = (data.belt?.accidents ?? []).filter(accident => accident.time_s !== null).map(accident => ({ time_s: accident.time_s, code: "accident" }));
  const charts = new Charts("Motion", whole, { toTime: same, fromTime: same, marks: [...marks, ...accidents, ...skips], player, note: "over motion time: drag for a window, click for a move" });
  const all = shared((from, to, n, isWanted) => curvesOf(moves, motors, from, to, n, isWanted));
  const of = (...names) => async (...window) => { const found = await all(...window); return found && [found.time, ...names.flatMap(name => [found.curves[name].low, found.curves[name].high])]; };
  charts.add({ title: "Speed of the tool", unit: "mm/s", names: ["speed"], data: of("v"), low: 0 });
  charts.add({ title: "Speed of the axes", unit: "mm/s", names: ["x", "y", "z"], data: of("vx", "vy", "vz") });
  charts.add({ title: "Acceleration", unit: "mm/s\u00b2", names: ["path", "x", "y"], data: of("a", "ax", "ay"), colours: [() => rgb(OKABE_ITO.grey)] });
  if (motors.length) charts.add({ title: "Step rate of the motors", unit: "steps/s", names: motors.map(m => m.name), data: of(...motors.map(m => "m:" + m.name)), low: 0 });
  charts.add({ title: "Position", unit: "mm", names: ["x", "y", "z"], data: of("x", "y", "z") });
  charts.add({ title: "Flow", unit: "mm\u00b3/s", names: ["flow"], data: of("flow") });
  data.machine.shaper.forEach((shaper, axis) => {
    const since = data.shapers.filter(change => change.axis === axis);
    if (!since.some(change => change.taps.length > 1)) return;
    const which = since.length === 1 ? `${shaper.type.toUpperCase()} at ${short(shaper.hz)} Hz` : "its shaper changes";
    charts.add({ title: `Acceleration of ${"xy"[axis]}, ${which}`, unit: "mm/s\u00b2", names: ["planned", "shaped"], colours: [() => rgb(OKABE_ITO.grey)], longest: 12,
      data: async (from, to, n) => {
        const { time, plain, shaped } = shapedOf(moves, axis, since, from, to, n);
        return [time, plain, plain, shaped, shaped];
      } });
  });
  if (data.belt) {
    const { bin_s, motors: torques, residual_um } = data.belt;
    charts.add({ title: "Torque margin of the motors", unit: "%", names: torques.map(m => m.name), data: fixed(bin_s, torques.map(m => m.share.map(share => 100 - share)), whole[1]), low: 0 });
    if (residual_um) charts.add({ title: "Residual of the belt", unit: "\u00b5m", names: ["residual"], data: fixed(bin_s, [residual_um], whole[1]), low: 0 });
  }
  return charts;
}
