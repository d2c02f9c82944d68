// Moves: every planned move of a record in arrays, and the questions that they answer.

/** mm^2 of filament. */
const filamentArea = data => Math.PI / 4 * (data.filament?.diameter_mm ?? 1.75) ** 2;
const TEN_US = 1e-5;

class Moves {
  constructor(data, capacity) {
    this.data = data;
    this.n = 0;
    /** Places of what is no move: positions that were named anew. */
    this.renamed = [];
    const floats = () => new Float32Array(capacity);
    /** Begin in s, and the durations of acceleration, cruise and deceleration. */
    Object.assign(this, { begin: new Float64Array(capacity), up: floats(), flat: floats(), down: floats() });
    /** Entry, reached, exit and commanded speed in mm/s. */
    Object.assign(this, { entry: floats(), top: floats(), exit: floats(), feed: floats() });
    /** mm of filament. */
    this.e = floats();
    this.line = new Uint32Array(capacity);
    this.type = new Uint8Array(capacity);
    this.limit = new Uint8Array(capacity);
    this.layer = new Uint16Array(capacity);
    /** Places in mm where a move begins, and the width of its line; the place of the next move is its end. */
    this.points = new Float32Array(4 * (capacity + 1));
    this.isTravel = data.types.map(type => type.role === "travel");
    /** Runs of moves of one layer: first, end, layer. */
    this.runs = [];
  }
  at(i) { return [this.points[4 * i], this.points[4 * i + 1], this.points[4 * i + 2]]; }
  length(i) {
    const p = this.points, k = 4 * i;
    return Math.hypot(p[k + 4] - p[k], p[k + 5] - p[k + 1], p[k + 6] - p[k + 2]);
  }
  duration(i) { return this.up[i] + this.flat[i] + this.down[i]; }
  end(i) { return this.begin[i] + this.duration(i); }
  isPrinted(i) { return this.type[i] !== HIDDEN && !this.isTravel[this.type[i]]; }
  /** mm^3/s. */
  flow(i) { const s = this.duration(i); return s > 0 ? this.e[i] * this.area / s : 0; }
  acceleration(i) {
    const ramp = (from, to, s) => s > 0 ? Math.abs(to - from) / s : 0;
    return Math.max(ramp(this.entry[i], this.top[i], this.up[i]), ramp(this.top[i], this.exit[i], this.down[i]));
  }
  /** The move at a time: the first that ends after it. */
  indexAt(t) { return Math.min(after(this.n, i => this.end(i), t), Math.max(this.n - 1, 0)); }
  /** Way and speed in a move after `s` seconds of it. */
  along(i, s) {
    const { up, flat, down, entry, top, exit } = this;
    if (s <= 0) return [0, entry[i]];
    if (s < up[i]) { const v = entry[i] + (top[i] - entry[i]) * s / up[i]; return [(entry[i] + v) / 2 * s, v]; }
    let way = (entry[i] + top[i]) / 2 * up[i];
    s -= up[i];
    if (s < flat[i]) return [way + top[i] * s, top[i]];
    way += top[i] * flat[i];
    s -= flat[i];
    if (s >= down[i]) return [way + (top[i] + exit[i]) / 2 * down[i], exit[i]];
    const v = top[i] + (exit[i] - top[i]) * s / down[i];
    return [way + (top[i] + v) / 2 * s, v];
  }
  /** Share of a move that is done at a time. */
  share(i, t) {
    const whole = this.along(i, this.duration(i))[0];
    return whole > 0 ? clamp(this.along(i, t - this.begin[i])[0] / whole, 0, 1) : t >= this.end(i) ? 1 : 0;
  }
  place(i, share) {
    const p = this.points, k = 4 * i;
    return [0, 1, 2].map(axis => p[k + axis] + (p[k + 4 + axis] - p[k + axis]) * share);
  }
  /** The last move of a line of the file, or of the last line before it that moved; -1 if there is none. */
  ofLine(line) {
    let best = -1, nearest = 0;
    for (let i = 0; i < this.n; i++) if (this.line[i] <= line && this.line[i] >= nearest && this.line[i] > 0) { nearest = this.line[i]; best = i; }
    return best;
  }
  /** How many of the first `i` are moves. */
  made(i) { return i - after(this.renamed.length, k => this.renamed[k], i - 1); }
  /** mm of filament used up to a time: the most that was ahead until then. Sums and mosts are kept for some of the moves. */
  filament(t) {
    const EVERY = 1024;
    if (!this.sums) {
      this.sums = [[0, 0]];
      let sum = 0, most = 0;
      for (let i = 0; i < this.n; i++) {
        most = Math.max(most, sum += this.e[i]);
        if ((i + 1) % EVERY === 0) this.sums.push([sum, most]);
      }
    }
    if (!this.n) return 0;
    const i = this.indexAt(t), k = Math.floor(i / EVERY);
    let [sum, most] = this.sums[k];
    for (let j = k * EVERY; j < i; j++) most = Math.max(most, sum += this.e[j]);
    return Math.max(most, sum + this.e[i] * this.share(i, t));
  }
  get whole() { return this.n ? this.end(this.n - 1) : 0; }
}

