// The arm from above: zero upwards, counter-clockwise positive. Lengths in metres.

import {byId, listOf, makeSvg, numberAt, numberOf, setText, signed} from "./reading.js";

const POINTS = 24;  // of a link
const BEHIND = 0.55;  // how far behind the base it reaches, as a share of its length

// Deflection of a link at the share `s` of its length, m: each mode is the cubic that is clamped at
// the root and has the mode's deflection, 1, and slope at the end.
function deflection(link, s) {
  let w = 0;
  for (const mode of link.modes) {
    w += mode.m * (s * s * (3 - 2 * s) + mode.slope * link.length * (s * s * s - s * s));
  }
  return w;
}

function slopeAtEnd(link) {
  return link.modes.reduce((sum, mode) => sum + mode.m * mode.slope, 0);
}

// A point that lies `along` a direction from another, and `left` of it.
function ahead(from, angle, along, left) {
  const s = Math.sin(angle), c = Math.cos(angle);
  return {x: from.x - s * along - c * left, y: from.y + c * along - s * left};
}

function linkPoints(root, angle, link, scale) {
  const points = [];
  for (let i = 0; i <= POINTS; ++i) {
    const s = i / POINTS;
    points.push(ahead(root, angle, s * link.length, scale * deflection(link, s)));
  }
  return points;
}

const radians = (degrees) => degrees * Math.PI / 180;

// The lengths and the bending of a status; null: it does not say.
export function linksOf(status) {
  const links = [];
  for (let k = 0; k < 2; ++k) {
    const length = numberAt(status.link_length_m, k);
    if (length === null || length <= 0) return null;
    const slopes = listOf(listOf(status.link_tip_slope_per_m)[k]);
    const modes = [0, 1].map((j) => ({
      m: numberAt(status.modal_m, 2 * k + j) ?? 0,
      // Without the key: a cantilever with a force at its end.
      slope: numberOf(slopes[j]) ?? 1.5 / length,
    }));
    links.push({length, modes});
  }
  return links;
}

// Points of both links. @param angles  of the joints, degrees
export function shapeOf(links, angles, scale) {
  const first = linkPoints({x: 0, y: 0}, radians(angles[0]), links[0], scale);
  const elbow = first[first.length - 1];
  const turned = radians(angles[0]) + Math.atan(scale * slopeAtEnd(links[0])) + radians(angles[1]);
  const second = linkPoints(elbow, turned, links[1], scale);
  return {first, second, elbow, tip: second[second.length - 1]};
}

// Place of the tip from the base, x along zero and y to its left, m.
export function tipOf(status, angles, bent) {
  const links = linksOf(status);
  if (links === null || angles.some((angle) => angle === null)) return null;
  const tip = shapeOf(links, angles, bent ? 1 : 0).tip;
  return {x: tip.y, y: -tip.x};
}

export function anglesOf(list) {
  return [numberAt(list, 0), numberAt(list, 1)];
}

const pathOf = (points) =>
  points.map((p, i) => `${i ? "L" : "M"}${p.x.toFixed(4)} ${(-p.y).toFixed(4)}`).join("");

export class ArmView {
  constructor() {
    this.svg = byId("arm");
    this.slider = byId("exaggeration");
    this.reach = 0;
    this.slider.addEventListener("input", () => this.redraw());
  }

  build(links) {
    const reach = links[0].length + links[1].length;
    if (reach === this.reach) return;
    this.reach = reach;
    const margin = 0.06 * reach, unit = reach / 100;
    this.svg.setAttribute("viewBox", [-reach - margin, -reach - margin, 2 * (reach + margin),
      (1 + BEHIND) * reach + 2 * margin].join(" "));
    const add = (tag, name, attributes = {}) => {
      const element = makeSvg(tag, {...attributes, class: name});
      this.svg.append(element);
      return element;
    };
    this.svg.replaceChildren();
    for (let r = 0.5; r <= reach; r += 0.5) {
      add("circle", "arm-grid", {r, "stroke-width": 0.4 * unit});
      add("text", "arm-scale", {x: unit, y: -r + 4 * unit, "font-size": 4.5 * unit}).textContent =
        `${r} m`;
    }
    add("path", "arm-zero", {d: `M0 0V${-reach}`, "stroke-width": 0.4 * unit});
    this.ghost = add("path", "arm-reference", {
      "stroke-width": 1.6 * unit, "stroke-dasharray": `${3 * unit} ${2.4 * unit}`});
    this.ghostTip = add("rect", "arm-reference-tip", {
      width: 4 * unit, height: 4 * unit, "stroke-width": unit});
    this.link1 = add("path", "arm-link", {"stroke-width": 2.8 * unit});
    this.link2 = add("path", "arm-link", {"stroke-width": 2 * unit});
    this.base = add("circle", "arm-base", {r: 3.4 * unit});
    this.elbow = add("circle", "arm-joint", {r: 2.4 * unit, "stroke-width": unit});
    this.tip = add("path", "arm-tip", {"stroke-width": 1.4 * unit});
    this.unit = unit;
  }

  show(status) {
    this.status = status;
    this.redraw();
  }

  redraw() {
    const scale = Number(this.slider.value);
    setText(byId("exaggeration-text"), scale === 1 ? "as it is" : `${scale} times`);
    const links = this.status && linksOf(this.status);
    if (!links) return;
    this.build(links);
    const angles = anglesOf(this.status.joint_angle_deg);
    const known = !angles.includes(null);
    this.svg.classList.toggle("unknown", !known);
    const shape = shapeOf(links, angles.map((angle) => angle ?? 0), scale);
    this.link1.setAttribute("d", pathOf(shape.first));
    this.link2.setAttribute("d", pathOf(shape.second));
    const place = (circle, at) => {
      circle.setAttribute("cx", at.x.toFixed(4));
      circle.setAttribute("cy", (-at.y).toFixed(4));
    };
    place(this.base, {x: 0, y: 0});
    place(this.elbow, shape.elbow);
    const {x, y} = shape.tip, u = 2.4 * this.unit;
    this.tip.setAttribute("d", `M${x - u} ${-y - u}l${2 * u} ${2 * u}m0 ${-2 * u}l${-2 * u} ${2 * u}`);
    this.showReference(links);
    this.showText(links, angles, known);
  }

  showReference(links) {
    const angles = anglesOf(this.status.reference_deg);
    const shown = !angles.includes(null);
    this.ghost.style.display = this.ghostTip.style.display = shown ? "" : "none";
    if (!shown) return;
    const shape = shapeOf(links, angles, 0);
    this.ghost.setAttribute("d", pathOf([{x: 0, y: 0}, shape.elbow, shape.tip]));
    this.ghostTip.setAttribute("x", shape.tip.x - 2 * this.unit);
    this.ghostTip.setAttribute("y", -shape.tip.y - 2 * this.unit);
  }

  showText(links, angles, known) {
    const bent = links.map((link) => link.modes.reduce((sum, mode) => sum + mode.m, 0) * 1000);
    const bending = `ends bent by ${signed(bent[0], 1)} and ${signed(bent[1], 1)} mm`;
    const tip = tipOf(this.status, angles, true);
    setText(byId("arm-text"), known
      ? `Joint 1 ${signed(angles[0], 1)}\u00b0, joint 2 ${signed(angles[1], 1)}\u00b0; ${bending}; ` +
        `tip at x ${signed(tip.x, 3)}, y ${signed(tip.y, 3)} m.`
      : `An angle is not known (drawn as zero); ${bending}.`);
  }
}
