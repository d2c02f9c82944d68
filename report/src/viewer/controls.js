// Controls: the colours and their legend, layers, moves, and play.

const ICONS = { play: "M3 1l10 6-10 6z", pause: "M2 1h4v12H2zM8 1h4v12H8z" };
function playButton(player) {
  const shape = makeSvg("path"), button = make("button", { className: "play", type: "button" }, makeSvg("svg", { viewBox: "0 0 14 14", "aria-hidden": "true" }, shape));
  const show = () => {
    shape.setAttribute("d", player.playing ? ICONS.pause : ICONS.play);
    button.ariaLabel = player.playing ? "Pause" : "Play";
  };
  button.onclick = () => player.play();
  player.on("play", show);
  show();
  return button;
}
const check = (text, checked, onchange) => {
  const box = make("input", { type: "checkbox", checked });
  box.onchange = () => onchange(box.checked);
  return Object.assign(make("label", {}, box, " " + text), { box });
};

/** Two thumbs on one line, upright next to the picture: the lowest and the highest layer; and the words about them. */
function layerSlider(player, heights) {
  const top = player.layers - 1;
  const thumb = ariaLabel => make("input", { type: "range", min: 0, max: top, step: 1, ariaLabel });
  const low = thumb("Lowest layer"), high = thumb("Highest layer"), out = make("output");
  const single = check("this layer only", false, isSingle => player.setSingle(isSingle));
  const show = () => {
    low.value = player.low; high.value = player.high;
    single.box.checked = player.single;
    const z = i => (heights[i] ?? 0).toFixed(2);
    out.textContent = player.low === player.high ? `${player.low + 1} of ${player.layers}, Z ${z(player.low)} mm` : `${player.low + 1} to ${player.high + 1} of ${player.layers}, Z ${z(player.low)} to ${z(player.high)} mm`;
    high.setAttribute("aria-valuetext", `layer ${player.high + 1}, Z ${z(player.high)} mm`);
    low.setAttribute("aria-valuetext", `layer ${player.low + 1}, Z ${z(player.low)} mm`);
    // The thumb that can move on is on top.
    low.style.zIndex = player.low > top / 2 ? 2 : 1; high.style.zIndex = player.low > top / 2 ? 1 : 2;
  };
  low.oninput = () => { const v = +low.value; if (single.box.checked) player.setLayers(v, v); else player.setLayers(Math.min(v, player.high), player.high); show(); };
  high.oninput = () => { const v = +high.value; if (single.box.checked) player.setLayers(v, v); else player.setLayers(Math.min(player.low, v), v); show(); };
  player.on("layers", show);
  show();
  return { slider: make("div", { className: "layers", hidden: top < 1 }, make("div", { className: "twin" }, low, high)),
    line: make("div", { className: "bar line", hidden: top < 1 }, make("span", { className: "name", textContent: "Layers" }), out, single) };
}

function moveSlider(player, record) {
  const { moves } = record;
  const slider = make("input", { type: "range", step: 1, ariaLabel: "Move" }), out = make("output", { className: "now" });
  const speed = select("Speed of playing", [[0, "in 20 s"], [0.1, "\u00d7 0.1"], [1, "\u00d7 1"], [10, "\u00d7 10"], [100, "\u00d7 100"], [1000, "\u00d7 1000"]], v => { player.speed = +v; });
  const span = () => { [slider.min, slider.max] = player.span(); show(); };
  const { filament: F } = record.data;
  const used = t => { if (!(F?.mm > 0)) return ""; const mm = moves.filament(t); return `${metres(mm)} m, ${(F.g * mm / F.mm).toFixed(2)} g \u00b7 `; };
  const show = () => {
    if (!moves.n) { out.textContent = "no moves"; slider.disabled = true; return; }
    slider.value = player.done;
    const i = player.current, s = player.now - moves.begin[i], [x, y, z] = moves.place(i, moves.share(i, player.now));
    const v = player.now >= moves.whole ? 0 : moves.along(i, s)[1];
    out.textContent = `${clock(player.now)} of ${clock(moves.whole)}, ${clock(moves.whole - player.now)} left \u00b7 ${used(player.now)}move ${count(moves.made(player.done))} of ${count(moves.made(moves.n))} \u00b7 X ${x.toFixed(2)} Y ${y.toFixed(2)} Z ${z.toFixed(2)} mm \u00b7 ${v.toFixed(0)} mm/s`;
    slider.setAttribute("aria-valuetext", `move ${moves.made(player.done)} of ${moves.made(moves.n)}, ${clock(player.now)}`);
  };
  slider.oninput = () => { player.stop(); player.setMove(+slider.value); };
  player.on("layers", span);
  player.on("time", show);
  span();
  return make("div", {}, make("div", { className: "bar line" }, playButton(player), slider, speed), out);
}

