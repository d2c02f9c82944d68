// Words: elements, numbers and times as text.
const make = (tag, props = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), props);
  element.append(...children);
  return element;
};
/** An element of a drawing. */
const makeSvg = (tag, attributes = {}, ...children) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
};
const count = n => Math.round(n).toLocaleString("en-US");
/** `1:02:03`, or seconds with their fractions below a minute. */
const clock = s => {
  if (s < 59.95) return s === 0 ? "0 s" : s.toFixed(s < 1 ? 3 : s < 10 ? 2 : 1) + " s";
  const whole = Math.round(s), two = n => String(n).padStart(2, "0");
  return (whole >= 3600 ? Math.floor(whole / 3600) + ":" + two(Math.floor(whole / 60) % 60) : Math.floor(whole / 60)) + ":" + two(whole % 60);
};
/** `1:02`, also below a minute. */
const minutes = s => Math.round(s) < 60 ? "0:" + String(Math.round(s)).padStart(2, "0") : clock(s);
/** A number with as many digits as its size needs. */
const short = v => {
  const size = Math.abs(v);
  if (size >= 10000) return (v / 1000).toFixed(size >= 100000 ? 0 : 1) + "k";
  return String(+v.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3));
};
/** Numbers in equal steps, with as many digits as it takes to tell them apart. */
function apart(values) {
  const texts = values.map(short);
  if (new Set(texts).size === values.length) return texts;
  const step = Math.abs(values[1] - values[0]), digits = clamp(Math.ceil(-Math.log10(step)), 0, 6);
  return values.map(v => v.toFixed(digits));
}
/** The next of 1, 2, 5, 10, 20, 50 ... that is not below `span`. */
const nice = span => {
  const power = 10 ** Math.floor(Math.log10(span));
  return [1, 2, 5, 10].map(times => times * power).find(step => step >= span * 0.999999);
};
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
/** The first of `n` numbers, sorted, with a value above `limit`. */
const after = (n, value, limit) => {
  let a = 0, b = n;
  while (a < b) { const m = (a + b) >> 1; if (value(m) <= limit) a = m + 1; else b = m; }
  return a;
};
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
/** Lets the page draw and react. */
const breathe = () => new Promise(go => setTimeout(go));
