// Streams: blobs of a record, opened when they are needed.

/** The bytes of base64. */
function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
}
async function inflate(bytes) {
  const { readable, writable } = new DecompressionStream("deflate-raw"), writer = writable.getWriter(), reader = readable.getReader(), parts = [];
  // Errors come out at the reader.
  writer.write(bytes).catch(() => {}); writer.close().catch(() => {});
  let length = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) { parts.push(part.value); length += part.value.length; }
  if (parts.length === 1) return parts[0];
  const whole = new Uint8Array(length);
  let at = 0;
  for (const part of parts) { whole.set(part, at); at += part.length; }
  return whole;
}
/** The bytes of a blob: an array already, or a function that makes one. */
const opened = async blob => typeof blob === "function" ? blob() : blob;

/** The blobs one after another, some of them opened ahead. */
async function* inOrder(blobs) {
  const AHEAD = 6, open = blobs.slice(0, AHEAD).map(opened);
  for (let i = 0; i < blobs.length; i++) {
    yield await open[i];
    open[i] = null;
    if (i + AHEAD < blobs.length) open.push(opened(blobs[i + AHEAD]));
  }
}

/** Blobs of the texts of one class. */
const packed = texts => texts.map(text => async () => inflate(fromBase64(typeof text === "string" ? text : text.textContent)));
const STREAMS = ["path", "moves", "gcode"];
/** A stream of the page that this script is in. */
const streamOfPage = name => packed([...document.querySelectorAll(`script.${name}[type="text/plain"]`)]);
const streamsOfPage = () => Object.fromEntries(STREAMS.map(name => [name, streamOfPage(name)]));
/** The record in the text of another report, or null. */
function recordOfText(text) {
  const begin = text.indexOf("\nconst D = "), end = text.indexOf(";\n", begin);
  if (begin < 0 || end < 0) return null;
  let data;
  try { data = JSON.parse(text.slice(begin + 11, end)); } catch { return null; }
  // Pages of the twin have figures of another kind.
  if (!data?.summary?.trace_sha256 || !Array.isArray(data.move_chunks)) return null;
  const streams = {};
  for (const name of STREAMS) {
    // In two pieces, since this text stands in a script.
    const head = "<" + `script type="text/plain" class="${name}">`, texts = [];
    for (let at = text.indexOf(head); at >= 0; at = text.indexOf(head, at)) {
      const close = text.indexOf("</" + "script>", at);
      texts.push(text.slice(at + head.length, close));
      at = close;
    }
    streams[name] = packed(texts);
  }
  return { data, streams };
}

/** Numbers of 7 bits a byte, the least first. */
function numbers(bytes) {
  let at = 0;
  const unsigned = () => {
    let b = bytes[at++];
    if (b < 128) return b;
    let v = b & 127, f = 128;
    do { b = bytes[at++]; v += (b & 127) * f; f *= 128; } while (b > 127);
    return v;
  };
  const signed = () => { const v = unsigned(); return v % 2 ? -(v + 1) / 2 : v / 2; };
  return { unsigned, signed };
}
