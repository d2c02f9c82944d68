// Mesh: the bed's surface from above, with the measured points and their heights, and what it did.

class Mesh {
  constructor(M) { this.M = M; }
  /** Height in mm at a place on the grid, by the firmware's law: Catmull-Rom, with a ring of straight lines around. */
  height(u, v) {
    const along = (line, t) => {
      const last = line.length - 1, i = Math.min(Math.floor(t), last - 1), f = t - i;
      const at = k => k < 0 ? 2 * line[0] - line[1] : k > last ? 2 * line[last] - line[last - 1] : line[k];
      const [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
      return 0.5 * (2 * b + f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a))));
    };
    return along(this.M.heights_mm.map(row => along(row, u)), v);
  }
  // The whole range, so that the heights of all points lie on it; the surface may go a little beyond.
  colour(z) { return viridis(this.M.range_mm > 0 ? (z - this.M.least_mm) / this.M.range_mm : 0.5); }
}
const signedMm = (v, digits = 3) => (v < 0 ? "\u2212" : "+") + Math.abs(v).toFixed(digits);

function meshCards(record) {
  const M = record.data.summary.mesh;
  if (!M) return "";
  const mesh = new Mesh(M), canvas = make("canvas", { role: "img" }), out = make("output"), scale = make("i", { className: "scale" });
  canvas.ariaLabel = `Heights of the mesh, ${signedMm(M.least_mm)} to ${signedMm(M.greatest_mm)} mm`;
  const box = (w, h) => {
    const wide = M.x_mm[1] - M.x_mm[0], deep = M.y_mm[1] - M.y_mm[0], k = Math.min((w - 76) / wide, (h - 66) / deep);
    return { k, x: (w - wide * k) / 2 + 14, y: (h - deep * k) / 2 - 6, w: wide * k, h: deep * k };
  };
  function picture() {
    const DOTS = 96, image = make("canvas", { width: DOTS, height: DOTS }), g = image.getContext("2d", { willReadFrequently: true }), data = g.createImageData(DOTS, DOTS), part = k => k / (DOTS - 1);
    for (let j = 0; j < DOTS; j++) for (let i = 0; i < DOTS; i++) data.data.set([...mesh.colour(mesh.height(part(i) * (M.columns - 1), (1 - part(j)) * (M.rows - 1))), 255], 4 * (j * DOTS + i));
    g.putImageData(data, 0, 0);
    return image;
  }
  function draw() {
    const w = canvas.clientWidth, h = canvas.clientHeight, ratio = devicePixelRatio || 1, B = box(w, h), g = canvas.getContext("2d", { willReadFrequently: true });
    canvas.width = w * ratio; canvas.height = h * ratio;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (B.k <= 0) return;
    g.imageSmoothingQuality = "high";
    g.drawImage(picture(), B.x, B.y, B.w, B.h);
    g.font = "11px system-ui, sans-serif";
    const room = B.w / (M.columns - 1), fits = room > 46 && B.h / (M.rows - 1) > 26, digits = room > 66 ? 3 : 2, part = (ends, i, n) => ends[0] + (ends[1] - ends[0]) * i / (n - 1);
    M.heights_mm.forEach((row, j) => row.forEach((z, i) => {
      const x = B.x + B.w * i / (M.columns - 1), y = B.y + B.h * (1 - j / (M.rows - 1)), [r, gr, b] = mesh.colour(z);
      g.strokeStyle = g.fillStyle = 0.299 * r + 0.587 * gr + 0.114 * b > 140 ? "#101418" : "#ffffff"; g.lineWidth = 1.5;
      g.beginPath(); g.arc(x, y, 3, 0, 7); g.stroke();
      if (!fits) return;
      // Inside of the picture, whatever side the point is at.
      g.textAlign = i === 0 ? "left" : i === M.columns - 1 ? "right" : "center";
      g.fillText(signedMm(z, digits), x + (i === 0 ? 4 : i === M.columns - 1 ? -4 : 0), j === M.rows - 1 ? y + 15 : y - 7);
    }));
    g.fillStyle = css("--soft"); g.textAlign = "center";
    const every = (n, room) => Math.max(1, Math.ceil(n * 34 / room));
    for (let i = 0; i < M.columns; i += every(M.columns, B.w)) g.fillText(part(M.x_mm, i, M.columns).toFixed(0), B.x + B.w * i / (M.columns - 1), B.y + B.h + 16);
    g.fillText("X, mm", B.x + B.w / 2, B.y + B.h + 32);
    g.textAlign = "right";
    for (let j = 0; j < M.rows; j += every(M.rows, B.h * 2)) g.fillText(part(M.y_mm, j, M.rows).toFixed(0), B.x - 9, B.y + B.h * (1 - j / (M.rows - 1)) + 4);
    g.save(); g.translate(Math.max(B.x - 40, 10), B.y + B.h / 2); g.rotate(-Math.PI / 2); g.textAlign = "center"; g.fillText("Y, mm", 0, 0); g.restore();
  }
  const paint = () => { scale.style.background = rampCss(); draw(); };
  const read = e => {
    const B = box(canvas.clientWidth, canvas.clientHeight), u = (e.offsetX - B.x) / B.w, v = 1 - (e.offsetY - B.y) / B.h, at = (ends, share) => (ends[0] + (ends[1] - ends[0]) * share).toFixed(1);
    out.textContent = u >= 0 && u <= 1 && v >= 0 && v <= 1 ? `X ${at(M.x_mm, u)}  Y ${at(M.y_mm, v)} \u00b7 ${signedMm(mesh.height(u * (M.columns - 1), v * (M.rows - 1)))} mm` : "";
  };
  for (const name of ["pointermove", "pointerdown"]) canvas.addEventListener(name, read);
  canvas.addEventListener("pointerleave", () => { out.textContent = ""; });
  onScheme(canvas, paint);
  new ResizeObserver(paint).observe(canvas);
  const off = e => `rms ${e.rms_after_mm.toFixed(4)}, at most ${e.max_after_mm.toFixed(4)} mm; without mesh ${e.rms_before_mm.toFixed(4)}, ${e.max_before_mm.toFixed(4)} mm`;
  const rows = [
    ["Points", M.columns + " by " + M.rows], ["Range", M.range_mm.toFixed(3) + " mm"], ["Mean", signedMm(M.mean_mm) + " mm"],
    ["Fade", M.fade_height_mm === null ? "none" : "to the mean at Z" + M.fade_height_mm],
    ["Correction of z", signedMm(M.least_correction_mm) + " to " + signedMm(M.greatest_correction_mm) + " mm"],
    ["Steps of z added", count(M.z_steps_added)], ["Moves that z's limits slow", count(M.slowed_moves)],
    ["First layer's height is off by", M.first_layer ? off(M.first_layer) : "no first layer on a bed that is known"],
    ["Mesh is off the bed by", M.bed_error ? off(M.bed_error) : "the bed is not known"],
  ];
  const legend = make("span", { className: "legend" }, signedMm(M.least_mm) + " mm", scale, signedMm(M.greatest_mm) + " mm", make("span", { textContent: "\u25cb point" }));
  const map = make("section", { className: "card panel", ariaLabel: "Mesh of the bed" }, make("div", { className: "bar" }, make("h2", { textContent: "Mesh of the bed" }), legend, make("span", { className: "grow" }), out), make("div", { className: "map" }, canvas));
  return make("section", { className: "pair" }, map, card("Its effect", table(["", ""], rows, "figures")));
}
