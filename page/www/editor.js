// The machine file: problems in their lines, and the meaning of the key at the cursor, from the schema.
'use strict';

const text = $('text'), under = $('under');
let schema = null, found = [];

answers.call('schema').then(json => { schema = JSON.parse(json); showKeys(); }, () => {});

// --- the text

let shown = null;

function load() {
  const now = machineText();
  if (now === shown) return;
  shown = text.value = now;
  drawEditor();
  check();
}
listeners.push(load);

text.oninput = () => {
  shown = text.value;
  edit(shown);
  drawEditor();
  check();
};

let checks = 0;

async function check() {
  const mine = ++checks;
  try {
    const problems = JSON.parse(await answers.call('problems', text.value));
    if (mine !== checks) return;
    found = problems;
  } catch (error) {
    found = [{ line: null, text: error.message, is_error: true }];
  }
  drawEditor();
  const errors = found.filter(problem => problem.is_error).length, warnings = found.length - errors;
  const count = (n, name) => `${n} ${name}${n === 1 ? '' : 's'}`;
  $('problem-count').textContent = found.length ? `${count(errors, 'error')}, ${count(warnings, 'warning')}` : 'a machine without a fault';
  $('problems').replaceChildren(...(found.length ? found.map(problem => make('li', { class: problem.is_error ? 'bad' : 'warn' },
    make('button', { type: 'button', onclick: () => go(problem) },
      problem.line ? `line ${problem.line}: ${problem.text}` : problem.text))) : [make('li', { class: 'sub' }, 'none')]));
}

function go({ line, column }) {
  if (!line) return;
  const lines = text.value.split('\n');
  const at = lines.slice(0, line - 1).reduce((sum, each) => sum + each.length + 1, 0) + column - 1;
  text.focus();
  text.setSelectionRange(at, at);
  text.scrollTop = Math.max(0, (line - 6) * lineHeight());
  explain();
}

function lineHeight() {
  return parseFloat(getComputedStyle(text).lineHeight);
}

// In the line there is no room for the known names; the list beside it has them.
function short({ text }) {
  return text.replace(/, expected one of .*?(; did you mean|$)/, '$1');
}

// Under the text stands the same text unseen, with the numbers of its lines and with what is wrong in them.
function drawEditor() {
  const wrong = new Map();
  for (const problem of found) if (problem.line) wrong.set(problem.line, [...(wrong.get(problem.line) ?? []), problem]);
  under.replaceChildren(...text.value.split('\n').map((line, index) => {
    const here = wrong.get(index + 1) ?? [];
    const kind = here.some(problem => problem.is_error) ? 'bad' : here.length ? 'warn' : null;
    return make('div', { class: kind }, make('i', {}, String(index + 1)), make('span', {}, line || ' '),
      ...(here.length ? [make('em', {}, here.map(short).join('; '))] : []));
  }));
  follow();
}

function follow() {
  under.style.transform = `translate(${-text.scrollLeft}px, ${-text.scrollTop}px)`;
}
text.onscroll = follow;

// --- the key at the cursor

