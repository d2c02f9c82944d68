// The worker's side: calls of the page, one at a time. The glue of wasm-bindgen stands before this text.
'use strict';

let terminal = null, speed = 1, last = 0, timer = 0;

// The firmware tells how far a print is some hundred times a second; a page needs less.
let told = 0;
self.tellProgress = (answered, commands, seconds) => {
  const now = performance.now();
  if (now - told < 80) return;
  told = now;
  postMessage({ progress: { answered, commands, seconds } });
};

// A page that was asleep does not make the printer's time race.
const LAG_MS = 200;

function tick() {
  const now = performance.now();
  const said = terminal.turn(Math.min(now - last, LAG_MS) * speed);
  last = now;
  postMessage({ terminal: { said, state: terminal.state() } });
}

function run(isOn) {
  clearInterval(timer);
  last = performance.now();
  if (isOn && terminal) timer = setInterval(tick, 33);
}

// The printer, or why there is none.
function on() {
  if (!terminal) throw new Error('no printer is switched on: mend the machine file');
  return terminal;
}

const calls = {
  told: (begin, length, isMachineWanted) => wasm_bindgen.told(begin, length, isMachineWanted),
  problems: text => wasm_bindgen.problems(text),
  schema: () => wasm_bindgen.schema(),
  accidents: () => wasm_bindgen.accidents(),
  hands: () => wasm_bindgen.hands(),
  refusals: job => wasm_bindgen.refusals(job),
  parts: job => wasm_bindgen.parts(job),
  boards: () => wasm_bindgen.boards(),
  template: board => wasm_bindgen.template(board),
  print(job, gcode) {
    const begin = performance.now();
    const printed = wasm_bindgen.print(job, new Uint8Array(gcode));
    const seconds = (performance.now() - begin) / 1000;
    const report = printed.report();
    const result = { summary: printed.summary(), words: printed.words(), report, seconds };
    printed.free();
    return result;
  },
  open(job) {
    run(false);
    terminal?.free();
    terminal = null;
    terminal = new wasm_bindgen.Terminal(job);
    const frame = terminal.frame();
    run(true);
    return frame;
  },
  send: text => on().send(text),
  act: what => on().act(what),
  speed(times) { speed = times; },
  run,
};

onmessage = async ({ data }) => {
  if (data.firmware) {
    wasm_bindgen.initSync({ module: data.firmware });
    return;
  }
  const { id, call, args } = data;
  try {
    postMessage({ id, result: calls[call](...args) });
  } catch (error) {
    postMessage({ id, error: error?.message ?? String(error), isBroken: error instanceof WebAssembly.RuntimeError });
  }
};
