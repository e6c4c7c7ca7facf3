// Curves of the last seconds: measured as a full line, the reference dashed.

import {anglesOf, tipOf} from "./arm.js";
import {byId, make, makeSvg, setText, signed} from "./reading.js";

const SPAN_S = 20;
const WIDTH = 340, HEIGHT = 170, LEFT = 44, RIGHT = 8, TOP = 8, BOTTOM = 20;

const CURVES = [
  {title: "Joint 1", unit: "deg", decimals: 1, least: 4, pick: (s) => s.angle[0], ref: (s) => s.wanted[0]},
  {title: "Joint 2", unit: "deg", decimals: 1, least: 4, pick: (s) => s.angle[1], ref: (s) => s.wanted[1]},
  {title: "Tip x", unit: "m", decimals: 3, least: 0.04, pick: (s) => s.tip?.x ?? null,
    ref: (s) => s.wantedTip?.x ?? null},
  {title: "Tip y", unit: "m", decimals: 3, least: 0.04, pick: (s) => s.tip?.y ?? null,
    ref: (s) => s.wantedTip?.y ?? null},
];

// 1, 2 or 5 times a power of ten, for about four lines over a range.
function niceStep(range) {
  const rough = range / 4, power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= rough);
}

class Plot {
  constructor(curve, parent) {
    this.curve = curve;
    const figure = make("figure", "plot");
    this.caption = make("figcaption", "", curve.title);
    this.svg = makeSvg("svg", {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img",
      "aria-label": `${curve.title} over the last ${SPAN_S} seconds`});
    this.grid = makeSvg("g", {class: "plot-grid"});
    this.reference = makeSvg("path", {class: "plot-reference"});
    this.measured = makeSvg("path", {class: "plot-measured"});
    this.svg.append(this.grid, this.measured, this.reference);
    figure.append(this.caption, this.svg);
    parent.append(figure);
  }

  draw(samples, now) {
    const {pick, ref, least, decimals, unit, title} = this.curve;
    const values = samples.flatMap((s) => [pick(s), ref(s)]).filter((v) => v !== null);
    const last = samples[samples.length - 1];
    const wanted = last ? ref(last) : null;
    setText(this.caption, `${title}: ${signed(last ? pick(last) : null, decimals)} ${unit}` +
      (wanted === null ? "" : `, reference ${signed(wanted, decimals)}`));
    let low = Math.min(...values), high = Math.max(...values);
    if (!values.length) [low, high] = [-least / 2, least / 2];
    const spare = Math.max((least - (high - low)) / 2, 0.06 * (high - low));
    low -= spare;
    high += spare;
    const x = (t) => LEFT + (WIDTH - LEFT - RIGHT) * (1 + (t - now) / SPAN_S);
    const y = (v) => TOP + (HEIGHT - TOP - BOTTOM) * (high - v) / (high - low);
    this.drawGrid(low, high, y);
    this.measured.setAttribute("d", path(samples, pick, x, y));
    this.reference.setAttribute("d", path(samples, ref, x, y));
  }

  drawGrid(low, high, y) {
    const step = niceStep(high - low);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const parts = [];
    const line = (x1, y1, x2, y2) => makeSvg("line", {x1, y1, x2, y2});
    const label = (text, x, at, anchor) => {
      const element = makeSvg("text", {x, y: at, "text-anchor": anchor});
      element.textContent = text;
      return element;
    };
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) {
      parts.push(line(LEFT, y(v), WIDTH - RIGHT, y(v)),
        label(v.toFixed(digits).replace(/^-(?=0\.?0*$)/, ""), LEFT - 6, y(v) + 4, "end"));
    }
    for (let t = -SPAN_S; t <= 0; t += 5) {
      const at = LEFT + (WIDTH - LEFT - RIGHT) * (1 + t / SPAN_S);
      parts.push(line(at, TOP, at, HEIGHT - BOTTOM),
        label(t ? `\u2212${-t} s` : "now", at, HEIGHT - 5, t ? "middle" : "end"));
    }
    this.grid.replaceChildren(...parts);
  }
}

// A line with a gap where a value is not known, or the samples lie apart.
function path(samples, pick, x, y) {
  let d = "", before = null;
  for (const sample of samples) {
    const value = pick(sample);
    if (value !== null) {
      const follows = before !== null && sample.t - before < 2.5;
      d += `${follows ? "L" : "M"}${x(sample.t).toFixed(1)} ${y(value).toFixed(1)}`;
    }
    before = value === null ? null : sample.t;
  }
  return d;
}

export class PlotsView {
  constructor() {
    this.samples = [];
    this.plots = CURVES.map((curve) => new Plot(curve, byId("plots")));
  }

  // @param t  s, of this browser's clock
  add(status, t) {
    const angle = anglesOf(status.joint_angle_deg), wanted = anglesOf(status.reference_deg);
    this.samples.push({t, angle, wanted, tip: tipOf(status, angle, true),
      wantedTip: tipOf(status, wanted, false)});
    while (this.samples.length && this.samples[0].t < t - SPAN_S) this.samples.shift();
  }

  draw(now) {
    for (const plot of this.plots) plot.draw(this.samples, now);
  }
}
