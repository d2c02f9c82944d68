// Marks: where filament is pulled back, where it is primed again, where outer walls close, and what the file's text says
// of wipes, pauses and changes, as squares on the lines.

/** A mark is as wide in mm, and at least as wide in px. */
const MARK_MM = 0.7, MARK_PX = 5;
/** It is so much higher than its line, in mm, so that the line does not hide it. */
const ABOVE_MM = 0.05;
/** A wall is closed if its ends are not farther apart, in widths of its line: slicers leave a gap, and wipe over it. */
const CLOSED_WIDTHS = 2;

/** Moves at whose begin there is a mark. */
function markedMoves(moves, types) {
  const retractions = [], primes = [], seams = [], isOuter = types.map(type => type.role === "outer wall");
  const isWall = i => i < moves.n && moves.type[i] !== HIDDEN && isOuter[moves.type[i]] && moves.points[4 * i + 3] > 0;
  const flow = i => i >= 0 && moves.type[i] !== HIDDEN && moves.e[i] && moves.length(i) === 0 ? Math.sign(moves.e[i]) : 0;
  for (let i = 0; i < moves.n; i++) {
    const way = flow(i);
    if (way && way !== flow(i - 1)) (way < 0 ? retractions : primes).push(i);
    if (!isWall(i) || i && isWall(i - 1)) continue;
    let end = i, length = 0;
    while (isWall(end)) length += moves.length(end++);
    const [a, b] = [moves.at(i), moves.at(end)], gap = Math.hypot(a[0] - b[0], a[1] - b[1]), near = CLOSED_WIDTHS * moves.points[4 * i + 3];
    if (gap <= near && length > 3 * near) seams.push(i);
  }
  return { retractions, primes, seams };
}

/** Moves without length at those begins, for the lines of a stage. */
function marksAt(moves, places, data) {
  const marks = new Moves(data, 2 * places.length), p = marks.points;
  places.forEach((i, k) => {
    const [x, y, z] = moves.at(i), layer = moves.layer[i], last = marks.runs[marks.runs.length - 1];
    // The second one leads on to the next mark.
    for (const m of [2 * k, 2 * k + 1]) {
      p.set([x, y, z + ABOVE_MM, MARK_MM], 4 * m);
      marks.begin[m] = moves.begin[i]; marks.layer[m] = layer; marks.type[m] = m % 2 ? HIDDEN : WAY;
    }
    if (last && last.layer === layer) last.end = 2 * k + 2; else marks.runs.push({ first: 2 * k, end: 2 * k + 2, layer });
  });
  marks.n = 2 * places.length;
  return marks;
}

/**
 * What lines of the file stand for. Comments are those of PrusaSlicer and of Orca (Reserved_Tags in GCodeProcessor.cpp
 * of both). Orca has a space and PAUSE_PRINTING. A change of colour is M600, too. The tool counts as changed if its
 * number does.
 */
const LINES = {
  wipes: /^;\s*WIPE_START\b/,
  pauses: /^(?:;\s*PAUSE_PRINT(?:ING)?\b|M(?:0|1|25|125|601)(?!\d|\.))/i,
  "colour changes": /^(?:;\s*COLOR_CHANGE\b|M600(?!\d|\.))/i,
  "tool changes": /^T\d+/i,
  "custom G-code": /^;\s*CUSTOM_GCODE\b/,
};

/** Lines of the file of each kind of `LINES`, in order. */
async function markedLines(chunks, blobs) {
  const found = Object.fromEntries(Object.keys(LINES).map(name => [name, []]));
  let tool = "T0";
  await eachLine(chunks, blobs, (number, words) => {
    for (const [name, sign] of Object.entries(LINES)) {
      const said = sign.exec(words)?.[0].toUpperCase();
      if (!said || name === "tool changes" && said === tool) continue;
      if (name === "tool changes") tool = said;
      found[name].push(number);
    }
  });
  return found;
}

/** The first moves after lines, each once: a comment and its command are at one place. */
function movesAfter(moves, lines) {
  const places = new Set();
  let i = 0;
  for (const line of lines) {
    while (i < moves.n - 1 && moves.line[i] < line) i++;
    places.add(i);
  }
  return [...places];
}

/** The kinds of marks: name, colour, what its pointer says, and whether the text of the file says where they are. */
const MARKS = [
  ["retractions", OKABE_ITO.blue, "Where filament is pulled back"],
  ["primes", mixed(OKABE_ITO.vermilion, BLACK, 0.25), "Where filament is primed again"],
  ["seams", mixed(WHITE, BLACK, 0.75), "Where outer walls close"],
  ["wipes", OKABE_ITO.sky, "Where a wipe begins, by the slicer's comments", true],
  ["pauses", OKABE_ITO.purple, "Where the file asks for a pause: M0, M1, M25, M125, M601, or a comment", true],
  ["colour changes", OKABE_ITO.green, "Where filament of another colour is asked for: M600, or a comment", true],
  ["tool changes", OKABE_ITO.orange, "Where another tool is chosen", true],
  ["custom G-code", OKABE_ITO.grey, "Where lines begin that a user added in the slicer", true],
];

/** Boxes that show and hide marks. They are looked for when a box is ticked first. */
function markBoxes(stage, record, blobs) {
  const { moves, data } = record, chunks = data.gcode_chunks ?? [], bodies = {};
  let ofMoves = null, ofText = null;
  const places = async (name, isOfText) => {
    if (!isOfText) return (ofMoves ??= markedMoves(moves, data.types))[name];
    return movesAfter(moves, (await (ofText ??= markedLines(chunks, blobs)))[name]);
  };
  const boxes = MARKS.filter(([, , , isOfText]) => !isOfText || chunks.length).map(([name, colour, title, isOfText]) => {
    const label = check(name, false, async isOn => {
      const found = await places(name, isOfText);
      if (isOn && found.length) bodies[name] ??= stage.lines.add(marksAt(moves, found, data), colour, MARK_PX);
      stage.setMarks(name, label.box.checked ? bodies[name] ?? null : null);
      label.lastChild.textContent = ` ${name}: ${count(found.length)}`;
    });
    label.title = title;
    label.prepend(dot(colour));
    return label;
  });
  return make("div", { className: "legend kinds", role: "group", ariaLabel: "Marks" }, make("span", { textContent: "Marks" }), ...boxes);
}