/** Heights of the layers, and how much each adds. */
function layersOf(data) {
  const heights = data.by_layer?.length ? data.by_layer.map(layer => layer.height_mm) : data.heights.length ? data.heights : [0];
  const thick = heights.map((z, i) => { const step = i ? z - heights[i - 1] : z; return step > 0.02 && step < 1.5 ? step : 0.2; });
  return { heights, thick };
}

/** Reads the stream; `each` is called now and then, and may wait. */
async function readMoves(data, blobs, each) {
  const rows = data.move_chunks, capacity = rows.reduce((sum, row) => sum + row[0] + 1, 0);
  const moves = new Moves(data, capacity), { thick } = layersOf(data), area = moves.area = filamentArea(data);
  const p = moves.points;
  const { begin, up, flat, down, entry, top, exit, feed, e, line, type, limit, layer } = moves;
  let at = null, i = 0, rest = performance.now();
  let c = -1;
  for await (const bytes of inOrder(blobs)) {
    if (++c >= rows.length) break;
    if (performance.now() - rest > 30) { each?.(c / rows.length); await breathe(); rest = performance.now(); }
    const { unsigned, signed } = numbers(bytes);
    const [n, , , own] = rows[c], h = thick[own] ?? 0.2;
    let t = 0, v0 = 0, v1 = 0, v2 = 0, f = 0, l = 0;
    let place = rows[c].length > 6 ? rows[c].slice(4, 7) : at ?? [0, 0, 0];
    const first = i;
    // The position was named anew: a line without time that is never drawn.
    if (at && place.some((v, axis) => Math.abs(v - at[axis]) > 1)) {
      moves.renamed.push(i);
      begin[i] = moves.end(i - 1); type[i] = HIDDEN; layer[i] = own; line[i] = line[i - 1];
      p.set([at[0] / 1000, at[1] / 1000, at[2] / 1000, 0], 4 * i);
      i++;
    }
    let [x, y, z] = place;
    for (let k = 0; k < n; k++, i++) {
      l += signed(); line[i] = l;
      t += unsigned(); begin[i] = t * TEN_US;
      const a = unsigned(), b = unsigned(), d = unsigned();
      t += a + b + d;
      up[i] = a * TEN_US; flat[i] = b * TEN_US; down[i] = d * TEN_US;
      v0 += signed(); v1 += signed(); v2 += signed(); f += signed();
      entry[i] = v0 / 100; top[i] = v1 / 100; exit[i] = v2 / 100; feed[i] = f / 100;
      const dx = signed(), dy = signed(), dz = signed(), de = signed(), kind = unsigned();
      // More types than the shader has bits for count as one.
      e[i] = de / 1000; type[i] = Math.min(kind >> 4, WAY - 1); limit[i] = kind & 15; layer[i] = own;
      const q = 4 * i, way = Math.sqrt(dx * dx + dy * dy + dz * dz);
      p[q] = x / 1000; p[q + 1] = y / 1000; p[q + 2] = z / 1000;
      // A line of height h and round sides.
      p[q + 3] = de > 0 && way > 0 ? Math.min(de / way * area / h + h * (1 - Math.PI / 4), 5) : 0;
      x += dx; y += dy; z += dz;
    }
    p[4 * i] = x / 1000; p[4 * i + 1] = y / 1000; p[4 * i + 2] = z / 1000;
    at = [x, y, z];
    const last = moves.runs[moves.runs.length - 1];
    if (last && last.layer === own) last.end = i; else moves.runs.push({ first, end: i, layer: own });
    moves.n = i;
  }
  return moves;
}
/** The type of lines that are never drawn. */
const HIDDEN = 255;
