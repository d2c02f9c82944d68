// Curves: position, speed, acceleration and step rates of any window of time, from the moves' three phases.
//
// A bin holds the least and the greatest value in it, so no peak is lost however long the window is.

/** Calls `each` with the parts of moves in a window: move, begin and end in s, way and speed; false if it was given up. */
async function eachPart(moves, from, to, isWanted, each) {
  let rest = performance.now();
  for (let i = moves.indexAt(from); i < moves.n && moves.begin[i] < to; i++) {
    if (i % 1024 === 0 && performance.now() - rest > 12) { await breathe(); rest = performance.now(); if (!isWanted()) return false; }
    const begin = moves.begin[i], length = moves.length(i), planned = moves.along(i, moves.duration(i))[0];
    let t = 0;
    for (const [s, v0, v1] of [[moves.up[i], moves.entry[i], moves.top[i]], [moves.flat[i], moves.top[i], moves.top[i]], [moves.down[i], moves.top[i], moves.exit[i]]]) {
      if (s > 0 && begin + t + s > from && begin + t < to) each(i, begin + t, begin + t + s, moves.along(i, t)[0], v0, v1, length, planned);
      t += s;
    }
  }
  return true;
}
/** Where the axes go in a move of unit length, x, y, z, and mm of filament. */
function direction(moves, i, length) {
  const p = moves.points, k = 4 * i;
  return length > 0 ? [(p[k + 4] - p[k]) / length, (p[k + 5] - p[k + 1]) / length, (p[k + 6] - p[k + 2]) / length, moves.e[i] / length] : [0, 0, 0, Math.sign(moves.e[i])];
}

class Bins {
  constructor(n, names) {
    this.n = n;
    this.curves = Object.fromEntries(names.map(name => [name, { low: new Float64Array(n).fill(Infinity), high: new Float64Array(n).fill(-Infinity) }]));
  }
  put(name, bin, a, b) {
    const curve = this.curves[name];
    if (a > b) [a, b] = [b, a];
    if (a < curve.low[bin]) curve.low[bin] = a;
    if (b > curve.high[bin]) curve.high[bin] = b;
  }
}
/** Curves of a window, in `n` bins; null if they are no longer wanted. */
async function curvesOf(moves, motors, from, to, n, isWanted) {
  const width = (to - from) / n, bins = new Bins(n, ["x", "y", "z", "v", "vx", "vy", "vz", "a", "ax", "ay", "flow", ...motors.map(m => "m:" + m.name)]);
  const rest = moves.n ? moves.place(moves.indexAt(from), 0) : [0, 0, 0];
  const isDone = await eachPart(moves, from, to, isWanted, (i, t0, t1, way, v0, v1, length, planned) => {
    const u = direction(moves, i, length), [x, y, z] = moves.at(i), a = (v1 - v0) / (t1 - t0), times = planned > 0 && length > 0 ? length / planned : 1;
    const area = moves.area * u[3];
    for (let b = clamp(Math.floor((t0 - from) / width), 0, n - 1), last = clamp(Math.floor((t1 - from) / width), 0, n - 1); b <= last; b++) {
      const s0 = Math.max(t0, from + b * width) - t0, s1 = Math.min(t1, from + (b + 1) * width) - t0;
      if (s1 < s0) continue;
      const p = v0 + a * s0, q = v0 + a * s1, wp = (way + (v0 + p) / 2 * s0) * times, wq = (way + (v0 + q) / 2 * s1) * times;
      bins.put("x", b, x + u[0] * wp, x + u[0] * wq); bins.put("y", b, y + u[1] * wp, y + u[1] * wq); bins.put("z", b, z + u[2] * wp, z + u[2] * wq);
      const is = length > 0 ? 1 : 0;
      bins.put("v", b, is * p, is * q); bins.put("a", b, is * a, is * a);
      bins.put("vx", b, u[0] * p, u[0] * q); bins.put("vy", b, u[1] * p, u[1] * q); bins.put("vz", b, u[2] * p, u[2] * q);
      bins.put("ax", b, u[0] * a, u[0] * a); bins.put("ay", b, u[1] * a, u[1] * a);
      bins.put("flow", b, is * area * p, is * area * q);
      for (const m of motors) {
        const k = Math.abs(m.steps_per_mm.reduce((sum, row, axis) => sum + row * u[axis], 0));
        bins.put("m:" + m.name, b, k * p, k * q);
      }
    }
  });
  if (!isDone) return null;
  // Nothing moves where there is no move: places stay, and the rest is 0.
  const places = { x: 0, y: 1, z: 2 };
  for (const [name, { low, high }] of Object.entries(bins.curves)) {
    let last = name in places ? rest[places[name]] : 0;
    for (let b = 0; b < n; b++) {
      if (low[b] > high[b]) low[b] = high[b] = name in places ? last : 0;
      else if (name in places) last = high[b];
    }
  }
  const time = new Float64Array(n);
  for (let b = 0; b < n; b++) time[b] = from + (b + 0.5) * width;
  return { time, curves: bins.curves };
}

/** Commanded place of an axis at a time, in a window that `first` is the first move of. */
function placeAt(moves, axis, t) {
  const i = moves.indexAt(t), p = moves.points[4 * i + axis], q = moves.points[4 * i + 4 + axis];
  return p + (q - p) * moves.share(i, t);
}
/**
 * Acceleration of an axis before and after its shapers, in mm/s^2 at `n` times. The shaped one is late by the taps;
 * `since` has the taps by the time from which they count.
 */
function shapedOf(moves, axis, since, from, to, n) {
  const width = (to - from) / n, h = Math.max(width / 2, 0.001), shaped = new Float64Array(n), plain = new Float64Array(n), time = new Float64Array(n);
  let taps = [[0, 1]], next = 0;
  const place = t => placeAt(moves, axis, Math.max(t, 0)), late = t => taps.reduce((sum, [s, share]) => sum + share * place(t - s), 0);
  const bend = (f, t) => (f(t + h) - 2 * f(t) + f(t - h)) / (h * h);
  // Places near 100 mm have 14 digits, and h is 1 ms at least: below 1e-7 mm/s^2 is only their rounding.
  const told = v => Math.round(v * 1000) / 1000;
  for (let b = 0; b < n; b++) {
    const t = time[b] = from + (b + 0.5) * width;
    while (next < since.length && since[next].time_s <= t) taps = since[next++].taps;
    plain[b] = told(bend(place, t)); shaped[b] = told(bend(late, t));
  }
  return { time, plain, shaped };
}
