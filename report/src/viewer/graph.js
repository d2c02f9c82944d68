// Graph: curves, points or bars over any quantity by uPlot, with units, a legend that hides curves, and values at a cursor.

/**
 * Makes a chart of uPlot whose canvas is drawn by the processor. Where graphics are done in software (SwiftShader), a curve
 * on a canvas of the graphics process holds the whole page up for seconds.
 */
function plotted(options, data, place) {
  const { prototype } = HTMLCanvasElement, own = prototype.getContext;
  prototype.getContext = function (kind, settings) { return own.call(this, kind, kind === "2d" ? { willReadFrequently: true, ...settings } : settings); };
  try { return new uPlot(options, data, place); } finally { prototype.getContext = own; }
}
/** How axes look, and the room for their words. */
const axisLook = size => ({ stroke: css("--soft"), grid: { stroke: css("--grid"), width: 1 }, ticks: { stroke: css("--grid"), width: 1, size: 4 }, font: "11px system-ui, sans-serif", size, labelFont: "11px system-ui, sans-serif", labelSize: 16, labelGap: 0 });
/** The number at a mark of an axis. */
const tickText = v => Math.abs(v) >= 1e6 ? +(v / 1e6).toPrecision(4) + "M" : Math.abs(v) >= 1e5 ? v / 1000 + "k" : String(+v.toPrecision(6));
/** A value in words, with four digits. */
const valueText = v => v === null || v === undefined ? "\u2013" : v === 0 ? "0" : Math.abs(v) >= 1e7 || Math.abs(v) < 1e-3 ? v.toExponential(2) : String(+v.toPrecision(4));

/** Charts are so many px wide on paper: those between the margins of A4 and of letter. */
const PAPER_PX = 660;
const plotWidth = place => isPaper() ? PAPER_PX : Math.max(place.clientWidth, 200);

/** Calls once the page has nothing else to do. */
const whenIdle = window.requestIdleCallback ? each => requestIdleCallback(each) : each => setTimeout(each, 200);
/** Calls once: when an element is in sight, or nearly, or when the page has nothing else to do, since it may be printed. */
function whenSeen(element, each) {
  let isDone = false;
  const go = () => { if (isDone || !element.isConnected) return; isDone = true; watch.disconnect(); each(); };
  const watch = new IntersectionObserver(entries => { if (entries.some(entry => entry.isIntersecting)) go(); else whenIdle(go); }, { rootMargin: "150px" });
  watch.observe(element);
}

/**
 * A chart. A curve is `{ name, x, y }`, with `low` a band, with `isRight` on the right axis, which goes from 0 to 1; with
 * `labels` it is points, each with its name. `x` is `{ name, unit, from, to }`. `sync` couples the cursors of charts,
 * `marks` have a name at an x, and `line` is a straight one between two places.
 */
