// ---- The belt plant, with a line where a motor skipped
if (D.belt) {
  const B = D.belt, colors = ["--accent", "--second", "--cool", "--soft"], marks = B.skips.map(s => s.time_s);
  const skipAt = i => B.skips.filter(s => Math.floor(s.time_s / B.bin_s) === i).map(s => s.text).join(", ");
  const told = (text, i) => [text, skipAt(i)].filter(Boolean).join(" \u00b7 ");
  charts.push({ canvas: $("shares"), out: $("sharesNow"), bin: B.bin_s, marks,
    sets: B.motors.map(({ share }, m) => [share, colors[m % colors.length], null]),
    say: i => told(B.motors.map(({ name, share }) => name + " " + share[i].toFixed(0) + " %").join(" "), i) });
  B.motors.forEach(({ name }, m) => {
    const item = Object.assign(document.createElement("span"), { textContent: name });
    item.prepend(Object.assign(document.createElement("i"), { className: "swatch", style: "background:var(" + colors[m % colors.length] + ")" }));
    $("sharesLegend").append(item);
  });
  if (B.residual_um) charts.push({ canvas: $("residual"), out: $("residualNow"), bin: B.bin_s, marks,
    sets: [[B.residual_um, "--accent", "--accent-soft"]], say: i => told(B.residual_um[i].toFixed(1) + " \u00b5m", i) });
  else $("strain").remove();
} else $("belt").remove();
