// The latched trip and every cause that is present, with what to check and what to do.

import {byId, figure, fillChildren, listOf, make, numberOf, objectOf, setText, textOf} from "./reading.js";

function evidenceOf(cause) {
  const parts = [];
  if (numberOf(cause.value) !== null) {
    const unit = textOf(cause.unit);
    parts.push(`value ${figure(cause.value, 4)}, limit ${figure(cause.limit, 4)}${unit ? ` ${unit}` : ""}`);
  }
  for (const key of ["channel_name", "bus"]) if (textOf(cause[key])) parts.push(cause[key]);
  return parts.join(", ");
}

// @param advice  a row of /api/explain, or undefined
// @param told  whether the same cause is told above
function linesOf(cause, advice, told) {
  const lines = [];
  const evidence = evidenceOf(cause);
  if (evidence) lines.push(["measured", evidence]);
  if (told) {
    lines.push(["what to do", "as above; it is still there"]);
  } else if (advice) {
    lines.push(["what happened", advice.happened], ["check", advice.check], ["what to do", advice.remedy]);
  } else if (textOf(cause.text)) {
    lines.push(["what to do", cause.text]);
  }
  if (textOf(cause.time_utc)) lines.push(["when", cause.time_utc]);
  if (textOf(cause.report)) lines.push(["report", cause.report]);
  return lines;
}

export class TripsView {
  constructor() {
    this.advice = new Map();
  }

  setAdvice(explained) {
    for (const row of listOf(explained.trips)) this.advice.set(row.name, row);
  }

  show(status) {
    const causes = listOf(status.present).map(objectOf).map((cause) => ({cause, kind: "present"}));
    const trip = objectOf(status.trip);
    if (status.trip) causes.unshift({cause: trip, kind: "trip"});
    byId("trips").hidden = !causes.length;
    setText(byId("trips-title"), status.trip ? "Trip" : "Would trip now");
    fillChildren(byId("trip-list"), causes, () => {
      const part = make("article", "cause");
      part.append(make("h3"), make("dl"));
      return part;
    }, (part, {cause, kind}) => {
      const name = textOf(cause.name, "-");
      part.dataset.kind = kind;
      setText(part.children[0], `${kind === "trip" ? "TRIP" : "present"}: ${name}`);
      const told = kind === "present" && name === trip.name;
      fillChildren(part.children[1], linesOf(cause, this.advice.get(name), told), () => {
        const row = make("div");
        row.append(make("dt"), make("dd"));
        return row;
      }, (row, [label, text]) => {
        setText(row.children[0], label);
        setText(row.children[1], text);
      });
    });
  }
}
