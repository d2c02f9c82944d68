// Printing: a file, a machine, accidents; progress and cancel; then the report.
'use strict';

const printer = new Firmware(hear);
let gcode = null, printed = null, isPrinting = false;
const accidents = [];

// --- the file

function take(name, text, example = '') {
  $('example').value = example;
  if (example) $('file').value = '';
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
  take(file.name, new Uint8Array(await file.arrayBuffer()));
}

$('file').onchange = event => takeFile(event.target.files[0]);
for (const name of ['dragover', 'dragleave', 'drop'])
  document.addEventListener(name, event => {
    event.preventDefault();
    $('drop').classList.toggle('over', name === 'dragover');
    if (name === 'drop') takeFile(event.dataTransfer.files[0]);
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
  ['something in the way', { hits: '100,100,40,300' }],
  ['a motor rubs', { brakes: 'm1,15,2' }],
];

const WORDS = { breaks: 'breaks', hits: 'hit (X,Y,N,ms)', brakes: 'rubs (motor,N,s)' };

function addAccident(accident) {
  const [kind] = Object.keys(accident);
  // Only belts that stretch feel a hit or a brake.
  if (kind !== 'breaks') $('belt').checked = true;
  accidents.push({ kind, text: accident[kind] });
  showAccidents();
}

function showAccidents() {
  $('chosen').replaceChildren(...accidents.map((accident, index) => make('li', {},
    make('label', {}, `${WORDS[accident.kind]} `, make('input', {
      value: accident.text, size: 18, oninput: event => { accident.text = event.target.value; },
    })),
    make('button', {
      type: 'button', 'aria-label': `remove ${accident.text}`,
      onclick: () => { accidents.splice(index, 1); showAccidents(); },
    }, '×'))));
}

$('presets').append(...PRESETS.map(([name, accident]) =>
  make('button', { type: 'button', onclick: () => addAccident(accident) }, name)));

answers.call('accidents').then(text => {
  for (const { name, says, is_of_probe: isOfProbe } of JSON.parse(text))
    $('accident').append(make('option', { value: name, 'data-probe': isOfProbe || null, title: says }, `${name}: ${says}`));
}, () => {});
$('accident').onchange = event => {
  if (event.target.selectedOptions[0].dataset.probe) $('accident-place').value = 'probe';
};
$('add-accident').onclick = () => {
  const [name, place, time] = ['accident', 'accident-place', 'accident-time'].map(id => $(id).value.trim());
  addAccident({ breaks: `${name}${place ? `:${place}` : ''}@${time}` });
};

// --- the print

function job() {
  const of = kind => accidents.filter(accident => accident.kind === kind).map(accident => accident.text);
  const homed = $('homed').value.trim();
  return {
    file: gcode.name, ...machineJob(), homed: homed || null,
    has_belt_plant: $('belt').checked, hits: of('hits'), brakes: of('brakes'), breaks: of('breaks'),
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
  try {
    const bytes = gcode.bytes.slice().buffer;
    done(await printer.call('print', JSON.stringify(job()), bytes));
  } catch (error) {
    $('how-far').textContent = error.message === 'cancelled' ? 'cancelled' : '';
    if (error.message !== 'cancelled') fail(error.message);
  } finally {
    printing(false);
  }
}

function fail(words) {
  $('failure').textContent = words;
  $('failure').hidden = false;
}

function done({ summary, words, report, seconds }) {
  const figures = JSON.parse(summary);
  printed = { summary, report, name: gcode.name.replace(/\.[^.]*$/, ''), seconds };
  const ratio = figures.print_time_s / seconds;
  $('how-far').textContent = `printed in ${seconds.toFixed(2)} s, ${ratio.toFixed(0)} times real time`;
  $('result-name').textContent = `${figures.file} on ${figures.machine}, ${time(figures.print_time_s)}`;
  $('badge').textContent = figures.ok ? 'printed' : 'failed';
  $('badge').className = `badge ${figures.ok ? 'good' : 'bad'}`;
  $('sha256').textContent = figures.trace_sha256;
  $('words').textContent = words;
  if (figures.failure) fail(figures.failure);
  $('report').srcdoc = new TextDecoder().decode(report);
  for (const id of ['result', 'report']) $(id).hidden = false;
}

// The report is as high as its content, so that there is one scroll bar.
const BORDERS_PX = 2;

$('report').onload = () => {
  const content = $('report').contentDocument?.documentElement;
  if (!content || !printed) return;
  const fit = () => { $('report').style.height = `${content.querySelector('body').scrollHeight + BORDERS_PX}px`; };
  new ResizeObserver(fit).observe(content.querySelector('body'));
  fit();
};

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
  $('machine-trouble').textContent = problems.length ? `The machine file has ${problems.length === 1 ? 'an error' : `${problems.length} errors`}: ${problems[0].text}` : '';
}
listeners.push(() => checkMachine().catch(() => {}));
