// The terminal: a printer at the end of a serial line, and a picture of its machine.
'use strict';

const line = new Firmware(heard);
let isTerminalShown = false, isOpen = false, frame = null;
const picture = new MachinePicture($('picture'));

const COMMANDS = ['M115', 'G28', 'G1 X120 Y80 F6000', 'M114', 'M105', 'M122', 'M503', 'M112', 'M999'];
// Accidents next to what hands do, which the firmware's simulator names.
const ACCIDENTS = ['open:hotend', 'stuck-on:hotend'];

// A log that is longer is cut at its begin.
const LONGEST_LOG = 60000;

function log(text, kind) {
  const log = $('log'), isAtEnd = log.scrollHeight - log.scrollTop - log.clientHeight < 30;
  log.append(kind ? make('span', { class: kind }, text) : text);
  while (log.textContent.length > LONGEST_LOG && log.firstChild) log.firstChild.remove();
  if (isAtEnd) log.scrollTop = log.scrollHeight;
}

// What is said to a printer that is switched off meanwhile is lost.
function tell(...call) {
  line.call(...call).catch(() => {});
}

// How often a printer was switched on; the last one counts.
let opened = 0, isOpening = false;

async function power() {
  const mine = ++opened;
  isOpen = true;
  frame = null;
  $('log').replaceChildren();
  history.length = back = 0;
  if (isOpening) line.end();
  isOpening = true;
  try {
    const now = JSON.parse(await line.call('open', JSON.stringify({ ...machineJob(), homed: null })));
    if (mine !== opened) return;
    frame = now;
    tell('speed', Number($('speed').value));
    $('picture-name').textContent = frame.name ?? 'Machine';
    picture.draw(frame);
    tell('run', isTerminalShown);
  } catch (error) {
    if (mine !== opened) return;
    say('off');
    picture.clear();
    for (const id of ['place', 'heat', 'dials']) $(id).replaceChildren();
    dialNames = '';
    $('picture-name').textContent = 'No machine';
    log(`${error.message}\n`, 'bad');
  } finally {
    if (mine === opened) isOpening = false;
  }
}

function terminalShown(isShown) {
  isTerminalShown = isShown;
  if (isShown && !isOpen) power();
  else if (isOpen) tell('run', isShown);
}

listeners.push(() => {
  isOpen = false;
  if (isTerminalShown) power();
});
$('power').onclick = power;
$('speed').onchange = event => tell('speed', Number(event.target.value));

// --- the line

const history = [];
// Where the arrow keys are in it, and the line that was begun before they left it.
let back = 0, begunLine = '';

// Whether the printer hears; a printer that a hand has switched off does not, and the log says so.
function isHeard() {
  const isHeard = !frame || $('state').textContent !== 'off';
  if (!isHeard) log(`the printer is off: “${$('power').textContent}” starts it again\n`, 'bad');
  return isHeard;
}

function send(command) {
  if (!command.trim()) return;
  log(`${command}\n`, 'typed');
  history.push(command);
  back = history.length;
  if (isHeard()) line.call('send', `${command}\n`).catch(error => log(`${error.message}\n`, 'bad'));
}

$('line').onsubmit = event => {
  event.preventDefault();
  send($('command').value);
  $('command').value = '';
};
$('command').onkeydown = event => {
  const step = { ArrowUp: -1, ArrowDown: 1 }[event.key];
  if (!step) return;
  event.preventDefault();
  if (back === history.length) begunLine = $('command').value;
  back = Math.max(0, Math.min(history.length, back + step));
  $('command').value = history[back] ?? begunLine;
};
$('commands').append(...COMMANDS.map(command => make('button', { type: 'button', onclick: () => send(command) }, command)));

function act(what) {
  log(`(${what})\n`, 'typed');
  if (isHeard()) line.call('act', what).catch(error => log(`${error.message}\n`, 'bad'));
}
answers.call('hands').then(hands => {
  for (const what of [...JSON.parse(hands), ...ACCIDENTS])
    $('acts').append(make('button', { type: 'button', onclick: () => act(what) }, what));
}, () => {});

// --- what comes from the printer

function say(state, kind = '') {
  if ($('state').textContent === state) return;
  $('state').textContent = state;
  $('state').className = `badge ${kind}`;
}

function heard({ terminal: { said, state } }) {
  if (said) log(said);
  const { tool_mm: tool, is_off: isOff, is_halted: isHalted, is_for_user: isForUser, is_ready: isReady, is_moving: isMoving, moves_ahead: ahead, heaters, turns, picture: moved, now_s: now } = JSON.parse(state);
  const word = isOff ? 'off' : isHalted ? 'halted' : isForUser ? 'waits for the user' : isMoving ? 'moving' : isReady && !ahead ? 'ready' : 'busy';
  say(word, isOff ? '' : isHalted ? 'bad' : 'good');
  $('place').textContent = `tool at X${tool[0].toFixed(2)} Y${tool[1].toFixed(2)} Z${tool[2].toFixed(2)} mm, ${ahead} moves ahead, ${time(now)} since power-up`;
  $('heat').textContent = heaters.map(heater => `${heater.name} ${heater.measured_c === null ? '?' : heater.measured_c.toFixed(1)} of ${heater.target_c.toFixed(0)} °C, ${(100 * heater.duty).toFixed(0)} %`).join('   ') || 'no heaters fitted';
  dials(turns);
  if (moved) picture.move(moved);
}

let dialNames = '';

function dials(turns) {
  const names = turns.map(([name]) => name).join();
  if (names !== dialNames) {
    dialNames = names;
    $('dials').replaceChildren(...turns.map(([name]) => make('span', { class: 'dial' }, svg('svg', { viewBox: '-10 -10 20 20', 'aria-hidden': 'true' }, svg('circle', { r: 9 }), svg('line', { x2: 9 })), make('small', {}, name))));
  }
  turns.forEach(([, turn], index) => {
    $('dials').children[index].querySelector('line').setAttribute('transform', `rotate(${(-turn * 360 % 360).toFixed(1)})`);
  });
}
