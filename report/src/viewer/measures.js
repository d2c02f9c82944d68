// Measures: what the colour of a line says, and its legend.

/** Codes of the palette: a scale up to here, then the special ones. */
const SCALE = 240, UNKNOWN = 254, TRAVEL = 255;
/** A scale spans all but this share of the printed way at either end, so that one short move does not take it. */
const OUTSIDE = 0.002;
/** Values that differ by less than this share are one: times of moves are whole 10 us, so speeds are rounded too. */
const SAME = 0.002;

/** The greatest step rate of any motor in a move, steps/s, or with `isSpeed` the greatest speed of any, in mm/s of its axes. */
function fastestMotor(moves, i, motors, isSpeed) {
  const s = moves.length(i), p = moves.points, k = 4 * i;
  let most = 0;
  for (const motor of motors) {
    const [x, y, z, e] = isSpeed ? motor.row : motor.steps_per_mm;
    const way = s > 0 ? Math.abs(x * (p[k + 4] - p[k]) + y * (p[k + 5] - p[k + 1]) + z * (p[k + 6] - p[k + 2]) + e * moves.e[i]) / s : Math.abs(e);
    most = Math.max(most, way * moves.top[i]);
  }
  return most;
}

function measuresOf(record) {
  const { data, moves, heat } = record;
  const motors = record.motors;
  const hotend = data.heat?.heaters.find(heater => heater.name === "hotend") ?? data.heat?.heaters[0];
  const fan = data.heat?.fans.find(f => !/hotend|controller/.test(f.name));
  const layers = data.by_layer ?? [], layerTimes = layers.map(layer => layer.seconds);
  // Above the layer before. Heights are counted in steps, so the last micrometres say nothing.
  const layerHeights = layers.map((layer, i) => Math.round(100 * (layer.height_mm - (i ? layers[i - 1].height_mm : 0))) / 100);
  const mean = i => { const s = moves.duration(i); return s > 0 ? moves.length(i) / s : 0; };
  const all = [
    { id: "type", name: "Line type", get kinds() { const colours = typeColours(data.types); return data.types.map(({ name }, i) => ({ name, colour: colours[i] })); }, of: i => moves.type[i] },
    { id: "speed", name: "Speed, executed", unit: "mm/s", of: mean },
    { id: "feed", name: "Speed, commanded", unit: "mm/s", of: i => moves.feed[i] },
    { id: "acceleration", name: "Acceleration", unit: "mm/s\u00b2", of: i => moves.acceleration(i) },
    { id: "flow", name: "Flow", unit: "mm\u00b3/s", of: i => moves.flow(i) },
    { id: "width", name: "Line width", unit: "mm", of: i => moves.points[4 * i + 3] },
    hotend && { id: "temperature", name: "Temperature, " + hotend.name, unit: "\u00b0C", of: i => { const bin = heat.bin(moves.begin[i]), v = hotend.high[bin]; return v === null ? NaN : (v + hotend.low[bin]) / 2; } },
    fan && { id: "fan", name: "Fan", unit: "%", of: i => fan.duty.mean[heat.bin(moves.begin[i])] },
    layerTimes.length && { id: "layer", name: "Layer time", unit: "s", hasLog: true, of: i => layerTimes[moves.layer[i]] ?? NaN },
    layerHeights.length && { id: "height", name: "Layer height", unit: "mm", of: i => layerHeights[moves.layer[i]] ?? NaN },
    motors.length && { id: "motor", name: "Motor speed, fastest", unit: "mm/s", of: i => fastestMotor(moves, i, motors, true) },
    motors.length && { id: "rate", name: "Step rate, fastest motor", unit: "steps/s", of: i => fastestMotor(moves, i, motors, false) },
    moves.limit.some(limit => limit > 0) && { id: "limit", name: "What limits the move", kinds: data.limits.map(name => ({ name, colour: LIMIT_COLOURS[name] ?? OKABE_ITO.grey })), of: i => moves.limit[i] },
  ];
  return all.filter(Boolean);
}

/** A measure on a scale of equal factors; `back` makes its values of the scale's. */
const logarithmic = measure => ({ ...measure, of: i => Math.log(measure.of(i)), back: Math.exp });

/** The range of a measure over printed moves: nearly all of their way lies in it. */
function rangeOf(measure, moves, isShown) {
  const n = moves.n, every = Math.max(1, Math.floor(n / 200000)), values = [], ways = [];
  let least = Infinity, most = -Infinity;
  for (let i = 0; i < n; i += every) {
    if (!isShown(i)) continue;
    const v = measure.of(i);
    if (!Number.isFinite(v)) continue;
    values.push(v); ways.push(moves.length(i));
    least = Math.min(least, v); most = Math.max(most, v);
  }
  if (!values.length) return { low: 0, high: 1, least: 0, most: 1 };
  if (most - least <= SAME * Math.max(Math.abs(least), Math.abs(most))) return { low: least, high: Infinity, least, most, isConstant: true };
  // Ways in bins of values: the scale begins and ends where enough of the way has been.
  const BINS = 2048, bins = new Float64Array(BINS), span = most - least || 1;
  let whole = 0;
  values.forEach((v, k) => { bins[Math.min(BINS - 1, Math.floor((v - least) / span * BINS))] += ways[k]; whole += ways[k]; });
  const edge = (from, step) => { let sum = 0, k = from; while (k >= 0 && k < BINS && (sum += bins[k]) <= OUTSIDE * whole) k += step; return k; };
  const low = least + edge(0, 1) / BINS * span, high = least + (edge(BINS - 1, -1) + 1) / BINS * span;
  return whole > 0 && high > low ? { low, high, least, most } : { low: least, high: most, least, most };
}

/** Codes of all moves, and the palette for them. */
function paint(measure, moves, range) {
  const codes = new Uint8Array(moves.n), palette = new Uint8Array(1024);
  const put = (code, colour) => palette.set([...colour, 255], 4 * code);
  if (measure.kinds) {
    measure.kinds.forEach((kind, k) => put(k, kind.colour));
    for (let i = 0; i < moves.n; i++) codes[i] = measure.of(i);
  } else {
    for (let k = 0; k < SCALE; k++) put(k, viridis(k / (SCALE - 1)));
    const times = SCALE / (range.high - range.low);
    for (let i = 0; i < moves.n; i++) {
      const v = measure.of(i);
      codes[i] = v === v ? clamp(Math.floor((v - range.low) * times), 0, SCALE - 1) : UNKNOWN;
    }
  }
  put(UNKNOWN, OKABE_ITO.grey);
  put(TRAVEL, travelColour());
  // What lays nothing is grey, but where its own kind or limit counts.
  const isGrey = !measure.kinds;
  if (isGrey) for (let i = 0; i < moves.n; i++) if (moves.isTravel[moves.type[i]]) codes[i] = TRAVEL;
  return { codes, palette };
}
