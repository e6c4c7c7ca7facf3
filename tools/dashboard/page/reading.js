// Reads values of a status, any of which may be missing or of another type, and writes them into
// the page without touching what has not changed.

export function numberOf(value) {
  return typeof value === "number" && Number.isFinite(value) ? value : null;
}

export function numberAt(list, i) {
  return Array.isArray(list) ? numberOf(list[i]) : null;
}

export function textOf(value, otherwise = "") {
  return typeof value === "string" ? value : otherwise;
}

export function listOf(value) {
  return Array.isArray(value) ? value : [];
}

export function objectOf(value) {
  return value !== null && typeof value === "object" && !Array.isArray(value) ? value : {};
}

// "1.50", or "-" if it is not known.
export function figure(value, decimals) {
  const number = numberOf(value);
  return number === null ? "-" : number.toFixed(decimals);
}

// The same with its sign, with a true minus.
export function signed(value, decimals) {
  const number = numberOf(value);
  if (number === null) return "-";
  const text = Math.abs(number).toFixed(decimals);
  return (number < 0 && Number(text) !== 0 ? "\u2212" : "+") + text;
}

export function ageText(seconds) {
  if (seconds < 1e-3) return `${(seconds * 1e6).toFixed(0)} \u00b5s`;
  if (seconds < 1) return `${(seconds * 1e3).toFixed(seconds < 0.01 ? 1 : 0)} ms`;
  return seconds < 100 ? `${seconds.toFixed(1)} s` : `${(seconds / 60).toFixed(0)} min`;
}

export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function setLook(element, look) {
  if (element.dataset.look !== look) element.dataset.look = look;
}

export function make(tag, className = "", text = "") {
  const element = document.createElement(tag);
  if (className) element.className = className;
  if (text) element.textContent = text;
  return element;
}

export function makeSvg(tag, attributes = {}) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

export function byId(id) {
  return document.getElementById(id);
}

// As many children as there are items; `fill(child, item)` writes one.
export function fillChildren(parent, items, create, fill) {
  while (parent.children.length > items.length) parent.lastElementChild.remove();
  items.forEach((item, i) => {
    if (i === parent.children.length) parent.append(create());
    fill(parent.children[i], item);
  });
}
