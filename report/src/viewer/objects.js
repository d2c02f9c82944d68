// Objects: which object of the print a move is of, and which tool makes it, by the file's text; as colours and as a list.

/** M486 S (its number) and A (its name), as Marlin has them; EXCLUDE_OBJECT_START and _END, as Klipper has them. */
const OBJECT_LINE = /^(?:M486(?![\d.])|EXCLUDE_OBJECT_(?:START|END)\b)/i, TOOL_LINE = /^T(\d+)(?!\S)/i;

/** Finds where objects and tools begin: pairs of a line and the object or the tool from there on. */
class Sorter {
  constructor() { Object.assign(this, { objects: new Map(), names: [], begins: [], tools: [] }); }
  /** The number of an object by its key in the file. */
  numberOf(key, name) {
    if (!this.objects.has(key)) this.objects.set(key, this.names.push(name) - 1);
    return this.objects.get(key);
  }
  read(line, words) {
    words = words.replace(/\s*;.*/, "");
    const tool = TOOL_LINE.exec(words);
    if (tool) { this.tools.push([line, Number(tool[1])]); return; }
    if (!OBJECT_LINE.test(words)) return;
    if (/^M486/i.test(words)) {
      // A name goes on to the end of the line and may have any letter; a number is before it.
      const [, before, name] = /^M486((?:\s*[STPUC]-?\d+)*)\s*(?:A\s*"?(.*?)"?\s*)?$/i.exec(words) ?? [], number = /S(-?\d+)/i.exec(before ?? "")?.[1];
      if (number !== undefined) this.begins.push([line, Number(number) < 0 ? -1 : this.numberOf("M486 " + Number(number), "object " + Number(number))]);
      const current = this.begins.at(-1)?.[1] ?? -1;
      if (name && current >= 0) this.names[current] = name;
      return;
    }
    const name = /\bNAME=(?:"([^"]*)"|'([^']*)'|(\S+))/i.exec(words)?.slice(1).find(Boolean);
    if (/^EXCLUDE_OBJECT_END/i.test(words)) this.begins.push([line, -1]);
    else if (name) this.begins.push([line, this.numberOf(name, name)]);
  }
  /** For each move the value that holds in its line; a move that no line caused has the value of the move before. */
  static spread(moves, begins, first) {
    const of = new Int16Array(moves.n);
    let k = 0, now = first;
    for (let i = 0; i < moves.n; i++) {
      while (k < begins.length && moves.line[i] > begins[k][0]) now = begins[k++][1];
      of[i] = now;
    }
    return of;
  }
}

/** Objects and tools of a record: names, and one of them for each move. Null for those that the file does not have. */
async function sortedMoves(record, blobs) {
  const sorter = new Sorter(), { moves, data } = record;
  await eachLine(data.gcode_chunks ?? [], blobs, (line, words) => sorter.read(line, words));
  const objects = sorter.names.length ? { names: sorter.names, of: Sorter.spread(moves, sorter.begins, -1) } : null;
  const toolOf = Sorter.spread(moves, sorter.tools, 0), used = new Set();
  for (let i = 0; i < moves.n; i++) if (moves.isPrinted(i)) used.add(toolOf[i]);
  const numbers = [...used].sort((a, b) => a - b);
  const tools = numbers.length > 1 ? { names: numbers.map(number => "T" + number), of: toolOf.map(number => numbers.indexOf(number)) } : null;
  return { objects, tools };
}

/** Colours of so many things: the set, then darker and lighter ones of it; and grey for no thing. */
const PLAIN_COLOURS = ["orange", "sky", "green", "vermilion", "purple", "blue", "yellow"].map(name => OKABE_ITO[name]);
const thingColour = k => {
  const own = PLAIN_COLOURS[k % PLAIN_COLOURS.length], round = Math.floor(k / PLAIN_COLOURS.length) % 3;
  return round ? mixed(own, round === 1 ? BLACK : WHITE, 0.45) : own;
};
/** Most things that have a colour of their own; the codes of the palette do not go further. */
const MOST_THINGS = 200;

/** A measure of what each move is of; one that is `chosen` has its colour alone. */
function measureOfThings(id, name, none, { names, of }, chosen = () => -1) {
  const kinds = names.slice(0, MOST_THINGS), rest = kinds.length;
  return {
    id, name,
    get kinds() { const only = chosen(), faint = travelColour(); return [...kinds.map((name, k) => ({ name, colour: only < 0 || only === k ? thingColour(k) : faint })), { name: none, colour: faint }]; },
    of: i => of[i] < 0 || of[i] >= rest ? rest : of[i],
  };
}

/** The list of objects, each with its time and filament: a button shows where it is. */
function objectCard(record, { names, of }, stage, player, colours) {
  const { moves, data: { filament: F } } = record, sums = names.map(() => ({ seconds: 0, mm: 0, last: -1, least: [Infinity, Infinity, Infinity], most: [-Infinity, -Infinity, -Infinity] }));
  let whole = 0;
  for (let i = 0; i < moves.n; i++) {
    if (moves.type[i] === HIDDEN) continue;
    const s = moves.duration(i), sum = sums[of[i]];
    whole += s;
    if (!sum) continue;
    sum.seconds += s; sum.mm += moves.e[i];
    if (!moves.isPrinted(i) || !(moves.points[4 * i + 3] > 0)) continue;
    sum.last = i;
    for (const place of [moves.place(i, 0), moves.place(i, 1)]) place.forEach((v, axis) => { sum.least[axis] = Math.min(sum.least[axis], v); sum.most[axis] = Math.max(sum.most[axis], v); });
  }
  const buttons = names.map((name, k) => {
    const button = make("button", { type: "button", textContent: "Show", ariaLabel: `Show ${name}`, ariaPressed: "false", disabled: sums[k].last < 0 });
    button.onclick = () => {
      const isOn = colours.chosen !== k;
      colours.chosen = isOn ? k : -1;
      buttons.forEach((other, j) => { other.ariaPressed = String(isOn && j === k); });
      colours.choose("object");
      if (!isOn) { stage.fit(); return; }
      player.stop();
      stage.lookAt([sums[k].least, sums[k].most]);
      stage.element.scrollIntoView({ block: "nearest" });
    };
    return button;
  });
  const rows = names.map((name, k) => {
    const { seconds, mm } = sums[k];
    return [make("span", {}, dot(thingColour(k)), name), clock(seconds), (whole > 0 ? 100 * seconds / whole : 0).toFixed(1) + " %", metres(mm), F?.mm > 0 ? (F.g * mm / F.mm).toFixed(2) : "", buttons[k]];
  });
  return card("Objects", table(["Object", "Time", "Share of motion", "Filament, m", "g", "In the picture"], rows, "figures objects"));
}
