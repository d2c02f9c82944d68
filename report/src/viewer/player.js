// Player: which moves are shown. The layers, the number of moves that are done, and the time agree at any moment.

class Player {
  constructor(moves, layers) {
    Object.assign(this, { moves, layers, low: 0, high: layers - 1, done: moves.n, now: moves.whole, single: false, playing: false, speed: 0, hidden: 0, listeners: {} });
  }
  on(kind, listener) { (this.listeners[kind] ??= []).push(listener); }
  tell(kind, value) { for (const listener of this.listeners[kind] ?? []) listener(value); }
  /** Runs [first, end] of moves in the shown layers, up to `done`. */
  runs(done = this.done) {
    const runs = [];
    for (const run of this.moves.runs) {
      if (run.first >= done) break;
      if (run.layer < this.low || run.layer > this.high) continue;
      runs.push([run.first, Math.min(run.end, done)]);
    }
    return runs;
  }
  /** The first move of the shown layers, and the one after their last. */
  span() {
    const own = this.moves.runs.filter(run => run.layer >= this.low && run.layer <= this.high);
    return own.length ? [own[0].first, own[own.length - 1].end] : [0, this.moves.n];
  }
  /** The move that is under way, or was the last. Times are whole 10 us, and the end of a move is a sum of rounded ones. */
  get current() {
    const { moves, done, now } = this, isUnderWay = now < moves.whole && done < moves.n && now > moves.begin[done] + TEN_US / 2;
    return clamp(isUnderWay ? done : done - 1, 0, Math.max(moves.n - 1, 0));
  }
  setMove(done) {
    this.done = clamp(done, 0, this.moves.n);
    this.now = this.done ? this.moves.end(this.done - 1) : 0;
    // Before the first move of the shown layers nothing of them is done, and no other layer is wanted.
    if (this.done !== this.span()[0]) this.follow(this.done - 1);
    this.tell("time");
  }
  setTime(t) {
    const { moves } = this;
    this.now = clamp(t, 0, moves.whole);
    this.done = this.now >= moves.whole ? moves.n : moves.indexAt(this.now);
    this.follow(this.done);
    this.tell("time");
  }
  /** Shows the layer of a move, too. */
  follow(i) {
    if (i < 0 || i >= this.moves.n) return;
    const layer = this.moves.layer[i], { low, high } = this;
    if (layer >= low && layer <= high) return;
    if (this.single) this.low = this.high = layer;
    else { this.low = Math.min(low, layer); this.high = Math.max(high, layer); }
    this.tell("layers");
  }
  setSingle(single) {
    this.single = single;
    if (!this.setLayers(single ? this.high : 0, this.high)) this.tell("layers");
  }
  /** Whether there was anything to change. */
  setLayers(low, high) {
    low = clamp(low, 0, this.layers - 1); high = clamp(high, low, this.layers - 1);
    if (low === this.low && high === this.high) return false;
    Object.assign(this, { low, high });
    this.tell("layers");
    // All of the layers is to be seen, whatever the time was.
    this.setMove(this.span()[1]);
    return true;
  }
  /** To the next moves of the shown layers, or to those before. */
  step(by) {
    const [first, end] = this.span();
    let to = clamp(this.done + by, first, end);
    const shown = i => this.moves.layer[i] >= this.low && this.moves.layer[i] <= this.high && this.moves.type[i] !== HIDDEN;
    while (to > first && to < end && !shown(to - 1)) to += Math.sign(by);
    this.stop();
    this.setMove(to);
  }
  stop() { if (this.playing) { this.playing = false; this.tell("play"); } }
  play() {
    if (this.playing) return this.stop();
    const { moves } = this;
    this.playing = true;
    this.tell("play");
    let [first, end] = this.span();
    if (this.done >= end) this.setMove(first);
    let last = performance.now();
    // A pause and another begin may come within one frame.
    const round = this.round = (this.round ?? 0) + 1;
    const step = time => {
      if (!this.playing || this.round !== round) return;
      [first, end] = this.span();
      // At speed 0 the shown layers take 20 s.
      const from = moves.begin[first] ?? 0, to = end ? moves.end(end - 1) : 0;
      const t = this.now + (time - last) / 1000 * (this.speed || Math.max(1, (to - from) / 20));
      last = time;
      if (t >= to) { this.setMove(end); this.stop(); } else { this.setTime(t); requestAnimationFrame(step); }
    };
    requestAnimationFrame(step);
  }
}
