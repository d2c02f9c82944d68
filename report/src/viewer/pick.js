// Pick: the move under the pointer, by the boxes of small runs of moves.

const BOX = 256;
class Picker {
  constructor(moves) {
    this.moves = moves;
    const boxes = Math.ceil(moves.n / BOX);
    /** Middle and radius in mm. */
    this.balls = new Float32Array(4 * boxes);
    for (let b = 0; b < boxes; b++) {
      const least = [Infinity, Infinity, Infinity], most = [-Infinity, -Infinity, -Infinity];
      for (let i = b * BOX; i <= Math.min((b + 1) * BOX, moves.n); i++) for (let axis = 0; axis < 3; axis++) {
        const v = moves.points[4 * i + axis];
        if (v < least[axis]) least[axis] = v;
        if (v > most[axis]) most[axis] = v;
      }
      this.balls.set([...least.map((v, axis) => (v + most[axis]) / 2), Math.hypot(...most.map((v, axis) => v - least[axis])) / 2], 4 * b);
    }
  }
  /** The nearest to the eye of the lines under a pixel, or the one nearest to it; -1 if all are far. */
  at(px, py, camera, runs, hidden) {
    const { moves, balls } = this, p = moves.points, [right, up, eye] = camera.rows(), s = camera.scale, c = camera.centre;
    const NEAR = 5;
    const x = (px - camera.width / 2) / s, y = (camera.height / 2 - py) / s;
    const along = (row, k) => row[0] * (p[k] - c[0]) + row[1] * (p[k + 1] - c[1]) + row[2] * (p[k + 2] - c[2]);
    let best = -1, bestDepth = -Infinity, bestOff = NEAR / s;
    for (const [first, end] of runs) {
      for (let i = first; i < end;) {
        const b = Math.floor(i / BOX), to = Math.min(end, (b + 1) * BOX), q = 4 * b;
        const d = [balls[q] - c[0], balls[q + 1] - c[1], balls[q + 2] - c[2]];
        const bx = right[0] * d[0] + right[1] * d[1] + right[2] * d[2], by = up[0] * d[0] + up[1] * d[1] + up[2] * d[2];
        if (Math.hypot(bx - x, by - y) > balls[q + 3] + 2 + NEAR / s) { i = to; continue; }
        for (; i < to; i++) {
          if (moves.type[i] > 31 || hidden >>> moves.type[i] & 1) continue;
          const k = 4 * i, ax = along(right, k), ay = along(up, k), ux = along(right, k + 4) - ax, uy = along(up, k + 4) - ay;
          const square = ux * ux + uy * uy, share = square > 0 ? clamp(((x - ax) * ux + (y - ay) * uy) / square, 0, 1) : 0;
          const off = Math.max(Math.hypot(ax + share * ux - x, ay + share * uy - y) - Math.max(p[k + 3], 1 / s) / 2, 0);
          if (off > bestOff) continue;
          const depth = along(eye, k) + (along(eye, k + 4) - along(eye, k)) * share;
          if (off < bestOff || depth >= bestDepth - 1e-4) { best = i; bestDepth = depth; bestOff = off; }
        }
      }
    }
    return best;
  }
}
