// ---- The mesh: its surface from above, with the measured points and their heights
const M = S.mesh;
/** Height in mm at a place on the grid, by the firmware's law: Catmull-Rom, with a ring of straight lines around. */
function meshHeight(u, v) {
  const along = (line, t) => {
    const last = line.length - 1, i = Math.min(Math.floor(t), last - 1), f = t - i;
    const at = k => k < 0 ? 2 * line[0] - line[1] : k > last ? 2 * line[last] - line[last - 1] : line[k];
    const [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
    return .5 * (2 * b + f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a))));
  };
  return along(M.heights_mm.map(row => along(row, u)), v);
}
const signedMm = (v, digits = 3) => (v < 0 ? "\u2212" : "+") + Math.abs(v).toFixed(digits);
/** Its picture, a dot every few px. */
let meshPicture = null;
const MESH_DOTS = 96;
// The whole range, so that the heights of all points lie on it; the surface may go a little beyond.
const meshColor = z => viridis(M.range_mm > 0 ? Math.min(Math.max((z - M.least_mm) / M.range_mm, 0), 1) : .5);
function viridis(share) {
  const f = share * 9, k = Math.min(8, Math.floor(f)), r = f - k;
  return VIRIDIS[k].map((c, j) => Math.round(c + (VIRIDIS[k + 1][j] - c) * r));
}
function paintMesh() {
  meshPicture = Object.assign(document.createElement("canvas"), { width: MESH_DOTS, height: MESH_DOTS });
  const g = meshPicture.getContext("2d"), image = g.createImageData(MESH_DOTS, MESH_DOTS);
  for (let j = 0; j < MESH_DOTS; j++) for (let i = 0; i < MESH_DOTS; i++) {
    const part = k => k / (MESH_DOTS - 1);
    const z = meshHeight(part(i) * (M.columns - 1), (1 - part(j)) * (M.rows - 1));
    image.data.set([...meshColor(z), 255], 4 * (j * MESH_DOTS + i));
  }
  g.putImageData(image, 0, 0);
}
/** Where the mesh lies in its canvas. */
function meshBox(w, h) {
  const wide = M.x_mm[1] - M.x_mm[0], deep = M.y_mm[1] - M.y_mm[0];
  const k = Math.min((w - 76) / wide, (h - 66) / deep);
  return { k, x: (w - wide * k) / 2 + 14, y: (h - deep * k) / 2 - 6, w: wide * k, h: deep * k };
}
function drawMesh() {
  const { g, w, h } = surface($("meshMap")), box = meshBox(w, h);
  g.clearRect(0, 0, w, h);
  if (box.k <= 0) return;
  g.imageSmoothingEnabled = true; g.imageSmoothingQuality = "high";
  g.drawImage(meshPicture, box.x, box.y, box.w, box.h);
  g.font = "11px system-ui, sans-serif";
  const room = box.w / (M.columns - 1), fits = room > 46 && box.h / (M.rows - 1) > 26, digits = room > 66 ? 3 : 2;
  M.heights_mm.forEach((row, j) => row.forEach((z, i) => {
    const x = box.x + box.w * i / (M.columns - 1), y = box.y + box.h * (1 - j / (M.rows - 1));
    const [r, gr, b] = meshColor(z), ink = .299 * r + .587 * gr + .114 * b > 140 ? "#101418" : "#ffffff";
    g.strokeStyle = ink; g.fillStyle = ink; g.lineWidth = 1.5;
    g.beginPath(); g.arc(x, y, 3, 0, 7); g.stroke();
    if (!fits) return;
    // Inside of the picture, whatever side the point is at.
    g.textAlign = i === 0 ? "left" : i === M.columns - 1 ? "right" : "center";
    g.fillText(signedMm(z, digits), x + (i === 0 ? 4 : i === M.columns - 1 ? -4 : 0), j === M.rows - 1 ? y + 15 : y - 7);
  }));
  g.fillStyle = css("--soft");
  g.textAlign = "center";
  const every = (n, room) => Math.max(1, Math.ceil(n * 34 / room));
  for (let i = 0; i < M.columns; i += every(M.columns, box.w)) g.fillText((M.x_mm[0] + (M.x_mm[1] - M.x_mm[0]) * i / (M.columns - 1)).toFixed(0), box.x + box.w * i / (M.columns - 1), box.y + box.h + 16);
  g.fillText("X, mm", box.x + box.w / 2, box.y + box.h + 32);
  g.textAlign = "right";
  for (let j = 0; j < M.rows; j += every(M.rows, box.h * 2)) g.fillText((M.y_mm[0] + (M.y_mm[1] - M.y_mm[0]) * j / (M.rows - 1)).toFixed(0), box.x - 9, box.y + box.h * (1 - j / (M.rows - 1)) + 4);
  g.save(); g.translate(Math.max(box.x - 40, 10), box.y + box.h / 2); g.rotate(-Math.PI / 2); g.textAlign = "center"; g.fillText("Y, mm", 0, 0); g.restore();
}
if (M) {
  paintMesh();
  const ramp = $("meshRamp");
  ramp.width = 64; ramp.height = 1;
  for (let i = 0; i < 64; i++) { const g = ramp.getContext("2d"); g.fillStyle = "rgb(" + viridis(i / 63) + ")"; g.fillRect(i, 0, 1, 1); }
  $("meshLeast").textContent = signedMm(M.least_mm) + " mm";
  $("meshMost").textContent = signedMm(M.greatest_mm) + " mm";
  $("meshMap").setAttribute("aria-label", "Heights of the mesh, " + signedMm(M.least_mm) + " to " + signedMm(M.greatest_mm) + " mm");
  const off = e => "rms " + e.rms_after_mm.toFixed(4) + ", at most " + e.max_after_mm.toFixed(4) + " mm; without mesh " + e.rms_before_mm.toFixed(4) + ", " + e.max_before_mm.toFixed(4) + " mm";
  for (const [name, value] of [
    ["Points", M.columns + " by " + M.rows],
    ["Range", M.range_mm.toFixed(3) + " mm"],
    ["Mean", signedMm(M.mean_mm) + " mm"],
    ["Fade", M.fade_height_mm === null ? "none" : "to the mean at Z" + M.fade_height_mm],
    ["Correction of z", signedMm(M.least_correction_mm) + " to " + signedMm(M.greatest_correction_mm) + " mm"],
    ["Steps of z added", count(M.z_steps_added)],
    ["Moves that z's limits slow", count(M.slowed_moves)],
    ["First layer's height is off by", M.first_layer ? off(M.first_layer) : "no first layer on a bed that is known"],
    ["Mesh is off the bed by", M.bed_error ? off(M.bed_error) : "the bed is not known"],
  ]) {
    const row = $("meshFigures").insertRow();
    row.insertCell().textContent = name; row.insertCell().textContent = value;
  }
  const read = e => {
    const { w, h } = surface($("meshMap")), box = meshBox(w, h), u = (e.offsetX - box.x) / box.w, v = 1 - (e.offsetY - box.y) / box.h;
    const isIn = u >= 0 && u <= 1 && v >= 0 && v <= 1;
    const at = (ends, part) => (ends[0] + (ends[1] - ends[0]) * part).toFixed(1);
    $("meshNow").textContent = isIn ? "X " + at(M.x_mm, u) + "  Y " + at(M.y_mm, v) + " \u00b7 " + signedMm(meshHeight(u * (M.columns - 1), v * (M.rows - 1))) + " mm" : "";
  };
  $("meshMap").addEventListener("pointermove", read);
  $("meshMap").addEventListener("pointerdown", read);
  $("meshMap").addEventListener("pointerleave", () => { $("meshNow").textContent = ""; });
  isDark.addEventListener("change", drawMesh);
  new ResizeObserver(drawMesh).observe($("meshMap"));
} else $("mesh").remove();
