// The page's side of its workers. Script and firmware are texts of this page, so it works from a file without a server.
'use strict';

const $ = id => document.getElementById(id);

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element[name] = value;
    else if (value !== false && value != null) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  return Uint8Array.from(atob(base64), c => c.charCodeAt(0));
}

async function inflate(bytes) {
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'))).arrayBuffer();
}

const loaded = performance.now();
const script = URL.createObjectURL(new Blob([FIRMWARE.script], { type: 'text/javascript' }));
const firmware = inflate(bytesOf(FIRMWARE.wasm)).then(bytes => WebAssembly.compile(bytes));

firmware.then(
  () => { $('status').textContent = `the firmware is ready after ${((performance.now() - loaded) / 1000).toFixed(2)} s; nothing leaves this page`; },
  error => { $('status').textContent = `this browser cannot run the firmware: ${error.message}`; },
);

// A worker with the firmware. It does one call after the other; `end` stops it in the middle of a call.
class Firmware {
  constructor(hear = () => {}) {
    this.hear = hear;
    this.calls = new Map();
    this.id = 0;
    this.begin();
  }

  begin() {
    const worker = this.worker = new Worker(script);
    this.ready = firmware.then(module => worker.postMessage({ firmware: module }));
    worker.onmessage = ({ data }) => {
      if (data.id === undefined) return this.hear(data);
      const { resolve, reject } = this.calls.get(data.id);
      this.calls.delete(data.id);
      if (data.error === undefined) return resolve(data.result);
      // A firmware that has broken down is begun again.
      if (data.isBroken) this.end();
      reject(new Error(data.isBroken ? `the simulator broke down (${data.error}); the console has its words` : data.error));
    };
    worker.onerror = event => this.end(event.message);
  }

  call(call, ...args) {
    return new Promise((resolve, reject) => {
      const id = this.id++, worker = this.worker;
      this.calls.set(id, { resolve, reject });
      this.ready.then(() => { if (worker === this.worker) worker.postMessage({ id, call, args }); }, reject);
    });
  }

  end(why = 'cancelled') {
    this.worker.terminate();
    for (const { reject } of this.calls.values()) reject(new Error(why));
    this.calls.clear();
    this.begin();
  }
}

// What is typed here are names and numbers, which no phone may spell or write in its own way.
const PLAIN = { autocapitalize: 'off', autocomplete: 'off', autocorrect: 'off', spellcheck: 'false' };
for (const field of document.querySelectorAll('input:not([type]), input[type=search], textarea'))
  for (const [name, value] of Object.entries(PLAIN)) field.setAttribute(name, value);

// A file that is chosen again is read again: browsers tell of another name only.
for (const input of document.querySelectorAll('input[type=file]')) input.onclick = () => { input.value = ''; };

function save(name, content, type) {
  const link = make('a', { href: URL.createObjectURL(new Blob([content], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