/** A swatch of a legend. */
const dot = colour => { const swatch = make("i", { className: "dot" }); swatch.style.background = rgb(colour); return swatch; };

/** The choice of the measure, and its legend. */
function colourBar(record, stage, player) {
  const { moves, data } = record, measures = measuresOf(record);
  // A measure that is asked for before it is known is shown when it is.
  let later = null;
  const legend = make("div", { className: "legend kinds" });
  let measure = measures[0];
  const travels = data.types.reduce((bits, type, k) => type.role === "travel" ? bits | 1 << k : bits, 0);
  const used = new Set(); let anyPrint = false;
  for (let i = 0; i < moves.n; i++) used.add(moves.type[i]);
  for (const k of used) anyPrint ||= k !== HIDDEN && !moves.isTravel[k];
  player.hidden = anyPrint ? travels : 0;
  const hide = (bits, isHidden) => { player.hidden = isHidden ? player.hidden | bits : player.hidden & ~bits; player.tell("hidden"); };
  const isHidden = bits => (player.hidden & bits) !== 0;
  const ways = i => moves.isPrinted(i) && moves.points[4 * i + 3] > 0;
  /** Entries of the legend that follow what is hidden. */
  let syncs = [], before = null;
  const others = k => [...used].reduce((bits, other) => other === HIDDEN || other === k ? bits : bits | 1 << other, 0);
  const isAlone = k => !isHidden(1 << k) && others(k) !== 0 && (player.hidden & others(k)) === others(k);
  /** One type alone; if it is alone already, what was shown before. */
  function showOnly(k) {
    if (isAlone(k)) player.hidden = before ?? 0;
    else { if (![...used].some(isAlone)) before = player.hidden; player.hidden = others(k); }
    player.tell("hidden");
  }
  player.on("hidden", () => { for (const sync of syncs) sync(); travel.box.checked = !isHidden(travels); });
  const log = check("log scale", false, () => show());
  log.title = "Equal steps of colour are equal factors of the time, not equal differences";
  function show() {
    log.hidden = !measure.hasLog;
    syncs = [];
    const scaled = measure.hasLog && log.box.checked ? logarithmic(measure) : measure, back = scaled.back ?? (v => v);
    const range = measure.kinds ? null : rangeOf(scaled, moves, anyPrint ? ways : i => moves.type[i] !== HIDDEN && moves.length(i) > 0);
    stage.lines.paint(stage.body, paint(scaled, moves, range));
    stage.redraw();
    if (!measure.kinds) {
      const scale = make("i", { className: "scale" });
      scale.style.background = rampCss();
      const at = share => back(range.low + (range.high - range.low) * share);
      const ends = v => make("span", { textContent: v });
      const travel = make("span", { hidden: isHidden(travels) }, dot(travelColour()), "travel");
      if (range.isConstant) { legend.replaceChildren(make("span", {}, dot(viridis(0)), short(back(range.least)) + " " + measure.unit + " everywhere"), travel); return; }
      legend.replaceChildren(make("div", { className: "ramped" }, scale, make("div", {}, ...apart([0, 0.25, 0.5, 0.75, 1].map(at)).map((text, k) => ends((k === 0 && range.least < range.low - 1e-9 ? "\u2264 " : k === 4 && range.most > range.high + 1e-9 ? "\u2265 " : "") + text)))), ends(measure.unit), travel);
      return;
    }
    const seconds = new Map(data.by_type?.map(row => [row.type, row.seconds]) ?? []);
    const shares = new Float64Array(measure.kinds.length);
    let whole = 0;
    // Of what is shown, travel too.
    if (measure.id !== "type") for (let i = 0; i < moves.n; i++) { if (moves.type[i] === HIDDEN || isHidden(1 << moves.type[i])) continue; const s = moves.duration(i); shares[measure.of(i)] += s; whole += s; }
    // Travel comes last.
    const isGrey = label => label.isTravel ? 1 : 0;
    legend.replaceChildren(...measure.kinds.map((kind, k) => {
      const swatch = dot(kind.colour);
      if (measure.id !== "type") return shares[k] > 0 ? make("span", {}, swatch, kind.name + " " + (100 * shares[k] / whole).toFixed(shares[k] < 0.1 * whole ? 1 : 0) + " %") : "";
      if (!used.has(k)) return "";
      const label = check(kind.name + (seconds.has(k) ? ", " + clock(seconds.get(k)) : ""), !(player.hidden >>> k & 1), isOn => hide(1 << k, !isOn));
      label.prepend(swatch);
      const alone = pushButton("only", `Show ${kind.name} only; again: what was shown before`, () => showOnly(k));
      const sync = () => { label.box.checked = !isHidden(1 << k); alone.ariaPressed = String(isAlone(k)); };
      syncs.push(sync); sync();
      label.ondblclick = e => { e.preventDefault(); showOnly(k); };
      return Object.assign(make("span", { className: "kind" }, label, alone), { isTravel: moves.isTravel[k] });
    }).sort((a, b) => (measure.id === "type") * (isGrey(a) - isGrey(b))));
  }
  const choice = select("Colour by", measures.map(m => [m.id, m.name]), id => { measure = measures.find(m => m.id === id); show(); });
  onScheme(legend, show);
  const travel = check("travel", !(travels & player.hidden), isOn => { hide(travels, !isOn); show(); });
  travel.hidden = !anyPrint || !travels;
  show();
  const choose = id => {
    const wanted = measures.find(m => m.id === id);
    later = wanted ? null : id ?? null;
    if (wanted) { measure = wanted; choice.value = id; show(); }
  };
  const add = more => {
    measures.push(...more);
    choice.append(...more.map(({ id, name }) => make("option", { value: id, textContent: name })));
    if (later) choose(later);
  };
  return { choice: make("span", { className: "bar" }, log, make("label", {}, "colour", choice)), travel, legend, chosen: -1, choose, add, get id() { return measure.id; }, get name() { return measure.name; } };
}

