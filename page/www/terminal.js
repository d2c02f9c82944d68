// The terminal: a printer at the end of a serial line, and a picture of its machine.
'use strict';

const SVG = 'http://www.w3.org/2000/svg';
const line = new Firmware(heard);
let isTerminalShown = false, isOpen = false, frame = null, parts = null;

const COMMANDS = ['M115', 'G28', 'G1 X120 Y80 F6000', 'M114', 'M105', 'M122', 'M503', 'M112', 'M999'];
const ACTS = ['press x', 'press y', 'let go', 'warm hotend', 'open:hotend', 'stuck-on:hotend', 'reset'];

// A log that is longer is cut at its begin.
const LONGEST_LOG = 60000;

function log(text, kind) {
  const log = $('log'), isAtEnd = log.scrollHeight - log.scrollTop - log.clientHeight < 30;
  log.append(kind ? make('span', { class: kind }, text) : text);
  while (log.textContent.length > LONGEST_LOG && log.firstChild) log.firstChild.remove();
  if (isAtEnd) log.scrollTop = log.scrollHeight;
}

async function power() {
  isOpen = true;
  $('log').replaceChildren();
  history.length = 0;
  if (busy) line.end();
  busy = true;
  try {
    frame = JSON.parse(await line.call('open', JSON.stringify({ ...machineJob(), homed: null })));
    line.call('speed', Number($('speed').value));
    drawFrame();
    line.call('run', isTerminalShown);
  } catch (error) {
    frame = null;
    $('state').textContent = 'off';
    log(`${error.message}\n`, 'bad');
  } finally {
    busy = false;
  }
}
let busy = false;

function terminalShown(isShown) {
  isTerminalShown = isShown;
  if (isShown && !isOpen) power();
  else if (isOpen) line.call('run', isShown).catch(() => {});
}

listeners.push(() => {
  isOpen = false;
  if (isTerminalShown) power();
});
$('power').onclick = power;
$('speed').onchange = event => line.call('speed', Number(event.target.value));

// --- the line

const history = [];
let back = 0;

function send(command) {
  if (!command.trim()) return;
  log(`${command}\n`, 'typed');
  history.push(command);
  back = history.length;
  line.call('send', `${command}\n`).catch(error => log(`${error.message}\n`, 'bad'));
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
  back = Math.max(0, Math.min(history.length, back + step));
  $('command').value = history[back] ?? '';
};
$('commands').append(...COMMANDS.map(command => make('button', { type: 'button', onclick: () => send(command) }, command)));
$('acts').append(...ACTS.map(what => make('button', {
  type: 'button',
  onclick: () => {
    log(`(${what})\n`, 'typed');
    line.call('act', what).catch(error => log(`${error.message}\n`, 'bad'));
  },
}, what)));

// --- the picture

