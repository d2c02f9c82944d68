// The machines to choose from: the prototype, the files of examples/machines, new files for a board, and the user's own
// files. All lists show the same choice.
'use strict';

// Files that were opened, made for a board or edited, with their names and texts; none is lost by another choice.
const own = [];

// An example's name, or `own` and a number.
let chosenMachine = 'prototype.toml';

const ownMachine = () => own.find((_, index) => chosenMachine === `own ${index}`);

// One worker for short questions.
const answers = new Firmware();

const lists = [...document.querySelectorAll('.machines')];
const listeners = [];

function fill() {
  for (const list of lists) {
    const files = Object.keys(EXAMPLES.machines).map(name => make('option', { value: name }, name.replace(/\.toml$/, '')));
    const groups = [make('optgroup', { label: 'Examples' }, ...files)];
    if (boardNames.length)
      groups.push(make('optgroup', { label: 'A new file for a board' }, ...boardNames.map(name => make('option', { value: `board ${name}` }, name))));
    const label = ({ name }, index) => {
      const earlier = own.slice(0, index).filter(other => other.name === name).length;
      return name.replace(/\.toml$/, '') + (earlier ? ` (${earlier + 1})` : '');
    };
    if (own.length)
      groups.unshift(make('optgroup', { label: 'Your files' }, ...own.map((file, index) => make('option', { value: `own ${index}` }, label(file, index)))));
    list.replaceChildren(...groups);
    list.value = chosenMachine;
  }
}

let boardNames = [];
answers.call('boards').then(names => { boardNames = JSON.parse(names); fill(); }, () => {});

// Chooses a machine everywhere. A new file for a board is then one of the user's.
async function choose(name) {
  if (name.startsWith('board ')) {
    try {
      add(`${name.slice(6)}.toml`, await answers.call('template', name.slice(6)));
    } catch (error) {
      $('machine-trouble').textContent = error.message;
      fill();
    }
    return;
  }
  chosenMachine = name;
  fill();
  listeners.forEach(listen => listen());
}

// One more file of the user's is chosen, if it is not there yet.
function add(name, text) {
  const known = own.findIndex(file => file.name === name && file.text === text);
  return choose(`own ${known < 0 ? own.push({ name, text }) - 1 : known}`);
}

// The text has been edited: an example stays as it is, and its copy is the user's.
function edit(text) {
  const file = ownMachine();
  if (!file) return add(machineName(), text);
  file.text = text;
  return choose(chosenMachine);
}

// What a file is, by its content. All of an archive is needed, of other files the begin.
async function told(file, isMachineWanted) {
  let begin;
  try {
    begin = new Uint8Array(await file.slice(0, 1 << 20).arrayBuffer());
    if (begin[0] === 0x50 && begin[1] === 0x4b) begin = new Uint8Array(await file.arrayBuffer());
  } catch { begin = undefined; }
  return JSON.parse(await answers.call('told', begin, file.size, isMachineWanted));
}

// A file of the user's: it is edited where its errors are shown in their lines.
async function openMachine(file) {
  if (!file) return;
  const { trouble } = await told(file, true);
  if (trouble) {
    $('problem-count').textContent = `${file.name}: ${trouble}`;
    return;
  }
  add(file.name, await file.text());
  show($('tab-machine'));
}
$('open-machine').onchange = event => openMachine(event.target.files[0]);

const machineText = () => ownMachine()?.text ?? EXAMPLES.machines[chosenMachine];
const machineName = () => ownMachine()?.name ?? chosenMachine;
const machineJob = () => ({ machine_file: machineName(), machine: machineText() });

for (const list of lists) list.onchange = () => choose(list.value);
fill();
