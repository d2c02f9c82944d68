// The machines to choose from: the prototype, the files of examples/machines, new files for a board, and the user's own
// files. All lists show the same choice.
'use strict';

// Files that were opened, made for a board or edited, with their names and texts; none is lost by another choice, nor by a
// reload: each is kept in the browser under a key of its own, so that another window of the page overwrites none. A file
// that was taken out of the list is null.
const own = [];

// The file that was taken out last, and its place: it can be brought back until the page is left.
let forgotten = null;

// Keys of what the browser keeps: files begin with the first one.
const KEPT = 'corehbot machine ', CHOSEN = 'corehbot chosen machine';

// Why the browser keeps nothing, if it does not.
let unkept = '';

// What the browser has kept, or may be asked to keep: it can be switched off, or be full.
function inBrowser(act) {
  try {
    unkept = '';
    return act(localStorage);
  } catch (error) {
    unkept = error.message;
    return null;
  }
}

function readKept() {
  const keys = inBrowser(store => Object.keys(store)) ?? [];
  for (const key of keys.filter(key => key.startsWith(KEPT)).sort()) {
    try {
      const { name, text } = JSON.parse(inBrowser(store => store.getItem(key)));
      if (typeof name === 'string' && typeof text === 'string') own.push({ key, name, text });
    } catch {
      // What is no file of ours stays where it is.
    }
  }
}

function keep(file) {
  // In the order of their making, also if two windows make them.
  file.key ??= `${KEPT}${String(Date.now()).padStart(15, '0')} ${Math.random().toString(36).slice(2)}`;
  inBrowser(store => store.setItem(file.key, JSON.stringify({ name: file.name, text: file.text })));
  tellKept();
}

// What becomes of the person's files, for as long as there are any.
function tellKept() {
  const files = own.filter(Boolean), kept = $('kept'), one = files.length === 1, yours = one ? 'your file' : `your ${files.length} files`;
  kept.hidden = !files.length;
  $('forget-machine').hidden = !ownMachine();
  $('restore-machine').hidden = !forgotten;
  $('restore-machine').textContent = forgotten ? `Bring ${forgotten.file.name} back` : '';
  kept.className = unkept ? 'bad' : 'sub';
  kept.textContent = unkept
    ? `This browser does not keep ${yours} (${unkept}): a reload loses ${one ? 'it' : 'them'}. Save ${one ? 'it' : 'each'} with “Save file”.`
    : `This browser keeps ${yours}, on this computer alone, until its data are cleared. “Save file” takes one along.`;
}

readKept();

// An example's name, or `own` and a number.
let chosenMachine = 'prototype.toml';

// The choice of before a reload.
const chosenBefore = inBrowser(store => store.getItem(CHOSEN));
const keptBefore = own.findIndex(({ key }) => key === chosenBefore);
if (keptBefore >= 0) chosenMachine = `own ${keptBefore}`;
else if (Object.hasOwn(EXAMPLES.machines, chosenBefore ?? '')) chosenMachine = chosenBefore;

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
    const label = (name, index) => {
      const earlier = own.slice(0, index).filter(other => other?.name === name).length;
      return name.replace(/\.toml$/, '') + (earlier ? ` (${earlier + 1})` : '');
    };
    const mine = own.flatMap((file, index) => file ? [make('option', { value: `own ${index}` }, label(file.name, index))] : []);
    if (mine.length) groups.unshift(make('optgroup', { label: 'Your files' }, ...mine));
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
  inBrowser(store => store.setItem(CHOSEN, ownMachine()?.key ?? name));
  tellKept();
  fill();
  listeners.forEach(listen => listen());
}

// One more file of the user's is chosen, if it is not there yet.
function add(name, text) {
  const known = own.findIndex(file => file?.name === name && file.text === text);
  if (known >= 0) return choose(`own ${known}`);
  const file = { name, text };
  own.push(file);
  keep(file);
  return choose(`own ${own.length - 1}`);
}

// The text has been edited: an example stays as it is, and its copy is the user's.
function edit(text) {
  const file = ownMachine();
  if (!file) return add(machineName(), text);
  file.text = text;
  keep(file);
  return choose(chosenMachine);
}

// A file of the user's goes, here and in the browser. The example that it was made from is chosen, if there is one.
$('forget-machine').onclick = () => {
  const file = ownMachine();
  if (!file) return;
  forgotten = { file, place: own.indexOf(file) };
  own[forgotten.place] = null;
  inBrowser(store => store.removeItem(file.key));
  choose(Object.hasOwn(EXAMPLES.machines, file.name) ? file.name : 'prototype.toml');
};
$('restore-machine').onclick = () => {
  const { file, place } = forgotten;
  forgotten = null;
  own[place] = file;
  keep(file);
  choose(`own ${place}`);
};

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
tellKept();
