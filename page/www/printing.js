// Printing: a file, a machine, accidents; progress and cancel; then the report.
'use strict';

const printer = new Firmware(hear);
let gcode = null, printed = null, isPrinting = false;
const accidents = [];

// --- the file

function take(name, text, example = '', plates = []) {
  // What is said of an earlier file is not of this one.
  $('failure').hidden = true;
  $('example').value = example;
  if (example) $('file').value = '';
  $('plate').replaceChildren(...plates.map(number => make('option', { value: number }, String(number))));
  $('plate-label').hidden = plates.length < 2;
  gcode = { name, bytes: typeof text === 'string' ? new TextEncoder().encode(text) : text };
  $('file-name').textContent = name;
  $('file-size').textContent = `${(gcode.bytes.byteLength / 1000).toLocaleString('en', { maximumFractionDigits: 1 })} kB`;
  ready();
}

function ready() {
  $('start').disabled = !gcode || isPrinting;
}

async function takeFile(file) {
  if (!file) return;
  const { kind, plates, trouble } = await told(file, false);
  if (kind === 'machine') return openMachine(file);
  show($('tab-print'));
  $('failure').hidden = !trouble;
  if (trouble) {
    fail(`${file.name}: ${trouble}`);
    $('failure').scrollIntoView({ block: 'nearest' });
    return;
  }
  take(file.name, new Uint8Array(await file.arrayBuffer()), '', plates);
}

$('file').onchange = event => takeFile(event.target.files[0]);

// A file is held over the page, or let go; the report tells of those over it.
async function dropped(isOver, file) {
  $('drop').classList.toggle('over', isOver);
  if (!file) return;
  await takeFile(file);
  $('drop').scrollIntoView({ block: 'nearest' });
}
for (const name of ['dragover', 'dragleave', 'drop'])
  document.addEventListener(name, event => {
    event.preventDefault();
    dropped(name === 'dragover', name === 'drop' ? event.dataTransfer.files[0] : undefined);
  });

$('example').append(make('option', { value: '' }, 'choose an example'),
  ...Object.keys(EXAMPLES.gcode).map(name => make('option', { value: name }, name.replace(/\.gcode$/, ''))));
$('example').onchange = event => {
  const name = event.target.value;
  if (name) take(name, EXAMPLES.gcode[name], name);
};

// --- accidents

const PRESETS = [
  ['thermistor off', { breaks: 'open:hotend@60s' }],
  ['heater stays on', { breaks: 'stuck-on:hotend@60s' }],
  ['part fan stops', { breaks: 'fan-dead:part@60s' }],
  ['something in the way', { hits: '100,100,40,300' }, true],
  ['a motor rubs', { breaks: 'rub:m1:15N@2s' }, true],
  ['a pulley is stuck', { breaks: 'seized:m8@2s' }, true],
  ['a tooth is jumped', { breaks: 'jump:m1@2s' }, true],
];

// Fields of a job with lists of texts, the command's options for them, and what is before a text.
const LISTS = { breaks: ['break', 'breaks'], hits: ['hit', 'hit (X,Y,N,ms)'] };

function addAccident(accident, needsBelts) {
  const [kind] = Object.keys(accident);
  // Only belts that stretch have such an accident.
  if (needsBelts) $('belt').checked = true;
  accidents.push({ kind, text: accident[kind] });
  showAccidents();
}

function showAccidents() {
  const lines = accidents.map((accident, index) => {
    const remove = make('button', { type: 'button', onclick: () => { accidents.splice(index, 1); showAccidents(); } }, '×');
    const named = () => remove.setAttribute('aria-label', `remove ${accident.text}`);
    const oninput = event => { accident.text = event.target.value; named(); checkOptions(); };
    named();
    return make('li', {},
      make('label', {}, `${LISTS[accident.kind][1]} `, make('input', {
        ...PLAIN, value: accident.text, size: 18, 'aria-describedby': `trouble-${index}`, oninput,
      })), remove, make('span', { class: 'trouble', id: `trouble-${index}`, role: 'alert' }));
  });
  $('chosen').replaceChildren(...lines);
  checkOptions();
}

$('presets').append(...PRESETS.map(([name, accident, needsBelts]) =>
  make('button', { type: 'button', onclick: () => addAccident(accident, needsBelts) }, name)));

// --- any other accident: its kind from a list, its place from the list or from the picture

// The firmware's table, by family and word: belts and heat have one word in common. Belts are first in the list, for the
// picture is about them.
const kinds = new Map();
let beltParts = [], listedPlaces = [];

