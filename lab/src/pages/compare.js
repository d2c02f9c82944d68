// The page of `corehbot-lab compare`.

const { answer: A, names } = D, runs = A.runs ?? [];

/** A row: its name, the figure of each machine (or its least and greatest), digits, and whether more is better (1), less (-1) or neither (0). */
function figures(of, rows) {
  return table(["", ...names], rows.map(([name, figure, digits, better]) => {
    // Less than the last digit is what rounding left.
    const all = of.map(figure).map(v => [v].flat().map(x => Math.abs(x) < 0.5 * 10 ** -digits ? 0 : x)), judged = all.map(v => better > 0 ? v[0] : v[v.length - 1]);
    const most = Math.max(...all.flat().map(Math.abs)), best = better > 0 ? Math.max(...judged) : Math.min(...judged), isTie = most === 0 || judged.every(v => Math.abs(v - best) < 0.005 * most);
    return [name, ...all.map((v, i) => {
      const isBest = better && !isTie && Math.abs(judged[i] - best) < 0.005 * most, bar = (x, k) => { const e = make("i", { className: v.length > 1 && k === 0 ? "low" : "" }); e.style.width = `${100 * Math.abs(x) / most}%`; return e; };
      return make("div", { className: isBest ? "best" : "" }, make("b", { textContent: v.map(x => x.toFixed(digits)).join(" \u2013 ") + (isBest ? " \u2713" : "") }), ...(most > 0 ? v.map(bar) : []));
    })];
  }), "figures sides");
}
// What belts take, and with the rotors.
const torque = t => [t.belts_mNm_per_m_s2, t.belts_mNm_per_m_s2 + t.rotors_mNm_per_m_s2].map(Math.abs);
const area = figures(A.machines, [
  ["Belt, mm", m => m.belt_mm, 0, -1],
  ["Reach of the tool, cm\u00b2", m => m.reach_mm2 / 100, 0, 1],
  ["Stiffness in the middle along x, N/mm", m => m.centre_N_per_mm[0], 1, 1],
  ["Stiffness in the middle along y, N/mm", m => m.centre_N_per_mm[1], 1, 1],
  ["Softest direction, at the softest and the stiffest place, N/mm", m => m.softest_N_per_mm, 1, 1],
  [A.force_N + " N move the tool by at most, \u00b5m", m => m.deflection_um, 1, -1],
  ["Greatest stiffness between x and y, N/mm", m => m.coupling_N_per_mm, 1, -1],
  ["First mode, slowest and fastest, Hz", m => m.first_mode_Hz, 1, 1],
  ["Belts resist yaw of the bar with, N m/rad", m => m.belt_yaw_stiffness_Nm_per_rad, 0, 1],
  ["Racking takes the tool aside for 1 m/s\u00b2 of x, \u00b5m", m => m.racking_x_um_per_m_s2, 1, -1],
  ["Racking takes the tool aside for 1 m/s\u00b2 of y, \u00b5m", m => m.racking_y_um_per_m_s2, 1, -1],
  ["Torque of all motors on the frame for 1 m/s\u00b2 of x, mN m", m => torque(m.frame_torque_x), 2, -1],
  ["The same as the paper prints it, mN m", m => m.frame_torque_x.printed_mNm_per_m_s2, 2, 0],
  ["Torque of all motors on the frame for 1 m/s\u00b2 of y, mN m", m => torque(m.frame_torque_y), 2, -1],
  ...(A.machines[0].frame_modes_Hz ? [["Soft frame, in x and in y, Hz", m => m.frame_modes_Hz, 1, 0]] : []),
]);
const slips = r => r.motors.reduce((sum, m) => sum + m.slips, 0);
const played = () => figures(runs, [
  ["Greatest contour error, \u00b5m", r => 1000 * r.contour.max_mm, 1, -1],
  ["RMS contour error, \u00b5m", r => 1000 * r.contour.rms_mm, 2, -1],
  ["Inside of corners, \u00b5m", r => 1000 * r.contour.rounding_max_mm, 1, -1],
  ["Outside of corners, \u00b5m", r => 1000 * r.contour.overshoot_max_mm, 1, -1],
  ["Greatest torque of a motor, mN m", r => Math.max(...r.motors.map(m => m.torque_max_mNm)), 1, -1],
  ["Slips", slips, 0, -1],
  ["Greatest yaw torque on the guides, N m", r => r.yaw_torque_Nm, 3, -1],
  ["Greatest torque of all motors on the frame, mN m", r => 1000 * r.frame_torque_Nm, 1, -1],
  ...(runs[0].frame_mm ? [["The frame moves in x and in y by at most, \u00b5m", r => r.frame_mm.map(v => 1000 * v), 1, 0]] : []),
]);
const ratio = (f, a, b) => (f(a) / f(b)).toFixed(2) + " times", [core, hbot, corexy] = A.machines, spread = m => percent(m.first_mode_Hz[1] / m.first_mode_Hz[0] - 1);
const words = [
  `In its softest direction at its softest place the CoreH-bot is ${ratio(m => m.softest_N_per_mm[0], core, corexy)} as stiff as a CoreXY and ${ratio(m => m.softest_N_per_mm[0], core, hbot)} as an H-bot.`,
  `Its first mode changes by ${spread(core)} over the area, that of a CoreXY by ${spread(corexy)}, of an H-bot by ${spread(hbot)}.`,
  `Its belts hold the bar square with ${core.belt_yaw_stiffness_Nm_per_rad.toFixed(0)} N m/rad, those of a CoreXY with ${corexy.belt_yaw_stiffness_Nm_per_rad.toFixed(0)}: the guides must do it.`,
  ...(runs.length ? [`On the file its RMS error is ${ratio(r => r.contour.rms_mm, runs[0], runs[2])} that of a CoreXY and ${ratio(r => r.contour.rms_mm, runs[0], runs[1])} that of an H-bot.`] : []),
];
const slipped = runs.map((run, i) => [names[i], slips(run)]).filter(([, n]) => n);
show("Three mechanisms of one size",
  heading("Three mechanisms of one size", "one belt, the same masses and pulleys; \u2713 marks the best one"),
  slipped.length > 0 && alertCard("Motors slipped", [["Which", slipped.map(([name, n]) => `${name}: ${n}`).join(", ")], ["What to do", "compare at a lower acceleration: what is measured after a slip is that of a lost position"]]),
  card(`Over x ${A.x_mm.map(v => v.toFixed(1)).join(" to ")}, y ${A.y_mm.map(v => v.toFixed(1)).join(" to ")} mm, which all of them reach`, area),
  runs.length > 0 && card(`On ${fileName(D.file)}, ${runs[0].duration_s.toFixed(1)} s, ${runs[0].model} model`, played()),
  card("What it says", make("ul", { className: "prose" }, ...words.map(textContent => make("li", { textContent })))));
