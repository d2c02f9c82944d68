// Charts: curves over time by uPlot, coupled with the picture and with each other.

/** Steps of a time axis in s. */
const TIMES = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600, 7200, 21600];

/** The shortest window. */
const SHORTEST_S = 0.01;

/** A chart: its curves and values at the cursor above it. `data(from, to, n)` gives time and for each curve [low, high]. */
class Chart {
  constructor(group, { title, unit, names, colours, dashes = [], data, low, height = 170, isTall, longest = Infinity }) {
    Object.assign(this, { group, title, unit, names, data, low, dashes, height, isTall, longest });
    this.colours = names.map((_, k) => colours?.[k] ?? (() => curveColour(k)));
    this.values = names.map(() => make("b"));
    this.swatches = names.map(() => make("i", { className: "swatch" }));
    this.legend = make("span", { className: "legend values" }, ...names.map((name, k) => make("span", {}, this.swatches[k], name + " ", this.values[k])));
    this.place = make("div", { className: "plot", tabIndex: 0, role: "img" });
    this.place.ariaLabel = `${title}${unit ? ", " + unit : ""}, over time: ${names.join(", ")}`;
    this.hint = make("p", { className: "sub", textContent: `Choose a window of at most ${longest} s to see it.` });
    this.element = make("div", { className: "chart" }, make("div", { className: "bar" }, make("h3", { textContent: title + (unit ? ", " + unit : "") }), this.legend), this.hint, this.place);
    this.now = make("div", { className: "nowline" });
    this.choose();
    new IntersectionObserver(entries => { this.isSeen = entries.at(-1).isIntersecting; group.ask(); }, { rootMargin: "150px" }).observe(this.place);
  }
  build() {
    const series = [{}], bands = [];
    this.names.forEach((name, k) => {
      const stroke = this.colours[k]();
      this.swatches[k].style.background = stroke;
      const line = { stroke, width: 1.3, dash: this.dashes[k], points: { show: false } };
      series.push({ ...line, label: name }, { ...line, label: name });
      bands.push({ series: [2 * k + 2, 2 * k + 1], fill: faint(stroke, this.names.length > 2 ? 0.2 : 0.45) });
    });
    const { group } = this;
    this.plot = plotted({
      width: plotWidth(this.place), height: this.height, series, bands, legend: { show: false }, padding: [8, 8, 0, 0],
      scales: { x: { time: false, range: () => group.window }, y: { range: (_, least, most) => {
        if (least === null || (least === 0 && most === 0)) return [0, 1];
        const bottom = Math.min(least, this.low ?? Infinity), room = (most - bottom) * 0.06 || Math.max(Math.abs(most) * 0.05, 1e-3);
        return [bottom === 0 ? 0 : bottom - room, most + room];
      } } },
      axes: [{ ...axisLook(28), incrs: TIMES, values: (_, all) => all.map(t => { const [a, b] = group.window; return b - a > 120 ? minutes(t) : +t.toFixed(3) + " s"; }) },
        { ...axisLook(54), values: (_, all) => all.map(tickText) }],
      cursor: { y: false, points: { show: false }, drag: { x: true, y: false, setScale: false }, sync: { key: group.key }, bind: { dblclick: () => () => { group.show(...group.whole); return null; } } },
      hooks: {
        setSelect: [u => { if (u.select.width > 6) group.show(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")); u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false); }],
        setCursor: [u => this.read(u.cursor.left >= 0 ? u.cursor.idx : null)],
        draw: [u => this.marks(u)],
      },
    }, this.last ?? [[0], ...this.names.flatMap(() => [[0], [0]])], this.place);
    const { over } = this.plot;
    over.append(this.now);
    let down = 0;
    const go = e => group.go(clamp(this.plot.posToVal(e.clientX - over.getBoundingClientRect().left, "x"), ...group.whole));
    over.addEventListener("pointerdown", e => { down = e.clientX; });
    over.addEventListener("pointermove", e => { if (e.pointerType !== "mouse" && e.buttons) go(e); });
    over.addEventListener("click", e => { if (Math.abs(e.clientX - down) < 4) go(e); });
  }
  marks(u) {
    const g = u.ctx, { left, top, width, height } = u.bbox, px = t => u.valToPos(t, "x", true);
    g.save(); g.beginPath(); g.rect(left, top, width, height); g.clip();
    g.font = 11 * devicePixelRatio + "px system-ui"; g.textAlign = "left";
    for (const { begin, end, text } of this.group.waits ?? []) {
      const a = px(begin), b = Math.max(px(end), a + 1);
      g.fillStyle = faint("rgb(128,128,128)", 0.2); g.fillRect(a, top, b - a, height); g.fillRect(a, top, devicePixelRatio, height);
      if (this.isTall && b - a > g.measureText(text).width + 8) { g.fillStyle = css("--soft"); g.fillText(text, a + 4, top + 13 * devicePixelRatio); }
    }
    const taken = [];
    for (const mark of this.group.marks) {
      const x = px(mark.time_s);
      g.strokeStyle = css("--bad"); g.fillStyle = css("--bad"); g.lineWidth = 2 * devicePixelRatio;
      g.beginPath(); g.moveTo(x, top); g.lineTo(x, top + height); g.stroke();
      g.font = "bold " + 11 * devicePixelRatio + "px system-ui"; g.textAlign = x > left + width - 90 * devicePixelRatio ? "right" : "left";
      // A name is left out where another one stands.
      const long = g.measureText(mark.code).width, isRight = g.textAlign === "right", from = isRight ? x - 4 - long : x + 4;
      if (taken.some(other => from < other.to && from + long > other.from)) continue;
      taken.push({ from, to: from + long });
      g.fillText(mark.code, isRight ? x - 4 : x + 4, top + 12 * devicePixelRatio);
    }
    g.restore();
  }
  /** Says the values at a bin: the one under the cursor, or else the one of now. */
  read(bin) {
    if (!this.last) return;
    const time = this.last[0], b = bin ?? clamp(after(time.length, k => time[k], this.group.now) - 1, 0, time.length - 1);
    this.names.forEach((_, k) => {
      const low = this.last[2 * k + 1][b], high = this.last[2 * k + 2][b];
      this.values[k].textContent = low === null || low === undefined ? "\u2013" : Math.abs(high - low) < 0.005 * Math.max(Math.abs(high), Math.abs(low)) + 1e-6 ? short(high) : short(low) + " to " + short(high);
    });
    if (bin !== null) this.group.say(time[b]);
  }
  /** The curves, or in a window that is too long the hint, from the begin on: what is read later moves nothing. */
  choose() {
    const [from, to] = this.group.window;
    this.hint.hidden = to - from <= this.longest * 1.001;
    this.place.hidden = !this.hint.hidden;
  }
  async update(isWanted) {
    const { group: { window: [from, to] } } = this, key = [from, to, this.place.clientWidth].join();
    this.choose();
    if (this.place.hidden) return;
    if (this.plot && this.key === key) return;
    const n = clamp(Math.round(this.place.clientWidth - 62), 100, 1200), last = await this.data(...this.group.window, n, isWanted);
    if (!last || !isWanted()) return;
    this.last = last; this.key = key;
    if (!this.plot) this.build(); else this.plot.setData(last, true);
    this.mark(); this.read(null);
  }
  mark() {
    if (!this.plot) return;
    const x = this.plot.valToPos(this.group.now, "x");
    this.now.hidden = !(x >= 0 && x <= this.plot.over.clientWidth);
    this.now.style.transform = `translateX(${x}px)`;
  }
}

/** Charts over one kind of time. */
class Charts {
  constructor(title, whole, { toTime, fromTime, marks, waits, player, note }) {
    Object.assign(this, { charts: [], key: "corehbot-" + (Charts.keys = (Charts.keys ?? 0) + 1), whole, window: [...whole], marks, waits, toTime, fromTime, player, round: 0 });
    this.out = make("output");
    const zoom = times => { const [a, b] = this.window, half = Math.max((b - a) * times, SHORTEST_S) / 2, middle = this.now >= a && this.now <= b ? this.now : (a + b) / 2; this.show(middle - half, middle + half); };
    const move = share => { const [a, b] = this.window; this.show(a + (b - a) * share, b + (b - a) * share); };
    this.grid = make("div", { className: "charts" });
    this.element = make("section", { className: "card panel", ariaLabel: title }, make("div", { className: "bar" }, make("h2", { textContent: title }), make("span", { className: "sub", textContent: note }), make("span", { className: "grow" }), this.out,
      buttonGroup("Window of time", pushButton("\u2190", "Earlier", () => move(-0.5)), pushButton("\u2212", "Longer window", () => zoom(4)), pushButton("+", "Shorter window around now", () => zoom(0.25)), pushButton("\u2192", "Later", () => move(0.5)), pushButton("All", "The whole print", () => this.show(...this.whole)))), this.grid);
    player.on("time", () => this.follow());
    for (const on of [onScheme, onPaper]) on(this.element, () => this.rebuild());
    new ResizeObserver(() => this.resize()).observe(this.grid);
  }
  add(options) { const chart = new Chart(this, options); this.charts.push(chart); this.grid.append(chart.element); }
  get now() { return this.chosen ?? this.fromTime(this.player.now); }
  go(t) { this.player.stop(); this.player.setTime(this.toTime(t)); this.chosen = this.fromTime === this.toTime ? null : t; this.follow(true); }
  say(t) { const [a, b] = this.window; this.out.textContent = b - a > 120 ? clock(t) : t.toFixed(b - a > 10 ? 2 : 4) + " s"; }
  follow(isOwn) {
    if (!isOwn) this.chosen = null;
    const [a, b] = this.window, t = this.now;
    if (t < a || t > b) this.show(t - (b - a) * 0.1, t + (b - a) * 0.9);
    for (const chart of this.charts) { chart.mark(); chart.read(null); }
    this.say(t);
  }
  show(a, b) {
    const [least, most] = this.whole, span = Math.min(Math.max(b - a, SHORTEST_S), most - least);
    const from = clamp(a, least, Math.max(most - span, least));
    this.window = [from, from + span];
    this.ask();
  }
  ask() { this.asked ||= requestAnimationFrame(() => { this.asked = 0; this.update(); }); }
  async update() {
    const round = ++this.round, isWanted = () => round === this.round;
    // What is in sight comes first. The rest is drawn when the page has nothing else to do, since it may be printed.
    for (const chart of this.charts.filter(({ isSeen }) => isSeen)) { await chart.update(isWanted); if (!isWanted()) return; await breathe(); }
    for (const chart of this.charts.filter(({ isSeen }) => !isSeen)) { await new Promise(whenIdle); if (!isWanted()) return; await chart.update(isWanted); }
  }
  resize() {
    for (const { plot, place, height } of this.charts) plot?.setSize({ width: Math.max(place.clientWidth, 200), height });
    if (this.grid.clientWidth) this.ask();
  }
  /** At once, of what was computed last: a page that is printed does not wait. */
  rebuild() { for (const chart of this.charts) if (chart.plot) { chart.plot.destroy(); chart.build(); chart.mark(); } }
}
