// Open: the whole viewer of a record, in an element of any page.

async function loadRecord(data, streams, progress) {
  const record = { data, motors: data.machine.motors, heat: new Heat(data), fault: data.fault ?? null };
  record.moves = await readMoves(data, streams.moves, progress);
  record.tell = teller(record);
  const { fault } = record;
  // Two clocks: motion time, and the time since the start, which goes on while a command waits.
  record.marks = fault ? [{ time_s: fault.motion_s, since_start_s: fault.time_s, code: fault.code || "failed" }] : [];
  return record;
}

const reading = share => "Reading the print" + (share ? `, ${(100 * share).toFixed(0)} %` : "");
/** What says in `root` that a record is read. */
function waitIn(root) {
  const wait = make("p", { className: "sub", role: "status", textContent: reading() });
  root.classList.add("viewer");
  root.replaceChildren(wait);
  return wait;
}
/**
 * Shows a first picture of a large record in `root`, of the moves in these blobs, before the rest is read. They are the
 * chunks in `data.preview`. Returns when it is drawn; `openRecord` waits for it.
 */
function openPreview(root, data, blobs) {
  const stage = (async () => {
    const chosen = data.preview ?? [], wait = waitIn(root);
    if (!chosen.length) return null;
    const part = { ...data, move_chunks: chosen.map(i => data.move_chunks[i]), fault: null };
    try {
      const record = await loadRecord(part, { moves: blobs });
      const player = new Player(record.moves, layersOf(data).heights.length), stage = new Stage(record, player);
      colourBar(record, stage, player);
      stage.element.inert = true;
      root.replaceChildren(header(record), make("section", { className: "card panel view" }, wait, stage.element));
      await new Promise(go => { stage.onPicture = () => setTimeout(go, 60); setTimeout(go, 2000); });
      root.dispatchEvent(new CustomEvent("corehbot-picture", { bubbles: true }));
      return stage;
    } catch { return null; }
  })();
  root.corehbotPreview = { data, stage };
  return stage;
}

/** Shows a record in `root`, in place of what was there. Streams are lists of Uint8Array, or of functions that make them. */
async function openRecord(root, data, streams) {
  const round = root.corehbotRound = (root.corehbotRound ?? 0) + 1;
  // Graphics memory of a record that was here before.
  root.corehbotView?.player.stop();
  root.corehbotView?.stage?.lines.end();
  root.corehbotView = null;
  // A report has begun its preview already.
  const begun = root.corehbotPreview?.data === data ? root.corehbotPreview.stage : null;
  const preview = await (begun ?? openPreview(root, data, (data.preview ?? []).map(i => streams.moves[i])));
  if (root.corehbotRound !== round) return;
  root.corehbotPreview = null;
  const wait = root.querySelector("[role=status]") ?? waitIn(root);
  const record = await loadRecord(data, streams, share => { wait.textContent = reading(share); });
  if (root.corehbotRound !== round) return;
  record.gcode = streams.gcode ?? [];
  const { heights } = layersOf(data), player = new Player(record.moves, heights.length);
  const parts = [header(record), faultCard(record, player)];
  let stage = null, colours = null;
  try { stage = new Stage(record, player); } catch (error) { parts.push(card("Tool path", make("p", { textContent: `The path cannot be drawn: ${error.message}.` }))); }
  if (stage) {
    colours = colourBar(record, stage, player);
    const layers = layerSlider(player, heights), text = new Text(record, player, record.gcode);
    const hasText = text.lines > 0;
    const view = make("section", { className: "card panel view", ariaLabel: "Tool path" },
      make("div", { className: "bar" }, make("h2", { textContent: "Tool path" }), ...viewButtons(stage, player, record, streams.path), make("span", { className: "grow" }), ...saveButtons(stage, player, record, colours, heights)),
      make("div", { className: "bar" }, colours.choice, colours.travel), colours.legend, markBoxes(stage, record, record.gcode),
      make("div", { className: "beside" }, stage.element, layers.slider, ...(hasText ? [make("div", { className: "file" }, findBar(text, record.data.gcode_chunks, record.gcode), text.element)] : [])),
      moveSlider(player, record), layers.line, help());
    parts.push(view);
    keyboard(root, stage, player);
    stage.onPicture = () => { stage.onPicture = null; root.dispatchEvent(new CustomEvent("corehbot-picture", { bubbles: true })); };
    stage.onWhole = () => { root.dataset.whole = String(Math.round(performance.now())); };
  }
  parts.push(tiles(record));
  root.replaceChildren(...parts);
  preview?.lines.end();
  // Curves come after the first picture, and so does the view of a link: the picture has its size now.
  await new Promise(go => requestAnimationFrame(() => setTimeout(go)));
  if (root.corehbotRound !== round) return;
  if (stage) {
    const follow = () => { if (root.corehbotRound === round) showView(location.hash.slice(1), stage, player, colours); else removeEventListener("hashchange", follow); };
    addEventListener("hashchange", follow);
    follow();
  }
  const more = [timeCards(record, player), record.moves.n ? motionCharts(record, player).element : "", heatCharts(record, player)?.element ?? "", meshCards(record), ...(stage ? [compareCard(record, stage, player)] : []), endCards(record)];
  root.append(...more);
  root.corehbotView = { record, player, stage };
  if (stage) {
    // The text of the file says what moves are of; of a large one it takes a while.
    const { objects, tools } = record.sorted = await sortedMoves(record, record.gcode);
    if (root.corehbotRound !== round) return;
    if (tools) colours.add([measureOfThings("tool", "Tool", "no tool", tools)]);
    if (objects) {
      colours.add([measureOfThings("object", "Object", "no object", objects, () => colours.chosen)]);
      more[0] ? more[0].after(objectCard(record, objects, stage, player, colours)) : root.append(objectCard(record, objects, stage, player, colours));
    }
  }
  root.dataset.sorted = "true";
  return root.corehbotView;
}
function help() {
  const keys = [["\u2190 \u2192", "one move; with Shift 100"], ["\u2191 \u2193", "one layer"], ["Space", "play, pause"], ["+ \u2212", "zoom"], ["0", "fit"], ["3", "above or 3D"], ["[ ] PgUp PgDn", "orbit"], ["Alt + arrows", "pan"], ["Home End", "first, last move"]];
  return make("details", { className: "keys" }, make("summary", { textContent: "Keys and hands" }), make("p", { textContent: "Drag: pan from above, orbit in 3D (Shift or the right button pans). Wheel: zoom. One finger that goes sideways drags, and one that goes up or down scrolls the page; two fingers move and zoom. On the whole screen one finger drags any way. Click a move, a line of G-code or a chart: the others follow." }), make("dl", {}, ...keys.flatMap(([key, what]) => [make("dt", { textContent: key }), make("dd", { textContent: what })])));
}
