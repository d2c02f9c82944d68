// G-code: the file's text in step with the picture. Only the lines in sight are elements, and only their blobs are open.

/** Calls with each line of the file, its number, its words behind a number of the host's, and all of it; ends once that is true. */
async function eachLine(chunks, blobs, each) {
  const decoder = new TextDecoder();
  let c = 0;
  for await (const bytes of inOrder(blobs)) {
    let number = chunks[c++][0];
    for (const whole of decoder.decode(bytes).split("\n")) if (each(number++, whole.trimStart().replace(/^N\d+\s*/i, ""), whole)) return;
    await breathe();
  }
}

const ROW = 19, TALLEST = 6e6;
class Text {
  constructor(record, player, blobs) {
    const chunks = record.data.gcode_chunks ?? [];
    Object.assign(this, { record, player, blobs, chunks, open: new Map(), top: 0, chosen: 0, name: "corehbot-line-" });
    const last = chunks[chunks.length - 1];
    this.lines = last ? last[0] + last[1] - 1 : 0;
    this.sheet = make("div", { className: "sheet" });
    this.rows = make("div", { className: "rows" });
    this.element = make("div", { className: "text", tabIndex: 0, role: "listbox", ariaLabel: "G-code: choose a line to see its moves" }, this.sheet, this.rows);
    this.tall = Math.min(this.lines * ROW, TALLEST);
    this.sheet.style.height = this.tall + "px";
    this.element.onscroll = () => { if (this.own) { this.own = false; return; } this.top = this.element.scrollTop / Math.max(this.tall - this.element.clientHeight, 1) * Math.max(this.lines - this.fits(), 0); this.draw(); };
    // A file that is longer than the tallest sheet would be scrolled by many lines at once.
    this.element.addEventListener("wheel", e => { if (this.tall < TALLEST) return; e.preventDefault(); this.scrollTo(this.top + e.deltaY / ROW); }, { passive: false });
    this.rows.onclick = e => { const line = +e.target.closest("[data-line]")?.dataset.line; if (line) this.choose(line); };
    this.element.addEventListener("keydown", e => {
      const by = { ArrowDown: 1, ArrowUp: -1, PageDown: this.fits(), PageUp: -this.fits() }[e.key];
      if (!by) return;
      e.preventDefault();
      this.choose(clamp(this.chosen + by, 1, this.lines));
    });
    player.on("time", () => { const line = this.lineNow(); if (line && line !== this.chosen) { this.chosen = line; this.reveal(); } });
    this.chosen = record.moves.n ? this.lineNow() : record.fault?.line ?? 1;
    new ResizeObserver(() => this.reveal()).observe(this.element);
  }
  fits() { return Math.max(1, Math.floor(this.element.clientHeight / ROW)); }
  lineNow() {
    const { moves } = this.record;
    for (let i = this.player.current; i >= 0 && i > this.player.current - 2000; i--) if (moves.line[i]) return moves.line[i];
    return 0;
  }
  choose(line) {
    this.chosen = line;
    const i = this.record.moves.ofLine(line);
    this.player.stop();
    if (i >= 0) { this.player.setMove(i + 1); this.chosen = line; }
    this.reveal();
  }
  reveal() {
    const at = this.chosen - 1 - this.top;
    if (at < 1 || at > this.fits() - 2) this.scrollTo(this.chosen - 1 - this.fits() / 2); else this.draw();
  }
  scrollTo(top) {
    this.top = clamp(top, 0, Math.max(this.lines - this.fits(), 0));
    const to = Math.round(this.top / Math.max(this.lines - this.fits(), 1) * Math.max(this.tall - this.element.clientHeight, 0));
    if (Math.abs(this.element.scrollTop - to) >= 1) { this.own = true; this.element.scrollTop = to; }
    this.draw();
  }
  /** The lines of a blob; opened when it is needed first. */
  linesOf(c) {
    const known = this.open.get(c);
    if (known) return known instanceof Array ? known : null;
    this.open.set(c, opened(this.blobs[c]).then(bytes => {
      this.open.set(c, new TextDecoder().decode(bytes).split("\n"));
      if (this.open.size > 12) this.open.delete(this.open.keys().next().value);
      this.draw();
    }));
    return null;
  }
  /** Rows stay the elements that they are, so that a press and its release, or a reader's cursor, find the same one. */
  draw() {
    const first = Math.floor(this.top), n = Math.max(0, Math.min(this.fits() + 2, this.lines - first)), { rows } = this;
    const digits = String(this.lines).length;
    while (rows.children.length > n) rows.lastChild.remove();
    while (rows.children.length < n) rows.append(make("div", { role: "option" }, make("i"), make("span")));
    let active = "";
    for (let k = 0; k < n; k++) {
      const line = first + 1 + k, row = rows.children[k], isChosen = line === this.chosen;
      const c = after(this.chunks.length, j => this.chunks[j][0], line) - 1, text = c >= 0 ? this.linesOf(c)?.[line - this.chunks[c][0]] : "";
      row.className = isChosen ? "chosen" : line === this.record.fault?.line ? "failed" : "";
      row.id = this.name + line;
      row.dataset.line = line;
      row.ariaSelected = String(isChosen);
      row.firstChild.textContent = String(line).padStart(digits);
      row.lastChild.textContent = text ?? "\u2026";
      if (isChosen) active = row.id;
    }
    if (active) this.element.setAttribute("aria-activedescendant", active); else this.element.removeAttribute("aria-activedescendant");
    rows.style.transform = `translateY(${this.element.scrollTop - (this.top - first) * ROW}px)`;
  }
}
