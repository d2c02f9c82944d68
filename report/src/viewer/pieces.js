// Pieces: the parts that every page is made of, head, cards, tiles and tables.

/** The head of a page: its name, what it is about, and how it ended. */
const heading = (name, about, badge, { isGood = true, title = name } = {}) => make("header", {}, make("h1", { textContent: name, title }), make("span", { className: "sub", textContent: about }),
  ...(badge ? [make("span", { className: "badge " + (isGood ? "good" : "bad"), textContent: badge })] : []));
/** A card with a heading of its own. */
const card = (title, ...children) => make("section", { className: "card panel", ariaLabel: title }, make("h2", { textContent: title }), ...children);
const note = textContent => make("p", { className: "sub", textContent });
/** What went wrong: a title, and rows of a name and what is said of it. */
const alertCard = (title, rows) => make("section", { className: "card panel fault", role: "alert", ariaLabel: "What went wrong" }, make("h2", { textContent: title }),
  make("dl", {}, ...rows.flatMap(([name, ...content]) => [make("dt", { textContent: name }), make("dd", {}, ...content)])));
/** Texts in a list that scrolls if there are many, with the keyboard too: the keys of the page are not for it then. */
function remarkList(texts, name = "Remarks") {
  const list = make("ul", { className: "remarks", tabIndex: 0, ariaLabel: `${name}: ${count(texts.length)}` }, ...texts.map(textContent => make("li", { textContent })));
  const KEYS = ["ArrowUp", "ArrowDown", "PageUp", "PageDown", "Home", "End", " "];
  list.addEventListener("keydown", e => { if (KEYS.includes(e.key) && list.scrollHeight > list.clientHeight) e.stopPropagation(); });
  return list;
}
/** Figures, each with its unit and its name; of what is not known there is none. */
const tileRow = list => make("div", { className: "tiles", role: "group", ariaLabel: "Figures" }, ...list.filter(Boolean).map(([value, unit, name]) => make("div", { className: "card tile" },
  make("b", { className: String(value).length + unit.length > 9 ? "long" : "" }, value + " ", make("small", { textContent: unit })), make("span", { textContent: name }))));
/** A table that scrolls by itself where it is too wide; `isTaken` marks the row that is suggested. */
const table = (heads, rows, className = "", isTaken = () => false) => {
  const body = make("tbody"), head = make("tr", {}, ...heads.map(textContent => textContent ? make("th", { textContent, scope: "col" }) : make("td")));
  rows.forEach((row, i) => {
    const line = body.insertRow();
    if (isTaken(i)) { line.className = "taken"; line.ariaSelected = "true"; }
    for (const cell of row) line.insertCell().append(cell);
  });
  const wide = make("div", { className: "wide" }, make("table", { className: className || (heads.length > 2 ? "many" : "") }, ...(heads.some(Boolean) ? [make("thead", {}, head)] : []), body));
  // One that is too wide is scrolled by keys, too; those of the page are not for it then.
  new ResizeObserver(() => { if (wide.scrollWidth > wide.clientWidth) wide.tabIndex = 0; else wide.removeAttribute("tabindex"); }).observe(wide);
  wide.addEventListener("keydown", e => { if (["ArrowLeft", "ArrowRight"].includes(e.key) && wide.tabIndex === 0) e.stopPropagation(); });
  return wide;
};
/** A button that does something at once; the group of some joins them. Its name begins with the word on it: who speaks the word
 * to the browser means it. */
const pushButton = (textContent, label, onclick) => {
  const isNamed = !/\w/.test(textContent) || label.toLowerCase().startsWith(textContent.toLowerCase());
  return make("button", { type: "button", textContent, ariaLabel: isNamed ? label : `${textContent}: ${label}`, title: label, onclick });
};
const buttonGroup = (label, ...buttons) => make("div", { className: "group", role: "group", ariaLabel: label }, ...buttons);
/** A list to choose from: pairs of a value and its words. */
const select = (label, options, onchange) => {
  const list = make("select", { ariaLabel: label }, ...options.map(([value, textContent]) => make("option", { value, textContent })));
  list.onchange = () => onchange(list.value);
  return list;
};
/** A line of G-code to take along. */
function copyLine(line) {
  const button = pushButton("Copy", "Copy this line", () => {
    const done = () => { button.textContent = "Copied"; setTimeout(() => { button.textContent = "Copy"; }, 1500); };
    if (navigator.clipboard) navigator.clipboard.writeText(line).then(done, () => {});
  });
  return make("div", { className: "copy" }, make("pre", { textContent: line }), button);
}
/** What a scale's colours say, from the least to the greatest. */
function scaleOf(least, most) {
  const scale = make("i", { className: "scale", role: "img", ariaLabel: `Colours from ${least} to ${most}` });
  const paint = () => { scale.style.background = rampCss(); };
  paint(); onScheme(scale, paint);
  return make("span", { className: "legend" }, least, scale, most);
}
/** A colour of the scale behind words, and the ink that can be read on it. */
function shade(cell, share) {
  const [r, g, b] = viridis(share);
  cell.style.background = rgb([r, g, b]);
  // Relative luminance of WCAG 2.2: black has the greater contrast from 0.18 on, and then at least 4.5 as white has below.
  const [x, y, z] = [r, g, b].map(v => v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
  cell.style.color = 0.2126 * x + 0.7152 * y + 0.0722 * z > 0.1791 ? "#000" : "#fff";
}