answers.call('accidents').then(text => {
  const table = JSON.parse(text).sort((one, other) => other.needs_belts - one.needs_belts), groups = new Map();
  for (const kind of table) {
    const label = kind.family[0].toUpperCase() + kind.family.slice(1), value = `${label} ${kind.word}`;
    kinds.set(value, kind);
    if (!groups.has(label)) groups.set(label, make('optgroup', { label }));
    groups.get(label).append(make('option', { value }, kind.word));
  }
  listedPlaces = table.flatMap(kind => kind.places);
  $('accident').append(...groups.values());
  showKind();
}, () => {});

const chosenKind = () => kinds.get($('accident').value);
const usualPlaces = () => chosenKind()?.needs_belts ? beltParts : chosenKind()?.places ?? [];

// The kind or the machine has changed: a place of other ones gives way to a usual one. What a person types stays, also a
// place that no list has, which is refused in the command's words.
function showKind(earlier = beltParts) {
  const kind = chosenKind();
  if (!kind) return;
  const place = $('accident-place'), usual = usualPlaces(), now = place.value.trim();
  const isOfOthers = !now || !usual.includes(now) && [...earlier, ...listedPlaces].includes(now);
  if (isOfOthers && document.activeElement !== place) place.value = usual[0] ?? '';
  $('places').replaceChildren(...usual.map(value => make('option', { value })));
  $('accident-how-label').hidden = !kind.how;
  $('accident-says').textContent = `${kind.word}: ${kind.says}.${kind.how ? ` How much is ${kind.how[0]}.` : ''}`;
  markPlace();
}

function markPlace() {
  partsPicture.mark(chosenKind()?.needs_belts ? $('accident-place').value.trim() : '');
}
$('accident').onchange = () => showKind();
$('accident-place').oninput = markPlace;

// A click on a belt breaks its cords; one on a motor or a pulley keeps the kind, if it can be of one.
const partsPicture = new MachinePicture($('parts'), (role, name) => {
  const [kind, place] = [$('accident'), $('accident-place')];
  if (role === 'belt') kind.value = 'Belts cord';
  else if (!chosenKind()?.needs_belts || role === 'idler') kind.value = 'Belts seized';
  place.value = name;
  showKind();
});

async function showParts() {
  const asked = machineText();
  const still = JSON.parse(await answers.call('parts', JSON.stringify(machineJob())));
  if (asked !== machineText()) return;
  showPicture(partsPicture.draw(still));
  const earlier = beltParts;
  beltParts = [];
  if (still.resting) {
    partsPicture.move(still.resting);
    const named = still.resting.pulleys.filter(({ name }) => name);
    beltParts = [...new Set(['motor', 'idler'].flatMap(role => named.filter(pulley => pulley.role === role).map(({ name }) => name)))];
  }
  showKind(earlier);
}

$('add-accident').onclick = () => {
  const [place, how, time] = ['accident-place', 'accident-how', 'accident-time'].map(id => $(id).value.trim());
  const { word, how: takes, needs_belts: needsBelts } = chosenKind();
  addAccident({ breaks: [word, place, takes && how].filter(Boolean).join(':') + `@${time}` }, needsBelts);
};

// --- what of it cannot be: told next to its field, in the command's words

const FIELDS = ['plant', 'seed', 'assume-homed', 'bed'];
let optionChecks = 0;

async function checkOptions() {
  const check = ++optionChecks;
  const refusals = JSON.parse(await answers.call('refusals', JSON.stringify(job())).catch(() => '[]'));
  if (check !== optionChecks) return;
  const why = (option, text) => refusals.find(refusal => refusal.option === option && (text === undefined || refusal.text === text))?.why ?? '';
  const tell = (field, trouble, words) => {
    trouble.textContent = words;
    field.setAttribute('aria-invalid', words !== '');
  };
  for (const option of FIELDS) tell($(option === 'plant' ? 'belt' : option), $(`${option}-trouble`), why(option));
  [...$('chosen').children].forEach((item, index) => {
    const { kind, text } = accidents[index];
    tell(item.querySelector('input'), item.querySelector('.trouble'), why(LISTS[kind][0], text));
  });
}
for (const id of ['seed', 'assume-homed', 'bed']) $(id).oninput = checkOptions;
$('belt').onchange = checkOptions;

// Without belts, or with a machine file that has errors, there is no picture.
function showPicture(isShown) {
  for (const id of ['parts', 'parts-help']) $(id).toggleAttribute('hidden', !isShown);
}
const showMachine = () => { showParts().catch(() => showPicture(false)); checkOptions(); };
listeners.push(showMachine);

// --- the print

function job() {
  const of = kind => accidents.filter(accident => accident.kind === kind).map(accident => accident.text);
  const word = id => $(id).value.trim() || null;
  return {
    file: gcode?.name ?? '', plate: Number($('plate').value) || null, ...machineJob(), homed: word('assume-homed'), bed: word('bed'), seed: word('seed'),
    has_belt_plant: $('belt').checked, ...Object.fromEntries(Object.keys(LISTS).map(kind => [kind, of(kind)])),
  };
}

