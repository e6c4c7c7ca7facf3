// Tables, bars and lamps of a status. Nothing is said by colour alone: each look has a word or a
// sign beside it.

import {ageText, byId, figure, fillChildren, listOf, make, numberAt, numberOf, objectOf, setLook,
  setText, signed, textOf} from "./reading.js";

const CAUTION_SHARE = 0.8;
const STALE_MS = 100;  // as long as the daemon's watchdog bears

function lookOf(share) {
  if (share === null) return "none";
  if (Math.abs(share) > 1) return "bad";
  return Math.abs(share) >= CAUTION_SHARE ? "caution" : "good";
}

// A bar between -limit and +limit with zero in the middle.
class Bar {
  constructor() {
    this.element = make("span", "bar");
    this.fill = make("span", "bar-fill");
    this.element.append(this.fill, make("span", "bar-zero"));
    this.element.setAttribute("aria-hidden", "true");
  }

  show(value, limit) {
    const share = value === null || !(limit > 0) ? null : value / limit;
    const width = 50 * Math.min(Math.abs(share ?? 0), 1);
    this.fill.style.width = `${width}%`;
    this.fill.style.left = `${share < 0 ? 50 - width : 50}%`;
    setLook(this.element, lookOf(share));
    return share;
  }
}

// A row with a name, a bar and a figure.
class BarRow {
  constructor(parent, className = "bar-row") {
    this.element = make("div", className);
    this.name = make("span", "bar-name");
    this.bar = new Bar();
    this.figure = make("span", "bar-figure");
    this.element.append(this.name, this.bar.element, this.figure);
    parent.append(this.element);
  }

  show(name, value, limit, text, note = "") {
    const share = this.bar.show(value, limit);
    const look = lookOf(share);
    const sign = {bad: " over", caution: " high"}[look] ?? "";
    setText(this.name, name);
    setText(this.figure, text + sign + (note ? ` ${note}` : ""));
    setLook(this.element, note ? "bad" : look);
  }
}

export class JointsView {
  constructor() {
    this.rows = [];
    for (const joint of [1, 2]) {
      const part = make("div", "joint");
      part.append(make("h3", "", `Joint ${joint}`));
      this.rows.push(["angle", "rate", "torque"].map(() => new BarRow(part)));
      this.rows[joint - 1].note = part.appendChild(make("p", "small"));
      byId("joints").append(part);
    }
  }

  show(status) {
    const limits = objectOf(status.limits);
    this.rows.forEach((rows, k) => {
      const angle = numberAt(status.joint_angle_deg, k), rate = numberAt(status.hub_rate_rad_s, k);
      const torque = numberAt(status.torque_nm, k), wanted = numberAt(status.reference_deg, k);
      const of = (key, decimals) => `of ${figure(numberAt(limits[key], k), decimals)}`;
      rows[0].show("angle", angle, numberAt(limits.angle_deg, k),
        `${signed(angle, 2)} ${of("angle_deg", 0)} deg`);
      rows[1].show("rate", rate, numberAt(limits.hub_rate_rad_s, k),
        `${signed(rate, 2)} ${of("hub_rate_rad_s", 0)} rad/s`);
      rows[2].show("torque", torque, numberAt(limits.torque_nm, k),
        `${signed(torque, 2)} ${of("torque_nm", 0)} N m`);
      const unknown = textOf(listOf(status.joint_angle_unknown)[k]);
      setText(rows.note, unknown || (wanted === null ? "no reference: no torque is allowed"
                                                     : `reference ${signed(wanted, 2)} deg`));
    });
  }
}

export class StrainView {
  constructor() {
    this.links = [1, 2].map((link) => {
      const part = make("div", "link");
      part.append(make("h3", "", `Link ${link}`));
      const root = new BarRow(part, "bar-row root");
      const gauges = part.appendChild(make("div"));
      byId("strain").append(part);
      return {root, gauges, rows: []};
    });
  }

  show(status) {
    const limits = objectOf(status.limits);
    this.links.forEach((view, k) => {
      const strain = numberAt(status.root_strain, k), limit = numberAt(limits.root_strain, k);
      view.root.show("root", strain, limit,
        `${signed(strain === null ? null : strain * 1e6, 0)} of ${figure(limit === null ? null : limit * 1e6, 0)}`);
      const gauges = listOf(status.gauges).map(objectOf).filter((gauge) => gauge.link === k + 1);
      while (view.rows.length < gauges.length) view.rows.push(new BarRow(view.gauges));
      while (view.rows.length > gauges.length) view.rows.pop().element.remove();
      gauges.forEach((gauge, i) => {
        const value = numberOf(gauge.strain), age = numberOf(gauge.age_ms);
        const old = age !== null && age > STALE_MS ? `${ageText(age / 1e3)} old` : "";
        view.rows[i].show(textOf(gauge.name, "-").replace(/^strain_\d_/, ""),
          numberOf(gauge.counts), numberOf(gauge.counts_limit),
          signed(value === null ? null : value * 1e6, 0), gauge.used === false ? "not used" : old);
      });
    });
  }
}

