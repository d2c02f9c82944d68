// Heat: temperatures, targets, duties and waits over the time since the start, which goes on while nothing moves.

class Heat {
  constructor(data) { this.heat = data.heat; }
  /** When the tool got to a motion time. */
  clockOf(motion) {
    const H = this.heat;
    if (!H) return motion;
    const i = after(H.motion.length, k => H.motion[k], motion - 1e-9);
    // After the last motion the print may go on waiting.
    if (i >= H.motion.length || motion >= H.motion[H.motion.length - 1] - 1e-3) return H.end_s;
    const from = i ? H.motion[i - 1] : 0, share = H.motion[i] > from ? (motion - from) / (H.motion[i] - from) : 0;
    return Math.min((i + Math.max(share, 0)) * H.bin_s, H.end_s);
  }
  /** Motion time at a time since the start. */
  motionOf(time) {
    const H = this.heat, i = clamp(Math.floor(time / H.bin_s), 0, H.motion.length - 1), from = i ? H.motion[i - 1] : 0;
    return from + (H.motion[i] - from) * clamp(time / H.bin_s - i, 0, 1);
  }
  bin(motion) { return clamp(Math.floor(this.clockOf(motion) / this.heat.bin_s), 0, this.heat.motion.length - 1); }
}

function heatCharts(record, player) {
  const { data, heat } = record, H = data.heat;
  if (!H || !H.motion.length) return null;
  const marks = record.marks.map(mark => ({ ...mark, time_s: mark.since_start_s }));
  const waits = H.waits.map(({ command, begin, end }) => ({ begin, end, text: command }));
  const charts = new Charts("Heat", [0, H.end_s], { toTime: t => heat.motionOf(t), fromTime: t => heat.clockOf(t), marks, waits, player, note: "over the time since the start; grey: a command waits; dashed: target" });
  const time = H.motion.map((_, i) => Math.min((i + 0.5) * H.bin_s, H.end_s)), targets = H.heaters.map(({ target }) => target.map(t => t || null));
  const none = H.heaters.flatMap(({ low, high }, k) => [low, high, targets[k], targets[k]]);
  charts.add({ title: "Temperatures", unit: "\u00b0C", names: H.heaters.flatMap(h => [h.name, "target"]), colours: H.heaters.flatMap((_, k) => [() => curveColour(k + 1), () => curveColour(k + 1)]), dashes: H.heaters.flatMap(() => [undefined, [5, 4]]), data: async () => [time, ...none], isTall: true, height: 220, low: 20 });
  const duties = [...H.heaters, ...H.fans];
  const smooth = values => {
    // Relays switch for seconds: the mean over 2 s says more.
    const half = Math.round(1 / H.bin_s);
    return half < 1 ? values : values.map((_, i) => { const part = values.slice(Math.max(i - half, 0), i + half + 1); return part.reduce((a, b) => a + b, 0) / part.length; });
  };
  const curves = duties.flatMap(({ duty }) => { const mean = smooth(duty.mean); return [mean, mean]; });
  charts.add({ title: "Duties of heaters and fans", unit: "%", names: duties.map(d => d.name), colours: duties.map((_, k) => () => curveColour(k + 1)), data: async () => [time, ...curves], height: 220, low: 0 });
  return charts;
}
