// The machine from above: frame, bar, head, motors and belts, drawn once and then moved.
'use strict';

const SVG = 'http://www.w3.org/2000/svg';

function svg(tag, attributes, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element[name] = value;
    else if (value != null) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

// Teeth are drawn every so many mm: a real pitch of 2 mm would be a grey line.
const PITCH_MM = 12;

// Diameter of a part that is clicked, in CSS pixels, for a finger and for a mouse: WCAG 2.2, success criteria 2.5.5
// (enhanced) and 2.5.8 (minimum).
const FINGER_PX = 44;
const MOUSE_PX = 24;

// Places that differ by less are one to a pointer.
const SAME_MM = 1;

class MachinePicture {
  // `choose` gets a part that is clicked: its role (motor, idler, belt) and its name.
  constructor(element, choose = null) {
    this.element = element;
    this.choose = choose;
    this.frame = this.parts = null;
    this.marked = '';
  }

  clear() {
    this.element.replaceChildren();
    this.frame = this.parts = null;
  }

  // Draws what does not move; whether there is a picture.
  draw(frame) {
    const picture = this.element;
    this.clear();
    this.frame = frame;
    if (frame.why) {
      picture.setAttribute('viewBox', '0 0 400 60');
      picture.append(svg('text', { x: 200, y: 34, 'text-anchor': 'middle', class: 'note' }, 'no picture: no belts of this machine are known'));
      return false;
    }
    const { width_mm: w, depth_mm: d, radius_mm: r, reach_mm: [x0, y0, x1, y1] } = frame, edge = 6 * r;
    picture.setAttribute('viewBox', `${-edge} ${-d - edge} ${w + 2 * edge} ${d + 2 * edge}`);
    picture.append(
      svg('rect', { class: 'frame', x: -4 * r, y: -d - 4 * r, width: w + 8 * r, height: d + 8 * r, rx: r }),
      svg('rect', { class: 'reach', x: x0, y: -y1, width: x1 - x0, height: y1 - y0 }),
      svg('line', { class: 'guide', x1: -3 * r, y1: r, x2: -3 * r, y2: -d - r }),
      svg('line', { class: 'guide', x1: w + 3 * r, y1: r, x2: w + 3 * r, y2: -d - r }),
    );
    this.parts = {
      bar: svg('rect', { class: 'rail', x: -3.6 * r, width: w + 7.2 * r, height: 12 }),
      head: svg('rect', { class: 'head', width: 2 * frame.head_mm[0], height: 2 * Math.max(10, frame.head_mm[1] - 2 * r), rx: 3 }),
      belts: [], pulleys: [], tool: svg('circle', { class: 'tool', r: 4 }),
    };
    picture.append(this.parts.bar, this.parts.head);
    return true;
  }

  // Attributes of a part that can be clicked, or chosen by the keyboard.
  chosen(role, name) {
    if (!this.choose || !name) return {};
    const choose = event => role === 'belt' ? this.choose(role, name) : this.choose(...(this.nearest(event) ?? [role, name]));
    const onkeydown = event => { if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); choose(event); } };
    const words = { motor: `motor ${name}`, idler: `pulley ${name}`, belt: `belt of ${name}` }[role];
    return { role: 'button', tabindex: 0, 'aria-label': words, 'data-part': role === 'belt' ? null : name, onclick: choose, onkeydown };
  }

  begin({ belts, pulleys }) {
    const { frame, parts, element } = this, r = frame.radius_mm;
    parts.belts = belts.map(({ motor }, index) => [
      svg('path', { class: `belt belt${index % 4}`, ...this.chosen('belt', motor) }),
      svg('path', { class: 'teeth', 'stroke-dasharray': `${PITCH_MM / 4} ${PITCH_MM * 3 / 4}` }),
    ]);
    parts.pulleys = pulleys.map(({ at, name, role }) => svg('g', { class: role, ...this.chosen(role, name) },
      // `widen` sets the radius for what points at it.
      ...(this.choose && name ? [svg('circle', { class: 'target', r: 1.7 * r })] : []),
      ...(role === 'clamp' ? [svg('rect', { x: -4, y: -4, width: 8, height: 8 })] : [svg('circle', { r: r - 1 })]),
      ...(role === 'motor' ? [svg('line', { x1: 0, y1: 0, x2: r - 1, y2: 0 }), svg('text', { y: (at[1] > frame.depth_mm / 2 ? -1.5 : 2.4) * r, 'text-anchor': 'middle' }, name)] : []),
      ...(role === 'idler' && this.choose ? [svg('text', { y: 0.55 * r, 'text-anchor': 'middle' }, name)] : [])));
    element.append(...parts.belts.flat(), ...parts.pulleys, parts.tool);
    if (!this.choose) return;
    parts.places = pulleys.filter(({ name }) => name);
    this.widen();
    this.watch ??= new ResizeObserver(() => this.widen());
    this.watch.observe(element);
  }

  // Pulleys are hit as far from their middle as what points at them needs. Where several are hit, `nearest` decides.
  widen() {
    const { frame, parts } = this, scale = this.element.getScreenCTM()?.a;
    if (!scale || !parts) return;
    const wanted = (matchMedia('(pointer: coarse)').matches ? FINGER_PX : MOUSE_PX) / 2 / scale;
    for (const target of this.element.querySelectorAll('.target')) target.setAttribute('r', Math.max(wanted, 1.7 * frame.radius_mm).toFixed(2));
  }

  // Role and name of the pulley that is nearest to a click; none for a key. Where several have one place, the motor is
  // meant first, and each further click means the next one.
  nearest(event) {
    const matrix = this.element.getScreenCTM();
    if (!matrix || event.type !== 'click' || !event.detail) return null;
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    const far = ({ at }) => Math.hypot(at[0] - x, at[1] + y);
    const { places } = this.parts, least = Math.min(...places.map(far));
    const here = places.filter(place => far(place) < least + SAME_MM).sort((a, b) => (b.role === 'motor') - (a.role === 'motor'));
    const { role, name } = here[(here.findIndex(({ name }) => name === this.marked) + 1) % here.length];
    return [role, name];
  }

  move({ tool: [x, y], belts, pulleys }) {
    const { frame, parts } = this;
    if (!parts) return;
    if (!parts.belts.length) this.begin({ belts, pulleys });
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

  // Marks the part of this name.
  mark(name) {
    this.marked = name;
    for (const part of this.element.querySelectorAll('[data-part]')) part.classList.toggle('marked', part.dataset.part === name);
  }
}
