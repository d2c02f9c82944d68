// Document: a part of the project's documents as elements. It is Markdown with headings, paragraphs, tables, code and
// links.

/** Text with `code`, and links: what they lead to is not in this file, so its path stands behind the words. */
function inlineText(text, page) {
  return text.split(/(`[^`]*`|\[[^\]]*\]\([^)]*\))/).map(part => {
    if (part.startsWith("`")) return make("code", { textContent: part.slice(1, -1) });
    const [, words, to] = /^\[(.*)\]\((.*)\)$/.exec(part) ?? [];
    if (!to) return part;
    // Another part of the same page is here too, or is no address for people.
    return to.startsWith("#") ? words : make("span", {}, words, " (", make("code", { textContent: new URL(to, "file:///" + page).pathname.slice(1) }), ")");
  });
}

/** The part of the document `page` in `text`; `isMarked` says which rows of tables are meant, by their cells. */
function documentPart(text, page, isMarked) {
  const cells = line => line.slice(2, -2).split(" | ");
  const blocks = text.trim().split(/\n\n+/).map(block => {
    const lines = block.split("\n"), heading = /^#+ (.*)/.exec(block);
    if (heading) return make("h3", { textContent: heading[1] });
    if (block.startsWith("```")) return make("pre", { textContent: lines.slice(1, -1).join("\n") });
    if (!block.startsWith("| ")) return make("p", {}, ...inlineText(block, page));
    const rows = lines.slice(2).map(cells);
    return table(cells(lines[0]), rows.map(row => row.map(cell => make("span", {}, ...inlineText(cell, page)))), "words", i => isMarked(rows[i]));
  });
  return make("div", { className: "document" }, ...blocks);
}
