// Runs the script of a page of runs (`flexarm plot --html`) without a browser: a document that
// holds what the script asks for, a canvas that counts strokes, and the user's gestures.
// Usage: node page_world.js PAGE.html; prints what was drawn as JSON.
"use strict";
const page = require("fs").readFileSync(process.argv[2], "utf8");
const strokes = { lines: 0, points: 0, invalid: 0 };
const elements = new Map();
const frames = [];

const pen = new Proxy({}, {
  get: (target, name) => name in target ? target[name] : (...numbers) => {
    if (name === "stroke") ++strokes.lines;
    if (name === "lineTo") ++strokes.points;
    if (numbers.some((n) => typeof n === "number" && !Number.isFinite(n))) ++strokes.invalid;
  },
});

class Element {
  constructor(tag) {
    Object.assign(this, { tag, style: {}, children: [], listeners: {}, textContent: "", clientWidth: 800 });
  }
  appendChild(child) { this.children.push(child); return child; }
  replaceChildren() { this.children = []; }
  addEventListener(kind, action) { this.listeners[kind] = action; }
  getContext() { return pen; }
  getBoundingClientRect() { return { left: 0, width: 800 }; }
  setPointerCapture() {}
  get text() { return this.textContent + this.children.map((child) => child.text).join("\n"); }
}

globalThis.document = {
  documentElement: new Element("html"),
  createElement: (tag) => new Element(tag),
  getElementById: (id) => {
    if (!page.includes(`id="${id}"`)) throw new Error(`the page has no element ${id}`);
    if (!elements.has(id)) elements.set(id, new Element(id));
    return elements.get(id);
  },
};
globalThis.getComputedStyle = () => ({ getPropertyValue: () => "#000000" });
globalThis.matchMedia = () => new Element("media");
globalThis.window = new Element("window");
globalThis.requestAnimationFrame = (action) => frames.push(action);

document.getElementById("data").textContent = /id="data">(.*?)<\/script>/s.exec(page)[1];
new Function(/<script>\n(.*?)<\/script>/s.exec(page)[1])();

const settle = () => {
  for (let clock = performance.now() + 1000, i = 0; frames.length > 0 && i < 400; ++i, clock += 50) {
    frames.shift()(clock);
  }
};
const first = document.getElementById("panels").children[0];
const gesture = (kind, x) => first.children[1].listeners[kind]({ clientX: x, pointerId: 1 });
gesture("pointermove", 423);
settle();
const pointed = first.text;
gesture("pointerdown", 200);
gesture("pointerup", 500);
for (const id of ["in", "out", "all", "play"]) {
  document.getElementById(id).listeners.click({});
  settle();
}
console.log(JSON.stringify({
  ...strokes, pointed, panels: document.getElementById("panels").text,
  runs: document.getElementById("runs").text, events: document.getElementById("events").text,
  figures: document.getElementById("figures").text, now: document.getElementById("now").text,
}));