// The tables and the key of a line, as the headers above it say.
function keyAt(at) {
  const lines = text.value.slice(0, at).split('\n').length;
  const all = text.value.split('\n').slice(0, lines);
  let table = [];
  for (const line of all) {
    const header = /^\s*\[+\s*([^\]]+?)\s*\]+/.exec(line);
    if (header) table = header[1].split('.').map(part => part.trim().replace(/^["']|["']$/g, ''));
  }
  const key = /^\s*([\w.-]+)\s*=/.exec(all[lines - 1]);
  return key ? [...table, ...key[1].split('.')] : table;
}

// The schema of a key by its tables.
function of(path) {
  let at = schema;
  for (const part of path) {
    const pattern = Object.entries(at?.patternProperties ?? {}).find(([pattern]) => new RegExp(pattern).test(part))?.[1];
    const rest = typeof at?.additionalProperties === 'object' ? at.additionalProperties : undefined;
    at = at?.properties?.[part] ?? pattern ?? rest;
  }
  return at;
}

function kind(key) {
  const parts = [];
  if (key.anyOf) return key.anyOf.map(kind).join(' or ');
  if (key.enum) parts.push(`one of ${key.enum.join(', ')}`);
  else if (key.type && key.type !== 'object') parts.push(key.type);
  if (key.minimum !== undefined) parts.push(`from ${key.minimum} to ${key.maximum}`);
  if (key.default !== undefined && key.type !== 'object') parts.push(`${JSON.stringify(key.default)} if left out`);
  return parts.join(', ');
}

function showMeaning(path, key) {
  $('key-name').textContent = path.join('.') || 'Keys';
  $('key-meaning').textContent = key ? [key.description, kind(key)].filter(Boolean).join(' ') : 'There is no such key.';
}

function explain() {
  if (!schema) return;
  const path = keyAt(text.selectionStart), key = of(path);
  showMeaning(path, key);
  if (!$('find-key').value) showKeys(path);
}
for (const name of ['keyup', 'click', 'focus', 'input']) text.addEventListener(name, explain);

function* leaves(node, path = []) {
  for (const [name, key] of Object.entries(node.properties ?? {})) {
    if (key.properties) yield* leaves(key, [...path, name]);
    else yield [[...path, name], key];
  }
}

// Keys of a table, or all that a word finds.
function showKeys(path = []) {
  if (!schema) return;
  const word = $('find-key').value.trim().toLowerCase();
  let keys;
  if (word) {
    keys = [...leaves(schema)].filter(([path, key]) => `${path.join('.')} ${key.description}`.toLowerCase().includes(word));
  } else {
    while (path.length && !of(path)?.properties) path = path.slice(0, -1);
    keys = Object.entries(of(path)?.properties ?? {}).map(([name, key]) => [[...path, name], key]);
  }
  // A table leads back to the one around it.
  const above = path.slice(0, -1), back = word || !path.length ? [] : [
    make('dt', {}, make('button', { type: 'button', onclick: () => openTable(above, of(above)) }, `‹ ${above.join('.') || 'all tables'}`))];
  $('keys').replaceChildren(...back, ...keys.slice(0, 120).flatMap(([path, key]) => [
    make('dt', {}, make('button', { type: 'button', onclick: () => key.properties ? openTable(path, key) : insert(path, key) }, path.join('.'))),
    make('dd', {}, [key.description, kind(key)].filter(Boolean).join(' ')),
  ]));
}
$('find-key').oninput = () => showKeys();

// Shows the keys of a table.
function openTable(path, key) {
  showMeaning(path, key);
  showKeys(path);
}

// A value that a key can have, for keys that have none if they are left out.
function exampleOf(key) {
  const { anyOf, type, minimum, exclusiveMinimum, minItems = 0, items } = key;
  if (anyOf) return exampleOf(anyOf[0]);
  const least = exclusiveMinimum === undefined ? minimum ?? 0 : exclusiveMinimum + 1;
  const examples = { boolean: false, array: Array(minItems).fill(0), integer: least, number: least, string: '' };
  return key.default ?? key.enum?.[0] ?? examples[type];
}

// Writes a key at the end of its table, or goes to it.
function insert(path, key) {
  const lines = text.value.split('\n'), table = path.slice(0, -1).join('.'), name = path.at(-1);
  const isHeader = line => /^\s*\[/.test(line);
  let begin = table ? lines.findIndex(line => line.replace(/\s/g, '').startsWith(`[${table}]`)) : -1;
  if (table && begin < 0) {
    lines.push('', `[${table}]`);
    begin = lines.length - 1;
  }
  let end = begin + 1;
  while (end < lines.length && !isHeader(lines[end])) end++;
  const known = lines.findIndex((line, index) => index > begin && index < end && new RegExp(`^\\s*${name}\\s*=`).test(line));
  const value = JSON.stringify(exampleOf(key));
  let at = known;
  if (known < 0) {
    at = end;
    while (at > begin + 1 && !lines[at - 1].trim()) at--;
    lines.splice(at, 0, `${name} = ${value}`);
    text.value = lines.join('\n');
    text.oninput();
  }
  go({ line: at + 1, column: 1 });
  // A new value is there to be typed over.
  const last = text.selectionStart + lines[at].length;
  if (known < 0) text.setSelectionRange(last - value.length, last);
}

$('save-machine').onclick = () => save(machineName(), text.value, 'application/toml');

load();
