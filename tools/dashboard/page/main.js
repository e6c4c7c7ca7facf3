// The page of `flexarm dashboard`: follows the daemon and shows its status.

import {ArmView} from "./arm.js";
import {Controls, Token} from "./controls.js";
import {JointsView, showBuses, showLamps, showRun, showThreads, StrainView} from "./panels.js";
import {PlotsView} from "./plots.js";
import {ageText, byId, numberOf, objectOf, setLook, setText, textOf} from "./reading.js";
import {followServer} from "./stream.js";
import {TripsView} from "./trips.js";

const STALE_S = 1;  // more than two looks of the server at the daemon, whatever its period
const CLOCK_MS = 250;
const CALM_MS = 1000;  // between two drawings for users who want little motion

// A shape for each kind of state, so that no colour is needed to tell them apart.
const SHAPES = {
  ring: "M12 3a9 9 0 1 0 0 18a9 9 0 1 0 0-18zm0 4a5 5 0 1 1 0 10a5 5 0 1 1 0-10z",
  bars: "M5 4h5v16H5zM14 4h5v16h-5z",
  play: "M5 3l16 9l-16 9z",
  square: "M4 4h16v16H4z",
  cross: "M5 2l7 7l7-7l3 3l-7 7l7 7l-3 3l-7-7l-7 7l-3-3l7-7l-7-7z",
  question: "M12 2l10 10l-10 10l-10-10zM10.800 7h2.400v6h-2.400zM10.800 15h2.400v2.400h-2.400z",
};
const STATES = {
  Idle: {look: "none", shape: "ring", what: "relay open, no torque"},
  Starting: {look: "none", shape: "ring", what: "the daemon starts"},
  Armed: {look: "caution", shape: "bars", what: "relay closed, no torque: it may move at any time"},
  Running: {look: "active", shape: "play", what: "the arm moves"},
  Stopping: {look: "caution", shape: "square", what: "the controller damps the arm"},
  Disarming: {look: "caution", shape: "square", what: "the relay is about to open"},
  Tripped: {look: "bad", shape: "cross", what: "a trip is latched: relay open, no torque"},
  FaultStopping: {look: "bad", shape: "cross", what: "a trip: the controller damps the arm first"},
};

const calm = matchMedia("(prefers-reduced-motion: reduce)");
const token = new Token();
const controls = new Controls(token);
const arm = new ArmView();
const joints = new JointsView();
const strain = new StrainView();
const trips = new TripsView();
const plots = new PlotsView();

const link = {cameAt: null, why: "", leastLag: Infinity, time: null};
let newest = null, drawn = null, drawnAt = -Infinity;

const now_s = () => performance.now() / 1000;

function showState(name, what, look, shape) {
  setText(byId("state-name"), name);
  setText(byId("state-what"), what);
  setLook(byId("state"), look);
  const path = byId("state-shape").firstElementChild;
  if (path.getAttribute("d") !== SHAPES[shape]) path.setAttribute("d", SHAPES[shape]);
}

// How far behind the daemon's clock the values are, beyond the least that was seen: what a slow
// browser or network holds back. Another daemon has another clock.
function lagOf(status) {
  const time = numberOf(status.time_s);
  if (time === null) return 0;
  if (link.time !== null && time < link.time) link.leastLag = Infinity;
  link.time = time;
  const lag = now_s() - time;
  link.leastLag = Math.min(link.leastLag, lag);
  return lag - link.leastLag;
}

function showFreshness() {
  const age = link.cameAt === null ? null : now_s() - link.cameAt + link.lag;
  const stale = age === null || age > STALE_S || link.why !== "";
  document.body.classList.toggle("stale", stale);
  byId("alarm").hidden = !stale;
  if (!stale) {
    setText(byId("freshness"), "live");
    setLook(byId("freshness"), "good");
    return;
  }
  setText(byId("freshness"), age === null ? "no values yet" : `OLD: ${ageText(age)}`);
  setLook(byId("freshness"), "bad");
  const why = link.why || "values come late";
  setText(byId("alarm"), `NO LIVE VALUES: ${why}. ` + (age === null ? "" : "What is shown is old. ") +
    "The page goes on by itself when they are back.");
  if (age !== null) {
    setText(byId("state-what"), "as it was; it may be another now");
    setLook(byId("state"), "bad");
    controls.setGone();
  }
}

function draw() {
  if (newest === null || newest === drawn) return;
  if (calm.matches && performance.now() - drawnAt < CALM_MS) return;
  drawn = newest;
  drawnAt = performance.now();
  arm.show(newest);
  joints.show(newest);
  strain.show(newest);
  plots.draw(now_s());
  showRun(newest);
  showThreads(newest);
  showBuses(newest);
}

function takeStatus(status) {
  newest = status;
  link.why = "";
  link.cameAt = now_s();
  link.lag = lagOf(status);
  const name = textOf(status.state, "unknown");
  const known = STATES[name] ??
    {look: "caution", shape: "question", what: name.startsWith("Testing") ? "the power path is tested" : ""};
  const run = objectOf(status.run);
  const runs = name === "Running" && run.outcome === "running";
  const about = runs ? `${textOf(run.name)}: ` : status.trip ? `${textOf(objectOf(status.trip).name)}: ` : "";
  showState(name, about + known.what, known.look, known.shape);
  setText(byId("rig"), `${textOf(status.rig, "flexarm")}, ${textOf(status.backend, "-")}`);
  document.title = `${name} \u2013 ${textOf(status.rig, "flexarm")}`;
  trips.show(status);
  showLamps(status);
  controls.show(status);
  plots.add(status, now_s());
  showFreshness();
  requestAnimationFrame(draw);
}

function takeEvent(name, data) {
  if (name === "status") return takeStatus(objectOf(data));
  if (name === "gone") {
    link.why = textOf(objectOf(data).error, "the daemon does not answer");
    showFreshness();
  }
}

async function ask(path) {
  const response = await fetch(path, {headers: token.headers(), cache: "no-store"});
  if (response.status === 401) controls.askForToken();
  if (!response.ok) throw new Error(`${path}: ${response.status}`);
  return response.json();
}

// What does not change while the server runs; asked again when the stream was lost.
async function learn() {
  try {
    controls.setAbout(await ask("/api/about"));
    trips.setAdvice(await ask("/api/explain"));
  } catch {
    controls.showMode();
  }
}

controls.onToken = learn;
showState("connecting", "", "none", "question");
setInterval(showFreshness, CLOCK_MS);
learn();
followServer(() => token.headers(), takeEvent, (why) => {
  link.why = why;
  showFreshness();
  learn();
});