function svg(tag, attributes, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

function drawFrame() {
  const picture = $('picture');
  picture.replaceChildren();
  parts = null;
  $('picture-name').textContent = frame.name ?? 'Machine';
  if (frame.why) {
    picture.setAttribute('viewBox', '0 0 400 60');
    picture.append(svg('text', { x: 200, y: 34, 'text-anchor': 'middle', class: 'note' }, 'no picture: no belts of this machine are known'));
    return;
  }
  const { width_mm: w, depth_mm: d, radius_mm: r, reach_mm: [x0, y0, x1, y1] } = frame, edge = 6 * r;
  picture.setAttribute('viewBox', `${-edge} ${-d - edge} ${w + 2 * edge} ${d + 2 * edge}`);
  picture.append(
    svg('rect', { class: 'frame', x: -4 * r, y: -d - 4 * r, width: w + 8 * r, height: d + 8 * r, rx: r }),
    svg('rect', { class: 'reach', x: x0, y: -y1, width: x1 - x0, height: y1 - y0 }),
    svg('line', { class: 'guide', x1: -3 * r, y1: r, x2: -3 * r, y2: -d - r }),
    svg('line', { class: 'guide', x1: w + 3 * r, y1: r, x2: w + 3 * r, y2: -d - r }),
  );
  parts = {
    bar: svg('rect', { class: 'rail', x: -3.6 * r, width: w + 7.2 * r, height: 12 }),
    head: svg('rect', { class: 'head', width: 2 * frame.head_mm[0], height: 2 * Math.max(10, frame.head_mm[1] - 2 * r), rx: 3 }),
    belts: [], pulleys: [], tool: svg('circle', { class: 'tool', r: 4 }),
  };
  picture.append(parts.bar, parts.head);
}

// Teeth are drawn every so many mm: a real pitch of 2 mm would be a grey line.
const PITCH_MM = 12;

function drawMoved({ tool: [x, y], belts, pulleys }) {
  const picture = $('picture'), r = frame.radius_mm;
  if (!parts.belts.length) {
    parts.belts = belts.map((_, index) => [svg('path', { class: `belt belt${index % 4}` }), svg('path', { class: 'teeth', 'stroke-dasharray': `${PITCH_MM / 4} ${PITCH_MM * 3 / 4}` })]);
    parts.pulleys = pulleys.map(pulley => svg('g', { class: pulley.role },
      ...(pulley.role === 'clamp' ? [svg('rect', { x: -4, y: -4, width: 8, height: 8 })] : [svg('circle', { r: r - 1 })]),
      ...(pulley.role === 'motor' ? [svg('line', { x1: 0, y1: 0, x2: r - 1, y2: 0 }), svg('text', { y: (pulley.at[1] > frame.depth_mm / 2 ? -1.5 : 2.4) * r, 'text-anchor': 'middle' }, pulley.name)] : [])));
    picture.append(...parts.belts.flat(), ...parts.pulleys, parts.tool);
  }
  parts.bar.setAttribute('y', -y - 6);
  parts.head.setAttribute('x', x - frame.head_mm[0]);
  parts.head.setAttribute('y', -y - Number(parts.head.getAttribute('height')) / 2);
  parts.tool.setAttribute('transform', `translate(${x} ${-y})`);
  belts.forEach(({ path, passed_mm: passed }, index) => {
    const [belt, teeth] = parts.belts[index];
    belt.setAttribute('d', path);
    teeth.setAttribute('d', path);
    teeth.setAttribute('stroke-dashoffset', (-passed % PITCH_MM).toFixed(3));
  });
  pulleys.forEach(({ at: [x, y], role, turned_rad: turned }, index) => {
    const pulley = parts.pulleys[index];
    pulley.setAttribute('transform', `translate(${x} ${-y})`);
    if (role === 'motor') pulley.querySelector('line').setAttribute('transform', `rotate(${(-turned * 180 / Math.PI).toFixed(2)})`);
  });
}

function heard({ terminal: { said, state } }) {
  if (said) log(said);
  const { tool_mm: tool, is_halted: isHalted, is_for_user: isForUser, is_ready: isReady, moves_ahead: ahead, heaters, turns, picture, now_s: now } = JSON.parse(state);
  const word = isHalted ? 'halted' : isForUser ? 'waits for the user' : isReady && !ahead ? 'ready' : 'busy';
  if ($('state').textContent !== word) {
    $('state').textContent = word;
    $('state').className = `badge ${isHalted ? 'bad' : 'good'}`;
  }
  $('place').textContent = `X${tool[0].toFixed(2)} Y${tool[1].toFixed(2)} Z${tool[2].toFixed(2)} mm, ${ahead} moves ahead, ${time(now)} since power-up`;
  $('heat').textContent = heaters.map(heater => `${heater.name} ${heater.measured_c === null ? '?' : heater.measured_c.toFixed(1)} of ${heater.target_c.toFixed(0)} °C, ${(100 * heater.duty).toFixed(0)} %`).join('   ') || 'no heaters fitted';
  dials(turns);
  if (picture && parts) drawMoved(picture);
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