function viewButtons(stage, player, record, path) {
  const above = pushButton("Above", "From above", () => stage.setAbove(true)), space = pushButton("3D", "In three dimensions", () => stage.setAbove(false));
  const show = () => { above.ariaPressed = String(stage.camera.isAbove); space.ariaPressed = String(!stage.camera.isAbove); };
  player.on("camera", show);
  show();
  const hasSkirt = (record.data.by_type ?? []).some(({ role, moves }) => moves > 0 && (role === "skirt" || role === "purge"));
  const skirt = check("fit skirt and purge", false, isOn => { stage.withSkirt = isOn; stage.refit(); });
  skirt.hidden = !hasSkirt;
  const way = check("real way", false, isOn => stage.setWay(isOn, path));
  way.title = "The way of the tool by its steps, exact to a step, above the planned moves";
  way.hidden = !path?.length || !record.moves.n;
  return [buttonGroup("View", above, space),
    buttonGroup("Zoom", pushButton("\u2212", "Zoom out", () => { stage.camera.zoom(0.7); stage.redraw(); }), pushButton("+", "Zoom in", () => { stage.camera.zoom(1 / 0.7); stage.redraw(); }), pushButton("Fit", "Show the whole print", () => stage.fit())), skirt, way];
}

/** The same keys on picture, charts and text. */
function keyboard(root, stage, player) {
  // Another record in the same element has its own keys.
  root.onkeydown = e => {
    if (e.ctrlKey || e.metaKey || /^(INPUT|SELECT|TEXTAREA|BUTTON|SUMMARY|A)$/.test(e.target.tagName) || e.defaultPrevented) return;
    const far = e.shiftKey ? 100 : 1, { camera } = stage;
    const seen = f => () => { f(); stage.redraw(true); player.tell("camera"); };
    const actions = {
      ArrowRight: e.altKey ? seen(() => camera.pan(-40, 0)) : () => player.step(far), ArrowLeft: e.altKey ? seen(() => camera.pan(40, 0)) : () => player.step(-far),
      ArrowUp: e.altKey ? seen(() => camera.pan(0, 40)) : () => layer(1), ArrowDown: e.altKey ? seen(() => camera.pan(0, -40)) : () => layer(-1),
      Home: () => player.setMove(player.span()[0]), End: () => player.setMove(player.span()[1]), " ": () => player.play(),
      "+": seen(() => camera.zoom(1.25)), "=": seen(() => camera.zoom(1.25)), "-": seen(() => camera.zoom(0.8)), 0: () => stage.fit(), f: () => stage.fit(),
      3: () => stage.setAbove(!camera.isAbove), "[": seen(() => camera.orbit(25, 0)), "]": seen(() => camera.orbit(-25, 0)), PageUp: seen(() => camera.orbit(0, 15)), PageDown: seen(() => camera.orbit(0, -15)),
    };
    const layer = by => { const to = clamp(player.high + by, 0, player.layers - 1); player.setLayers(player.single ? to : Math.min(player.low, to), to); };
    const action = actions[e.key];
    if (!action) return;
    e.preventDefault();
    action();
  };
}