let begun = 0;

function hear({ progress: { answered, commands, seconds } }) {
  $('progress').value = commands ? answered / commands : 0;
  const ratio = seconds / ((performance.now() - begun) / 1000);
  $('how-far').textContent = `${answered.toLocaleString('en')} of ${commands.toLocaleString('en')} commands, ${time(seconds)} of print, ${ratio.toFixed(0)} times real time`;
}

function time(seconds) {
  const whole = Math.round(seconds), two = n => String(n).padStart(2, '0');
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
}

function printing(isOn) {
  isPrinting = isOn;
  $('cancel').hidden = $('progress').hidden = !isOn;
  ready();
}

async function start() {
  if (!gcode || isPrinting) return;
  for (const id of ['failure', 'result', 'report']) $(id).hidden = true;
  printing(true);
  $('progress').value = 0;
  $('how-far').textContent = 'reads the file';
  begun = performance.now();
  const { name, bytes } = gcode;
  const answer = await printer.call('print', JSON.stringify(job()), bytes.slice().buffer).catch(error => error);
  // The row of progress goes first: what is shown then is scrolled to, and nothing above it may move afterwards.
  printing(false);
  if (!(answer instanceof Error)) return done(name, answer);
  const isCancelled = answer.message === 'cancelled';
  $('how-far').textContent = isCancelled ? 'cancelled' : '';
  if (!isCancelled) {
    fail(answer.message);
    $('failure').scrollIntoView({ block: 'nearest' });
  }
}

function fail(words) {
  $('failure').textContent = words;
  $('failure').hidden = false;
}

function done(file, { summary, words, report, seconds }) {
  const figures = JSON.parse(summary);
  printed = { summary, report, name: file.replace(/\.[^.]*$/, ''), seconds };
  const ratio = figures.print_time_s / seconds;
  $('how-far').textContent = `${figures.ok ? 'printed' : 'ended'} in ${seconds.toFixed(2)} s, ${ratio.toFixed(0)} times real time`;
  $('result-name').textContent = `${figures.file} on ${figures.machine}, ${time(figures.print_time_s)}`;
  const skips = figures.belt?.skips.length ?? 0, isGood = figures.ok && !skips;
  $('badge').textContent = !figures.ok ? 'failed' : skips ? `printed, motors skipped: ${skips}` : 'printed';
  $('badge').className = `badge ${isGood ? 'good' : 'bad'}`;
  $('sha256').textContent = figures.trace_sha256;
  $('words').textContent = words;
  showReport(new TextDecoder().decode(report));
  $('result').hidden = false;
  if (figures.failure) fail(figures.failure);
  $(figures.failure ? 'failure' : 'result').scrollIntoView({ block: 'start' });
}

// The report is as high as its content, so that there is one scroll bar. It is in a sandbox, since it has texts of files
// and of the printer: it tells its height, and the files that are dropped on it, through a port of its own.
const BORDERS_PX = 2;

// Each report has a frame of its own: Chromium 156 shows nothing of one that was loaded into a frame while that was hidden.
// It begins as high as the last one, so that the page can scroll to the result above it at once.
function showReport(text) {
  const frame = $('report').cloneNode();
  frame.hidden = false;
  frame.srcdoc = text;
  frame.onload = () => {
    const { port1: port, port2 } = new MessageChannel();
    port.onmessage = ({ data: { height, isOver, file } }) => {
      if (Number.isFinite(height)) frame.style.height = `${height + BORDERS_PX}px`;
      if (isOver !== undefined) dropped(isOver === true, file instanceof File ? file : undefined);
    };
    frame.contentWindow.postMessage('corehbot-page', '*', [port2]);
  };
  $('report').replaceWith(frame);
}

$('start').onclick = start;
$('cancel').onclick = () => printer.end();
$('save-report').onclick = () => save(`${printed.name}.html`, printed.report, 'text/html');
$('save-summary').onclick = () => save(`${printed.name}.json`, printed.summary, 'application/json');
document.addEventListener('keydown', event => {
  if (event.key === 'Enter' && (event.ctrlKey || event.metaKey) && !$('print').hidden) start();
  if (event.key === 'Escape' && isPrinting) printer.end();
});

// Errors of the chosen machine are told where it is chosen.
async function checkMachine() {
  const text = machineText();
  const problems = JSON.parse(await answers.call('problems', text)).filter(problem => problem.is_error);
  if (text !== machineText()) return;
  const [first] = problems, count = problems.length === 1 ? 'an error' : `${problems.length} errors`;
  $('machine-trouble').textContent = first ? `The machine file has ${count}: ${first.line ? `line ${first.line}: ` : ''}${short(first)}` : '';
}
listeners.push(() => checkMachine().catch(() => {}));

showMachine();
