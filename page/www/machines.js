// The machines to choose from: the prototype, the files of examples/machines, new files for a board, and the file of
// the editor. All lists show the same choice.
'use strict';

const PROTOTYPE = 'prototype.toml', MINE = 'mine';

// The text of the editor, once it differs from a chosen file.
const mine = { name: 'machine.toml', text: null };

let chosenMachine = PROTOTYPE;

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
    if (mine.text !== null) groups.unshift(make('option', { value: MINE }, 'the edited file'));
    list.replaceChildren(...groups);
    list.value = chosenMachine;
  }
}

let boardNames = [];
answers.call('boards').then(names => { boardNames = JSON.parse(names); fill(); }, () => {});

// Chooses a machine everywhere. A new file for a board is made once, and is then the edited file.
async function choose(name) {
  if (name.startsWith('board ')) {
    try {
      edit(await answers.call('template', name.slice(6)), `${name.slice(6)}.toml`);
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

// The text has been edited.
function edit(text, name = mine.name) {
  Object.assign(mine, { text, name });
  chosenMachine = MINE;
  fill();
  listeners.forEach(listen => listen());
}

// A file of the user's: it is edited where its errors are shown in their lines.
async function openMachine(file) {
  if (!file) return;
  edit(await file.text(), file.name);
  show($('tab-machine'));
}
$('open-machine').onchange = event => openMachine(event.target.files[0]);

function machineText() {
  return chosenMachine === MINE ? mine.text : EXAMPLES.machines[chosenMachine];
}

function machineJob() {
  return { machine_file: chosenMachine === MINE ? mine.name : chosenMachine, machine: machineText() };
}

for (const list of lists) list.onchange = () => choose(list.value);
fill();
