// Camera: where a place in mm is on the screen, and the grid below. Parallel lines stay parallel, so a mm is as long
// everywhere.

class Camera {
  constructor() { Object.assign(this, { width: 1, height: 1, centre: [0, 0, 0], scale: 1, azimuth: 0, elevation: 90 }); }
  /** Rows to the right, up and to the eye. */
  rows() {
    const a = this.azimuth * Math.PI / 180, e = this.elevation * Math.PI / 180;
    const [ca, sa, ce, se] = [Math.cos(a), Math.sin(a), Math.cos(e), Math.sin(e)];
    return [[ca, sa, 0], [-sa * se, ca * se, ce], [sa * ce, -ca * ce, se]];
  }
  /** px from the left and from the top. */
  toScreen(p) {
    const [right, up] = this.rows(), d = p.map((v, i) => v - this.centre[i]);
    const along = row => row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
    return [this.width / 2 + along(right) * this.scale, this.height / 2 - along(up) * this.scale];
  }
  /** The place at height z that is seen at a pixel; null from the side. */
  toPlane(x, y, z) {
    const [right, up] = this.rows(), a = (x - this.width / 2) / this.scale, b = (this.height / 2 - y) / this.scale - up[2] * (z - this.centre[2]);
    const whole = right[0] * up[1] - right[1] * up[0];
    if (Math.abs(whole) < 1e-6) return null;
    return [this.centre[0] + (a * up[1] - b * right[1]) / whole, this.centre[1] + (b * right[0] - a * up[0]) / whole, z];
  }
  pan(dx, dy) {
    const [right, up] = this.rows();
    this.centre = this.centre.map((v, i) => v + (-dx * right[i] + dy * up[i]) / this.scale);
  }
  /** Zooms so that the place under a pixel stays there. */
  zoom(times, x = this.width / 2, y = this.height / 2) {
    const scale = clamp(this.scale * times, 0.02, 40000), r = scale / this.scale;
    this.pan((x - this.width / 2) * (1 - 1 / r), (y - this.height / 2) * (1 - 1 / r));
    this.scale = scale;
  }
  orbit(dx, dy) {
    this.azimuth = (this.azimuth - dx * 0.4 + 360) % 360;
    this.elevation = clamp(this.elevation + dy * 0.4, 0, 90);
  }
  /** The view in one word: another one shows something else, or from elsewhere. */
  get view() { return [...this.centre, this.scale, this.azimuth, this.elevation].join(" "); }
  get isAbove() { return this.elevation === 90 && this.azimuth === 0; }
  /** Shows a box: least and greatest x, y, z. */
  fit([least, most]) {
    const [right, up] = this.rows();
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(k => [0, 1, 2].map(i => (k >> i & 1 ? most : least)[i]));
    const span = row => { const v = corners.map(c => row[0] * c[0] + row[1] * c[1] + row[2] * c[2]); return Math.max(...v) - Math.min(...v); };
    const margin = Math.min(48, this.width / 10);
    this.scale = Math.min((this.width - 2 * margin) / Math.max(span(right), 2), (this.height - 2 * margin) / Math.max(span(up), 2));
    this.centre = least.map((v, i) => (v + most[i]) / 2);
  }
}

/** A grid in mm at z = 0 and the reach of the machine: ranges of x and of y. */
function drawGrid(g, camera, [[left, right], [front, back]]) {
  const { width: w, height: h, isAbove } = camera, step = nice(70 / camera.scale);
  g.font = "11px system-ui, sans-serif"; g.lineWidth = 1; g.strokeStyle = css("--grid"); g.fillStyle = css("--soft"); g.textAlign = "left";
  const grid = new Path2D(), line = (a, b) => { grid.moveTo(...camera.toScreen(a)); grid.lineTo(...camera.toScreen(b)); };
  // In three dimensions the grid ends at the reach, seen from above it fills the picture.
  const corners = [[0, 0], [w, 0], [0, h], [w, h]].map(([x, y]) => camera.toPlane(x, y, 0)).filter(Boolean);
  const span = (axis, low, high) => isAbove && corners.length ? [Math.min(...corners.map(c => c[axis])), Math.max(...corners.map(c => c[axis]))] : [low, high];
  const [x0, x1] = span(0, left, right), [y0, y1] = span(1, front, back), text = v => String(+v.toFixed(4));
  if ((x1 - x0) / step < 400 && (y1 - y0) / step < 400) {
    for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) { line([x, y0, 0], [x, y1, 0]); const at = camera.toScreen([x, y0, 0])[0] + 4; if (isAbove && at < w - 48) g.fillText(text(x), at, h - 6); }
    for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) { line([x0, y, 0], [x1, y, 0]); if (isAbove) g.fillText(text(y), 5, camera.toScreen([x0, y, 0])[1] - 4); }
  }
  g.stroke(grid);
  if (isAbove) { g.textAlign = "right"; g.fillText("mm", w - 6, h - 6); g.textAlign = "left"; }
  const edge = new Path2D();
  [[left, front], [right, front], [right, back], [left, back]].forEach(([x, y], i) => edge[i ? "lineTo" : "moveTo"](...camera.toScreen([x, y, 0])));
  edge.closePath();
  g.strokeStyle = css("--travel"); g.setLineDash([4, 4]); g.stroke(edge); g.setLineDash([]);
}