function fillList(list, rows) {
  fillChildren(list, rows, () => {
    const row = make("div");
    row.append(make("dt"), make("dd"));
    return row;
  }, (row, [name, text]) => {
    setText(row.children[0], name);
    setText(row.children[1], text);
  });
}

export function showRun(status) {
  const run = objectOf(status.run), payload = objectOf(status.payload);
  const rows = [["law", textOf(status.law, "-")], ["torque by", textOf(status.torque_source, "none")]];
  const timed = numberOf(run.duration_s) === null ? "" : ` of ${figure(run.duration_s, 1)}`;
  rows.push(["run", run.name === undefined ? "none yet"
    : `${textOf(run.name, "-")}: ${textOf(run.outcome, "-")}, ${figure(run.elapsed_s, 1)}${timed} s`]);
  if (numberOf(payload.kg) !== null) {
    const warnings = listOf(payload.warnings).map((warning) => textOf(warning)).join(", ");
    rows.push(["payload", `${figure(payload.kg, 3)} kg, sigma ${figure(payload.sigma_kg, 3)} kg` +
      (warnings ? `; ${warnings}` : "")]);
  } else {
    rows.push(["payload", "this law does not estimate it"]);
  }
  rows.push(["delay", `${figure(status.delay_ms, 1)} ms, longest ${figure(status.delay_max_ms, 1)} ms`]);
  const lease = objectOf(status.lease);
  rows.push(["commanded by", textOf(lease.name, "no user")]);
  fillList(byId("run"), rows);
}

export function showLamps(status) {
  const inputs = objectOf(status.inputs);
  const lamps = [{name: "relay", text: status.relay_closed ? "CLOSED" : "open",
    look: status.relay_closed ? "caution" : "good"}];
  for (const [name, level] of Object.entries(inputs)) {
    if (name === "reset-button") {
      lamps.push({name, text: level ? "PRESSED" : "up", look: level ? "caution" : "good"});
    } else {
      lamps.push({name, text: level ? "ok" : "OPEN", look: level ? "good" : "bad"});
    }
  }
  fillChildren(byId("lamps"), lamps, () => {
    const lamp = make("li");
    lamp.append(make("span", "lamp-name"), make("b"));
    return lamp;
  }, (lamp, {name, text, look}) => {
    setText(lamp.children[0], name);
    setText(lamp.children[1], text);
    setLook(lamp, look);
  });
}

function fillTable(table, caption, heads, rows) {
  if (!table.tHead) {
    table.createCaption().className = "sr";
    setText(table.caption, caption);
    const row = table.createTHead().insertRow();
    for (const head of heads) row.append(Object.assign(make("th", "", head), {scope: "col"}));
    table.createTBody();
  }
  fillChildren(table.tBodies[0], rows, () => {
    const row = make("tr");
    row.append(Object.assign(make("th"), {scope: "row"}));
    for (let i = 1; i < heads.length; ++i) row.append(make("td"));
    return row;
  }, (row, {cells, look}) => {
    cells.forEach((cell, i) => setText(row.children[i], cell));
    setLook(row, look);
  });
}

export function showThreads(status) {
  fillTable(byId("threads"), "Threads of the daemon", ["thread", "latest start", "missed", "skipped"],
    listOf(status.threads).map(objectOf).map((thread) => {
      const late = (numberOf(thread.missed_deadlines) ?? 0) + (numberOf(thread.skipped_periods) ?? 0);
      return {look: late ? "caution" : "good",
        cells: [textOf(thread.name, "-"), ageText((numberOf(thread.worst_lateness_us) ?? 0) / 1e6),
          figure(thread.missed_deadlines, 0), figure(thread.skipped_periods, 0)]};
    }));
}

export function showBuses(status) {
  const buses = listOf(status.buses).map(objectOf);
  byId("buses").hidden = !buses.length;
  byId("no-buses").hidden = buses.length > 0;
  fillTable(byId("buses"), "Buses", ["bus", "health", "failed", "slow", "longest"],
    buses.map((bus) => ({look: bus.ok ? "good" : "bad",
      cells: [textOf(bus.name, "-"), bus.ok ? "ok" : `LOST ${textOf(bus.fault)}`,
        figure(bus.failed, 0), figure(bus.slow, 0),
        `${figure(bus.longest_ms, 1)} of ${figure(bus.declared_ms, 1)} ms`]})));
}