class Graph {
  constructor({ title, unit, x, curves, right, marks = [], line, height = 190, sync, low, isBars }) {
    Object.assign(this, { title, unit, x, curves, right, marks, line, height, sync, low, isBars });
    this.colours = curves.map((curve, k) => curve.colour ?? (() => curveColour(k)));
    this.hidden = new Set();
    this.out = make("output");
    this.swatches = curves.map(({ dash }) => make("i", { className: "swatch" + (dash ? " dashed" : "") }));
    const entry = (name, k) => make("button", { type: "button", ariaPressed: "true", title: "Show or hide this curve", onclick: () => this.toggle(k) }, this.swatches[k], name);
    this.entries = curves.length > 1 ? curves.map(({ name }, k) => entry(name, k)) : [];
    this.place = make("div", { className: "plot", tabIndex: 0, role: "img" });
    this.place.ariaLabel = `${title}${unit ? ", " + unit : ""}, over ${x.name}${x.unit ? ", " + x.unit : ""}: ${curves.map(({ name }) => name).join(", ")}. Arrow keys read values.`;
    this.place.style.minHeight = height + "px";
    this.element = make("div", { className: "chart" }, make("div", { className: "bar" }, make("h3", { textContent: title + (unit ? ", " + unit : "") }), make("span", { className: "legend" }, ...this.entries)), this.out, this.place);
    this.tell(null);
    this.align();
    whenSeen(this.place, () => { this.isSeen = true; this.build(); });
    for (const on of [onScheme, onPaper]) on(this.element, () => { if (this.isSeen) this.build(); });
    new ResizeObserver(() => this.plot?.setSize({ width: this.width, height })).observe(this.place);
    this.place.addEventListener("keydown", e => this.key(e));
  }
  get width() { return plotWidth(this.place); }
  /** All curves on the same places. */
  align() {
    const { curves } = this;
    // What is less than a billionth of the greatest value is what rounding left.
    this.least = 1e-9 * curves.filter(({ isRight }) => !isRight).flatMap(({ y }) => y).reduce((most, v) => Math.max(most, Math.abs(v ?? 0)), 0);
    if (curves.some(({ labels }) => labels)) {
      const all = curves.flatMap((curve, k) => curve.y.map((y, i) => ({ x: curve.x[i], y, k, label: curve.labels[i] }))).filter(({ y }) => y !== null).sort((a, b) => a.x - b.x);
      this.points = all;
      this.data = [all.map(({ x }) => x), ...curves.map((_, k) => all.map(point => point.k === k ? point.y : null))];
      return;
    }
    this.data = uPlot.join(curves.map(({ x, y, low }) => low ? [x, low, y] : [x, y]));
  }
  build() {
    this.plot?.destroy();
    const series = [{}], bands = [], { x, curves, isBars } = this;
    this.series = [];
    curves.forEach(({ low, dash, isThin, isRight, labels }, k) => {
      const stroke = this.colours[k](), show = !this.hidden.has(k), common = { stroke, show, spanGaps: true, scale: isRight ? "right" : "y", width: isThin ? 1 : 1.6, dash: dash ? [5, 4] : undefined, points: { show: false } };
      Object.assign(this.swatches[k].style, dash ? { borderColor: stroke } : { background: stroke });
      if (labels) series.push({ ...common, paths: () => null, points: { show: true, size: labels.length > 500 ? 3 : 6, width: 0, fill: stroke, stroke } });
      else if (isBars) series.push({ ...common, fill: faint(stroke, 0.3), paths: uPlot.paths.bars({ size: [0.85, 60] }) });
      else {
        if (low) { series.push(common); bands.push({ series: [series.length, series.length - 1], fill: faint(stroke, 0.3) }); }
        series.push(common);
      }
      this.series.push({ at: series.length - 1, isBand: Boolean(low) });
    });
    const range = (_, least, most) => {
      if (least === null) return [0, 1];
      const bottom = Math.min(least, this.low ?? Infinity), span = Math.max(most, this.low ?? -Infinity) - bottom, room = span > 1e-9 * Math.abs(most) ? span * 0.06 : Math.max(Math.abs(most) * 0.05, 1e-3);
      return [bottom === 0 ? 0 : bottom - room, bottom + span + room];
    };
    const ends = [x.from ?? this.data[0][0] ?? 0, x.to ?? this.data[0].at(-1) ?? 1], room = this.points ? (ends[1] - ends[0]) * 0.03 || 1 : 0;
    this.whole = [ends[0] - room, ends[1] > ends[0] ? ends[1] + room : ends[0] + (room || 1)];
    const axes = [{ ...axisLook(30), label: x.name + (x.unit ? ", " + x.unit : ""), values: (_, all) => all.map(tickText), incrs: isBars ? [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] : undefined }, { ...axisLook(54), values: (_, all) => all.map(tickText) }];
    const scales = { x: { time: false, range: (_, a, b) => this.window ?? this.whole }, y: { range } };
    if (this.right) { scales.right = { range: [0, 1.05] }; axes.push({ ...axisLook(44), scale: "right", side: 1, grid: { show: false }, label: this.right, labelSize: 18 }); }
    this.plot = plotted({
      width: this.width, height: this.height, series, bands, axes, scales, legend: { show: false }, padding: [8, this.right ? 4 : 16, 0, 0],
      cursor: { y: false, points: { show: false }, drag: { x: !isBars, y: false, setScale: false }, sync: this.sync ? { key: this.sync } : undefined, bind: { dblclick: () => () => { this.zoom(null); return null; } } },
      hooks: {
        setSelect: [u => { if (u.select.width > 6) this.zoom([u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")]); u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false); }],
        setCursor: [u => this.tell(u.cursor.left >= 0 ? u.cursor.idx : null)],
        draw: [u => this.mark(u)],
      },
    }, this.data, this.place);
    const { over } = this.plot;
    let down = 0;
    over.addEventListener("pointerdown", e => { down = e.clientX; });
    over.addEventListener("click", e => { if (this.onPick && this.read !== null && Math.abs(e.clientX - down) < 4) this.onPick(this.read); });
    // A finger that slides along reads values; the page scrolls by an upright one.
    for (const name of ["pointerdown", "pointermove"]) over.addEventListener(name, e => {
      if (e.pointerType === "mouse") return;
      const box = over.getBoundingClientRect();
      this.plot.setCursor({ left: e.clientX - box.left, top: e.clientY - box.top });
    });
  }
  zoom(window) { this.window = window; this.plot.setData(this.data, true); this.onZoom?.(window); }
  toggle(k) {
    if (!this.hidden.delete(k)) this.hidden.add(k);
    this.entries[k].ariaPressed = String(!this.hidden.has(k));
    if (this.plot) this.build();
  }
  key(e) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[e.key], xs = this.data[0];
    if (e.key === "Enter" && this.onPick && this.read !== null) { e.preventDefault(); e.stopPropagation(); this.onPick(this.read); return; }
    if (!step || !this.plot || e.altKey || e.ctrlKey || e.metaKey) return;
    e.preventDefault(); e.stopPropagation();
    const [a, b] = this.window ?? this.whole, first = after(xs.length, i => xs[i], a - 1e-12), last = after(xs.length, i => xs[i], b) - 1;
    this.read = clamp((this.read ?? (step > 0 ? first - 1 : last + 1)) + step * (e.shiftKey ? 10 : 1), first, last);
    this.plot.setCursor({ left: this.plot.valToPos(xs[this.read], "x"), top: this.plot.over.clientHeight / 2 });
  }
  /** The value of a curve that is nearest to a place of all curves. */
  near(column, i) {
    for (let far = 0; far < column.length; far++) for (const k of [i - far, i + far]) if (column[k] !== null && column[k] !== undefined) return column[k];
    return null;
  }
  tell(i) {
    if (i === null || i === undefined) { this.read = null; this.out.textContent = this.idle ?? "\u00a0"; return; }
    this.read = i;
    const place = v => (this.x.say ?? valueText)(v) + (this.x.unit ? " " + this.x.unit : ""), text = v => valueText(Math.abs(v) < this.least ? 0 : v), unit = this.unit ? " " + this.unit : "";
    if (this.points) {
      const { left, top } = this.plot.cursor, far = point => this.hidden.has(point.k) ? Infinity : (this.plot.valToPos(point.x, "x") - left) ** 2 + (this.plot.valToPos(point.y, "y") - top) ** 2;
      const best = this.points.reduce((a, b) => far(b) < far(a) ? b : a, this.points[0]);
      this.out.textContent = best ? `${best.label}: ${place(best.x)}, ${text(best.y)}${unit}` : "";
      return;
    }
    const shown = this.curves.map((_, k) => k).filter(k => !this.hidden.has(k));
    const said = k => {
      const { name, isRight } = this.curves[k], { at, isBand } = this.series[k], high = this.near(this.data[at], i), low = isBand ? this.near(this.data[at - 1], i) : high;
      return (this.curves.length > 1 ? name + " " : "") + (isRight ? (100 * high).toFixed(1) + " %" : high - low > 0.005 * Math.max(Math.abs(high), Math.abs(low)) ? text(low) + " to " + text(high) : text(high));
    };
    const [left, right] = [false, true].map(isRight => shown.filter(k => Boolean(this.curves[k].isRight) === isRight).map(said).join(", "));
    this.out.textContent = place(this.data[0][i]) + ": " + [left && left + unit, right].filter(Boolean).join(", ");
  }
  /** Marks at places of the x axis, with their names. */
  mark(u) {
    const g = u.ctx, { left, top, width, height } = u.bbox, d = devicePixelRatio;
    g.save(); g.beginPath(); g.rect(left, top, width, height); g.clip();
    g.font = 11 * d + "px system-ui, sans-serif"; g.strokeStyle = g.fillStyle = css("--soft"); g.lineWidth = d;
    this.marks.forEach(({ x, name }, i) => {
      const px = u.valToPos(x, "x", true), isLeft = px > left + width - 60 * d;
      g.setLineDash([4 * d, 4 * d]); g.beginPath(); g.moveTo(px, top); g.lineTo(px, top + height); g.stroke();
      g.textAlign = isLeft ? "right" : "left"; g.fillText(name, px + (isLeft ? -4 : 4) * d, top + (11 + 13 * (i % 4)) * d);
    });
    if (this.line) {
      g.setLineDash([4 * d, 4 * d]); g.beginPath();
      for (const [x, y] of this.line) g.lineTo(u.valToPos(x, "x", true), u.valToPos(y, "y", true));
      g.stroke();
    }
    g.restore();
  }
}
