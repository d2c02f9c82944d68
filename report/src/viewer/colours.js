// Colours: scales and sets that people with any colour vision can tell apart.

/** Viridis at tenths (van der Walt and Smith, 2015); a dark page leaves the darkest fifth out, a light one the lightest. */
const VIRIDIS = [[68, 1, 84], [72, 40, 120], [62, 73, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37]];
/** Okabe and Ito, Color Universal Design (2008). */
const OKABE_ITO = { orange: [230, 159, 0], sky: [86, 180, 233], green: [0, 158, 115], yellow: [240, 228, 66], blue: [0, 114, 178], vermilion: [213, 94, 0], purple: [204, 121, 167], grey: [150, 150, 150] };
const darkScheme = matchMedia("(prefers-color-scheme: dark)");
/** What is drawn by the colours of the page, and what is turned for paper; each with the element that it is in. */
const painted = new Map(), turned = new Map();
function callAll(all, ...words) {
  for (const [each, element] of all) if (element.isConnected) each(...words); else all.delete(each);
}
/** Calls when the page gets dark or light, as long as an element is in it; for paper too, unless the element turns itself. */
function onScheme(element, each) { painted.set(each, element); }
/** Calls with true before the page is printed, and with false afterwards. */
function onPaper(element, turn) { turned.set(turn, element); }
const isPaper = () => document.documentElement.classList.contains("paper");
/** Paper is light: before a dark page is printed, it is drawn with light colours, and afterwards as it was. */
const isDark = () => darkScheme.matches && !isPaper();
darkScheme.addEventListener("change", () => callAll(painted));
for (const [name, isOn] of [["beforeprint", true], ["afterprint", false]]) addEventListener(name, () => {
  document.documentElement.classList.toggle("paper", isOn);
  const own = new Set(turned.values());
  if (darkScheme.matches) callAll(new Map([...painted].filter(([, element]) => !own.has(element))));
  callAll(turned, isOn);
});
const rgb = c => "rgb(" + c.join(",") + ")";
function viridis(share) {
  const [from, to] = isDark() ? [0.2, 1] : [0, 0.86];
  const f = (from + (to - from) * clamp(share, 0, 1)) * 9, k = Math.min(8, Math.floor(f)), r = f - k;
  return VIRIDIS[k].map((c, j) => Math.round(c + (VIRIDIS[k + 1][j] - c) * r));
}
/** The scale as a background, from its least to its greatest. */
const rampCss = () => `linear-gradient(to right, ${[0, 1, 2, 3, 4, 5, 6, 7, 8].map(k => rgb(viridis(k / 8))).join(",")})`;
/** Between a colour and white or black. */
const mixed = (c, other, share) => c.map((v, i) => Math.round(v + (other[i] - v) * share));
const WHITE = [255, 255, 255], BLACK = [0, 0, 0];
const ROLES = {
  "outer wall": OKABE_ITO.orange, "inner wall": OKABE_ITO.yellow, infill: OKABE_ITO.vermilion, skin: OKABE_ITO.purple,
  support: OKABE_ITO.green, skirt: [110, 225, 180], purge: [80, 60, 250], bridge: OKABE_ITO.sky, other: OKABE_ITO.blue,
};
/** How much of black the second one of a role has, and of white the third one. They were searched, with the colours above
 * and below: the least difference of two of PrusaSlicer's types is the greatest, for each kind of colour vision
 * (xtask/browser/colours.py). */
const DARKER = 0.45, LIGHTER = 0.65;
/** What lays nothing: greys, as lines above have colours; a prime stands, so its colour is never that of a line. */
const travelColour = () => isDark() ? [121, 127, 139] : [120, 126, 138];
const EMPTY = {
  Wipe: () => isDark() ? [178, 184, 196] : [46, 52, 64], Retract: () => isDark() ? [245, 251, 255] : [20, 26, 38], Prime: () => [130, 190, 100],
};
/** A colour for each type of line: the second one of a role is darker and the third one lighter, as solid and top solid infill. */
function typeColours(types) {
  const before = {};
  return types.map(({ name, role }) => {
    if (role === "travel") return (EMPTY[name] ?? travelColour)();
    const colour = ROLES[role] ?? ROLES.other, k = before[role] = (before[role] ?? -1) + 1;
    return k ? mixed(colour, k % 2 ? BLACK : WHITE, k % 2 ? Math.min(DARKER * (k + 1) / 2, 0.7) : Math.min(LIGHTER * k / 2, 0.8)) : colour;
  });
}
/** What limits a move, in the order of the record. */
const LIMIT_COLOURS = {
  feed: OKABE_ITO.green, axis: OKABE_ITO.vermilion, motor: OKABE_ITO.purple, corner: OKABE_ITO.orange, "look-ahead": OKABE_ITO.yellow,
  "cruise ratio": OKABE_ITO.sky, extruder: OKABE_ITO.blue, mesh: mixed(OKABE_ITO.purple, BLACK, 0.45), "slow host": mixed(OKABE_ITO.vermilion, BLACK, 0.5), firmware: [210, 210, 210],
};
/** Lines of a chart, by number. */
const curveColour = i => {
  const set = isDark() ? ["sky", "orange", "green", "purple", "yellow", "vermilion", "blue", "grey"] : ["blue", "vermilion", "green", "purple", "orange", "sky", "grey", "yellow"];
  return rgb(OKABE_ITO[set[i % set.length]]);
};
/** As a colour of a chart, faint. */
const faint = (colour, share = 0.25) => colour.replace("rgb(", "rgba(").replace(")", "," + share + ")");
