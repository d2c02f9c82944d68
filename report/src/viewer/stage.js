// Stage: the picture of the moves, with the bed below and marks above, and the hands that turn it.

/** A finger goes sideways from so many px on. */
const SIDEWAYS_PX = 8;

class Stage {
  constructor(record, player) {
    Object.assign(this, { record, player, camera: new Camera(), picker: null, hover: -1, second: null, way: null, marks: {}, sides: "both", withSkirt: false, drawn: null, calm: 0, pending: 0, dirty: true });
    const canvas = name => make("canvas", { className: name });
    this.under = canvas("under"); this.middle = canvas("middle"); this.over = canvas("over");
    this.tip = make("div", { className: "tip", hidden: true });
    this.element = make("div", { className: "stage", tabIndex: 0, role: "application" }, this.under, this.middle, this.over, this.tip);
    this.element.ariaLabel = "Tool path. Arrow keys: moves and layers; plus, minus: zoom; 0: fit; 3: from above or in three dimensions; space: play";
    this.lines = new Lines(this.middle);
    this.body = this.lines.add(record.moves);
    this.ratio = this.lines.isSoftware ? 1 : Math.min(devicePixelRatio || 1, 2);
    this.hands();
    for (const kind of ["layers", "hidden"]) player.on(kind, () => this.redraw());
    player.on("time", () => this.advance());
    onScheme(this.element, () => this.redraw());
    onPaper(this.element, isPaper => this.turn(isPaper));
    new ResizeObserver(() => this.resize()).observe(this.element);
  }
  /** Least and greatest place of what is printed, without skirt and purge line unless they are wanted. */
  box() {
    const { moves, data } = this.record, out = data.types.map(type => !this.withSkirt && (type.role === "skirt" || type.role === "purge"));
    const find = take => {
      const p = moves.points, least = [Infinity, Infinity, Infinity], most = [-Infinity, -Infinity, -Infinity];
      for (let i = 0; i < moves.n; i++) {
        if (!take(i)) continue;
        for (let k = 4 * i, axis = 0; axis < 3; axis++, k++) {
          const from = p[k], to = p[k + 4];
          if (from < least[axis]) least[axis] = from;
          if (from > most[axis]) most[axis] = from;
          if (to < least[axis]) least[axis] = to;
          if (to > most[axis]) most[axis] = to;
        }
      }
      return least[0] <= most[0] ? [least, most] : null;
    };
    const [[left, right], [front, back]] = data.reach;
    return find(i => moves.isPrinted(i) && moves.points[4 * i + 3] > 0 && !out[moves.type[i]]) ?? find(i => moves.isPrinted(i) && moves.length(i) > 0)
      ?? find(i => moves.type[i] !== HIDDEN && moves.length(i) > 0) ?? [[left, front, 0], [right, back, 0]];
  }
  fit() { this.camera.fit(this.bounds ??= this.box()); this.fitted = this.camera.view; this.redraw(); }
  /** Shows a box from where it is seen now. */
  lookAt(box) { this.camera.fit(box); this.player.tell("camera"); this.redraw(); }
  /** Waits until all is drawn. */
  async whole() { while (this.pending || this.dirty || this.lines.queue.length || this.drawn !== this.player.done) await new Promise(requestAnimationFrame); }
  refit() { this.bounds = null; this.fit(); }
  setAbove(isAbove) {
    Object.assign(this.camera, isAbove ? { azimuth: 0, elevation: 90 } : { azimuth: 30, elevation: 35 });
    this.player.tell("camera");
    this.fit();
  }
  resize() {
    const w = this.element.clientWidth, h = this.element.clientHeight, first = this.camera.width === 1;
    if (!w || !h) return;
    for (const [canvas, ratio] of [[this.under, devicePixelRatio || 1], [this.middle, this.ratio], [this.over, devicePixelRatio || 1]]) {
      canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio);
    }
    // A view that was fitted and not turned since stays fitted.
    const before = Math.min(this.camera.width, this.camera.height), isFitted = this.camera.view === this.fitted;
    Object.assign(this.camera, { width: w, height: h });
    if (first || isFitted) this.fit(); else { if (Math.min(w, h) !== before) this.camera.scale *= Math.min(w, h) / before; this.redraw(); }
  }
  /** Everything is drawn again; in motion only a part, until the view stands still. */
  redraw(isMoving = false) {
    this.dirty = true;
    this.calm = isMoving ? performance.now() + 150 : 0;
    this.ask();
  }
  ask() { this.pending ||= requestAnimationFrame(() => this.frame()); }
  /** Draws the real way of the tool above the planned moves, as a thin line, or no longer does. */
  async setWay(isOn, path) {
    if (!isOn && this.way) { this.lines.remove(this.way); this.way = null; }
    this.wantsWay = isOn;
    if (isOn) {
      const moves = await readPath(this.record.data, path);
      if (this.wantsWay && !this.way) this.way = this.lines.add(moves, isDark() ? WHITE : BLACK);
    }
    this.redraw();
  }
  /** Shows the marks of a name, or none. */
  setMarks(name, body) {
    this.marks[name] = body;
    this.redraw();
  }
  /** Bodies that are drawn above the lines. */
  get above() { return [this.way, ...Object.values(this.marks)].filter(Boolean); }
  /** Runs of another body than the record's, in the shown layers and up to now. */
  others(body) {
    const { player } = this, { moves } = body, done = player.done >= player.moves.n ? moves.n : moves.indexAt(player.now);
    return moves.runs.filter(run => run.layer >= player.low && run.layer <= player.high && run.first < done).map(run => [body, run.first, Math.min(run.end, done)]);
  }
  /** Runs of all bodies that are to be seen. */
  runs() {
    const { player, second } = this;
    const own = this.sides !== "second" ? player.runs().map(([a, b]) => [this.body, a, b]) : [];
    return [...(second && this.sides !== "first" ? this.others(second.body) : []), ...own, ...this.above.flatMap(body => this.others(body))];
  }
  frame() {
    this.pending = 0;
    const { lines, player } = this;
    if (lines.isEnded) return;
    if (!lines.isReady()) return this.ask();
    if (this.dirty) {
      this.dirty = false;
      lines.look(this.camera, player.hidden, this.ratio);
      lines.clear();
      const [now, rest] = thinned(this.runs(), lines.batch);
      lines.draw(now);
      lines.queue = rest;
      this.drawn = player.done;
      this.drawUnder(); this.drawOver();
      this.onPicture?.();
    } else if (lines.queue.length && performance.now() >= this.calm) lines.work();
    if (lines.queue.length || this.dirty) this.ask(); else this.onWhole?.();
  }
  /** The time has changed: what came is added; if it went back all is drawn again. */
  advance() {
    const { player, lines } = this;
    if (this.second || this.above.length || this.drawn === null || player.done < this.drawn || this.dirty) this.redraw(player.playing);
    else if (player.done > this.drawn) {
      for (const [first, end] of player.runs()) if (end > this.drawn) lines.queue.push([this.body, Math.max(first, this.drawn), end]);
      this.drawn = player.done;
      this.calm = 0;
      this.ask();
    }
    this.drawOver();
  }
  /** Grid, lines and marks as one canvas. */
  flat(tall = 0) {
    const { width, height } = this.over, canvas = make("canvas", { className: "printed", width, height: height + tall }), g = canvas.getContext("2d");
    for (const layer of [this.under, this.middle, this.over]) g.drawImage(layer, 0, 0, width, height);
    return canvas;
  }
  /** For paper the picture is one canvas of now, as a page that is printed does not wait: Chromium prints a canvas that was
   * drawn just now as its orders, and the one that clears it would clear those below it too. */
  turn(isPaper) {
    this.element.querySelector(".printed")?.remove();
    if (isPaper || isDark()) { this.drawUnder(); this.drawOver(); }
    if (isPaper) this.element.append(this.flat());
  }
  surface(canvas) {
    const g = canvas.getContext("2d", { willReadFrequently: this.lines.isSoftware }), ratio = devicePixelRatio || 1;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, this.camera.width, this.camera.height);
    return g;
  }
  /** The reach of the machine and a grid at z = 0. */
  drawUnder() {
    const { camera } = this, g = this.surface(this.under);
    const { reach } = this.record.data, [[left, right], [front, back]] = reach;
    drawGrid(g, camera, reach);
    if (camera.isAbove) return;
    for (const [name, axis] of [["X", 0], ["Y", 1], ["Z", 2]]) {
      const from = [left, front, 0], to = [...from]; to[axis] += Math.min(right - left, back - front) / 8;
      const [a, b] = [camera.toScreen(from), camera.toScreen(to)];
      g.strokeStyle = g.fillStyle = css("--soft"); g.beginPath(); g.moveTo(...a); g.lineTo(...b); g.stroke(); g.fillText(name, b[0] + 3, b[1] - 3);
    }
  }
  /** The tool, the move under the pointer, and faults. */
  drawOver() {
    const { camera, player } = this, { moves, marks } = this.record, g = this.surface(this.over);
    if (!moves.n) return;
    const stroke = (i, colour, from = 0, to = 1) => {
      const [a, b] = [moves.place(i, from), moves.place(i, to)].map(p => camera.toScreen(p));
      g.strokeStyle = colour; g.lineCap = "round";
      g.lineWidth = Math.max(moves.points[4 * i + 3] * camera.scale, 2.5);
      g.beginPath(); g.moveTo(...a); g.lineTo(...b); g.stroke();
    };
    const i = player.current, share = moves.share(i, player.now);
    if (player.done === i && share > 0 && share < 1 && !(player.hidden >>> moves.type[i] & 1)) stroke(i, css("--accent"), 0, share);
    if (this.hover >= 0) stroke(this.hover, css("--ink"));
    for (const mark of marks) {
      const at = moves.indexAt(mark.time_s), [x, y] = camera.toScreen(moves.place(at, moves.share(at, mark.time_s)));
      g.strokeStyle = css("--card"); g.lineWidth = 6;
      const cross = new Path2D(); for (const d of [-1, 1]) { cross.moveTo(x - 8, y - 8 * d); cross.lineTo(x + 8, y + 8 * d); }
      g.stroke(cross); g.strokeStyle = css("--bad"); g.lineWidth = 3; g.stroke(cross);
    }
    const [x, y] = camera.toScreen(moves.place(i, share));
    g.strokeStyle = css("--ink"); g.fillStyle = css("--card"); g.lineWidth = 2;
    g.beginPath(); g.arc(x, y, 5, 0, 7); g.fill(); g.stroke();
  }
  /** Pointers, wheel and touch. */
  hands() {
    const { element, camera } = this, fingers = new Map();
    const spot = e => { const box = element.getBoundingClientRect(); return [e.clientX - box.left, e.clientY - box.top]; };
    let moved = 0, isUpright = false;
    const turned = () => { this.redraw(true); this.player.tell("camera"); };
    element.addEventListener("wheel", e => {
      e.preventDefault();
      camera.zoom(clamp(Math.exp(-e.deltaY * (e.deltaMode ? 0.05 : 0.0015)), 0.5, 2), ...spot(e));
      turned();
    }, { passive: false });
    // One finger that goes up or down scrolls the page, unless there is nothing else on the screen; two are for the picture.
    element.addEventListener("touchmove", e => { if (e.touches.length > 1) e.preventDefault(); }, { passive: false });
    element.addEventListener("contextmenu", e => e.preventDefault());
    element.addEventListener("pointerdown", e => { element.setPointerCapture(e.pointerId); fingers.set(e.pointerId, spot(e)); moved = 0; isUpright = e.pointerType === "touch" && !document.fullscreenElement; this.show(-1); });
    element.addEventListener("pointermove", e => {
      const before = fingers.get(e.pointerId), now = spot(e);
      if (!before) { if (e.pointerType === "mouse") this.look(...now); return; }
      const dx = now[0] - before[0], dy = now[1] - before[1];
      moved += Math.abs(dx) + Math.abs(dy);
      // Until one finger has gone sideways it may be about to scroll the page.
      if (isUpright && fingers.size === 1) {
        if (Math.abs(dx) < SIDEWAYS_PX || Math.abs(dx) < Math.abs(dy)) return;
        isUpright = false;
      }
      if (fingers.size === 2) {
        const [, other] = [...fingers].find(([id]) => id !== e.pointerId), gap = p => Math.hypot(p[0] - other[0], p[1] - other[1]);
        camera.zoom(gap(now) / Math.max(gap(before), 1), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
        camera.pan(dx / 2, dy / 2);
      } else if (camera.isAbove ? e.buttons !== 2 : e.buttons & 6 || e.shiftKey) camera.pan(dx, dy);
      else camera.orbit(dx, dy);
      fingers.set(e.pointerId, now);
      turned();
    });
    const up = e => {
      const [x, y] = fingers.get(e.pointerId) ?? [];
      fingers.delete(e.pointerId);
      if (e.type === "pointerup" && moved < 5 && x !== undefined) {
        const i = this.find(x, y);
        if (e.pointerType !== "mouse") this.show(i, x, y);
        if (i >= 0) { this.player.stop(); this.player.setMove(i + 1); }
      }
    };
    for (const name of ["pointerup", "pointercancel"]) element.addEventListener(name, up);
    // A finger leaves when it is lifted, and what it asked stays.
    element.addEventListener("pointerleave", e => { if (e.pointerType === "mouse") this.show(-1); });
  }
  find(x, y) {
    if (this.sides === "second") return -1;
    this.picker ??= new Picker(this.record.moves);
    return this.picker.at(x, y, this.camera, this.player.runs(), this.player.hidden);
  }
  look(x, y) {
    this.spot = [x, y];
    this.looking ||= requestAnimationFrame(() => { this.looking = 0; this.show(this.find(...this.spot), ...this.spot); });
  }
  /** Says what is known of a move next to the pointer. */
  show(i, x, y) {
    if (i !== this.hover) { this.hover = i; this.drawOver(); this.player.tell("hover", i); }
    this.tip.hidden = i < 0;
    if (i < 0) return;
    this.tip.replaceChildren(...this.record.tell(i).map(([name, text]) => make("div", {}, make("span", { textContent: name }), make("b", { textContent: text }))));
    const { width, height } = this.camera, w = this.tip.offsetWidth, h = this.tip.offsetHeight;
    this.tip.style.transform = `translate(${clamp(x + 16 + w > width ? x - w - 12 : x + 16, 0, Math.max(width - w, 0))}px,${clamp(y + 14, 0, Math.max(height - h, 0))}px)`;
  }
}
