// Path: the real way of the tool, exact to a step, as lines between two times.

/** The type of its printed lines, which no move of a record has: the shader has a bit for each type up to 31. */
const WAY = 30;

/** Reads the stream of a record as moves that have places and times alone. */
async function readPath(data, blobs, each) {
  const rows = data.chunks, capacity = rows.reduce((sum, row) => sum + row[1], 0);
  const moves = new Moves(data, capacity), p = moves.points;
  const travel = Math.max(data.types.findIndex(type => type.role === "travel"), 0);
  let i = 0, rest = performance.now();
  let c = -1;
  for await (const bytes of inOrder(blobs)) {
    if (++c >= rows.length) break;
    const { unsigned, signed } = numbers(bytes), [layer, n] = rows[c], first = i;
    if (performance.now() - rest > 30) { each?.(c / rows.length); await breathe(); rest = performance.now(); }
    let x = 0, y = 0, z = 0, t = 0;
    for (let k = 0; k < n; k++) {
      const dx = signed(), dy = signed(), dz = signed(), v = unsigned(), s = Math.floor(v / 2) * TEN_US;
      // The first place of a chunk is where the last one ended.
      if (k > 0) {
        const isPrinted = v % 2 === 1;
        moves.begin[i] = t; moves.flat[i] = s; moves.layer[i] = layer; moves.type[i] = isPrinted ? WAY : travel;
        p.set([x / 1000, y / 1000, z / 1000, 0], 4 * i);
        i++;
      }
      x += dx; y += dy; z += dz; t += s;
    }
    p.set([x / 1000, y / 1000, z / 1000, 0], 4 * i);
    const last = moves.runs[moves.runs.length - 1];
    if (i > first) { if (last && last.layer === layer) last.end = i; else moves.runs.push({ first, end: i, layer }); }
    moves.n = i;
  }
  return moves;
}
