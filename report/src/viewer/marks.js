// Marks: where filament is pulled back, where it is primed again, and where outer walls close, as squares on the lines.

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

/** Boxes that show and hide marks. They are looked for when a box is ticked first. */
function markBoxes(stage, record) {
  const { moves, data } = record, bodies = {};
  let found = null;
  const colours = { retractions: OKABE_ITO.blue, primes: mixed(OKABE_ITO.vermilion, BLACK, 0.25), seams: mixed(WHITE, BLACK, 0.75) };
  const boxes = Object.entries(colours).map(([name, colour]) => {
    const label = check(name, false, isOn => {
      found ??= markedMoves(moves, data.types);
      if (isOn) bodies[name] ??= stage.lines.add(marksAt(moves, found[name], data), colour, MARK_PX);
      stage.setMarks(name, isOn ? bodies[name] : null);
      label.lastChild.textContent = ` ${name}: ${count(found[name].length)}`;
    });
    label.prepend(dot(colour));
    return label;
  });
  return make("div", { className: "legend kinds", role: "group", ariaLabel: "Marks" }, make("span", { textContent: "Marks" }), ...boxes);
}
