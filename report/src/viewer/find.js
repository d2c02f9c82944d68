// Find: a line of the file by its number, and lines by a word in them.

/** Lines are looked at for words; beyond so many that have it, the rest is not counted. */
const MOST_FOUND = 100000;

/** The fields above the text of the file. What is typed in them stays as it is. */
function findBar(text, chunks, blobs) {
  const field = (ariaLabel, props) => Object.assign(make("input", { type: "text", ariaLabel, autocomplete: "off", spellcheck: false, ...props }), { autocapitalize: "off" });
  const line = field("Line of the file", { size: 7, inputMode: "numeric", placeholder: "line" }), word = field("Word in the file", { type: "search", size: 12, placeholder: "find: G28, ;LAYER" });
  const out = make("output", { role: "status" });
  const go = () => {
    const wanted = Number(line.value.trim().replaceAll(",", ""));
    const isLine = Number.isInteger(wanted) && wanted >= 1 && wanted <= text.lines;
    line.ariaInvalid = String(!isLine);
    out.textContent = isLine ? "" : `The file has lines 1 to ${count(text.lines)}.`;
    if (isLine) text.choose(wanted);
  };
  line.addEventListener("keydown", e => { if (e.key === "Enter") go(); });
  line.oninput = () => { line.ariaInvalid = "false"; out.textContent = ""; };

  let found = null, round = 0;
  const tell = () => {
    if (!found) { out.textContent = ""; return; }
    const at = found.lines.indexOf(text.chosen), more = found.lines.length >= MOST_FOUND ? " or more" : "";
    out.textContent = !found.lines.length ? "not found" : at < 0 ? `${count(found.lines.length)}${more} lines` : `${count(at + 1)} of ${count(found.lines.length)}${more}`;
  };
  /** Lines with the word; a later word ends the search. */
  const search = async wanted => {
    const own = ++round, lines = [], low = wanted.toLowerCase();
    found = null;
    if (wanted) {
      await eachLine(chunks, blobs, (number, _, whole) => { if (whole.toLowerCase().includes(low)) lines.push(number); return own !== round || lines.length >= MOST_FOUND; });
      if (own !== round) return;
      found = { wanted, lines };
    }
    tell();
  };
  const step = async by => {
    const wanted = word.value.trim();
    if (!wanted) return;
    if (found?.wanted !== wanted) await search(wanted);
    if (!found?.lines.length || found.wanted !== wanted) return;
    const { lines } = found, now = text.chosen, i = by > 0 ? lines.findIndex(number => number > now) : lines.findLastIndex(number => number < now);
    text.choose(i < 0 ? lines.at(by > 0 ? 0 : -1) : lines[i]);
    tell();
  };
  word.oninput = () => { search(word.value.trim()); };
  word.addEventListener("keydown", e => { if (e.key === "Enter") step(e.shiftKey ? -1 : 1); });
  return make("div", { className: "bar find" }, line, pushButton("Go", "Go to the line", go), word, buttonGroup("Lines with the word", pushButton("\u2191", "Line before with the word", () => step(-1)), pushButton("\u2193", "Next line with the word", () => step(1))), out);
}
