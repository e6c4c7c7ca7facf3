// What the operator may do: the token, the commands, the keys.

import {anglesOf} from "./arm.js";
import {byId, make, objectOf, setLook, setText, textOf} from "./reading.js";

const MOST_ANSWERS = 6;
const PRESS_MS = 300;  // of the simulated reset button; the daemon wants 50 ms

// Kept for this tab only, and out of the address bar and its history.
export class Token {
  constructor() {
    const given = new URLSearchParams(location.hash.slice(1)).get("token");
    if (given) {
      this.set(given);
      history.replaceState(null, "", location.pathname);
    }
  }

  get() {
    return sessionStorage.getItem("token") ?? "";
  }

  set(token) {
    sessionStorage.setItem("token", token);
  }

  clear() {
    sessionStorage.removeItem("token");
  }

  headers() {
    return this.get() ? {Authorization: `Bearer ${this.get()}`} : {};
  }
}

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

export class Controls {
  constructor(token) {
    this.token = token;
    this.allowed = false;
    this.needsToken = false;  // to see values, too: others than this computer reach the server
    this.state = "";
    this.status = {};
    byId("token-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.token.set(byId("token").value.trim());
      byId("token").value = "";
      this.showMode();
      this.onToken?.();
    });
    byId("stop").addEventListener("click", () => this.stop());
    this.listen();
    this.listenToKeys();
  }

  listen() {
    const on = (selector, act) => {
      for (const button of document.querySelectorAll(selector)) {
        button.addEventListener("click", () => this.mayGive(button) && act(button.dataset));
      }
    };
    on("[data-command]", ({command}) => this.give({command}));
    on("[data-jog]", ({jog}) => this.jog(...jog.split(",").map(Number)));
    on("[data-sim]", ({sim}) => this.sim(...sim.split(",")));
    const submit = (id, command) => byId(id).addEventListener("submit", (event) => {
      event.preventDefault();
      if (this.mayGive(event.target.querySelector("button"))) this.give(command());
    });
    const number = (id) => Number(byId(id).value);
    submit("run-form", () => ({command: "run", experiment: byId("experiment").value}));
    submit("move-form", () => ({command: "move", to_deg: [number("move-1"), number("move-2")]}));
    submit("home-form", () => ({command: "home", joint: number("home-joint"), side: byId("home-side").value}));
  }

  // Space stops wherever the focus is, but where a space can be typed or chosen.
  listenToKeys() {
    const takesSpace = (element) => element.matches("input:not([type=range]):not([type=checkbox]), select, textarea");
    const isStop = (event) => this.allowed && !event.altKey && !event.ctrlKey && !event.metaKey &&
      (event.key === "Escape" || (event.key === " " && !takesSpace(event.target)));
    addEventListener("keydown", (event) => {
      if (!isStop(event)) return;
      event.preventDefault();
      if (!event.repeat) this.stop();
    }, {capture: true});
    // A button is pressed when Space comes up.
    addEventListener("keyup", (event) => isStop(event) && event.preventDefault(), {capture: true});
  }

  // @param about  of the server
  setAbout(about) {
    this.about = about;
    this.needsToken = false;
    const select = byId("experiment"), names = about.experiments ?? [];
    if (select.children.length !== names.length) {
      select.replaceChildren(...names.map((name) => make("option", "", name)));
    }
    this.showMode();
  }

  askForToken() {
    this.token.clear();
    this.needsToken = true;
    this.showMode();
  }

  showMode() {
    const control = this.needsToken || this.about?.control === true;
    this.allowed = control && this.token.get() !== "";
    byId("controls").hidden = !control;
    byId("token-form").hidden = this.allowed;
    byId("commands").hidden = !this.allowed;
    byId("stop").hidden = !this.allowed;
    setText(byId("control-mode"), this.allowed ? "control"
      : control ? "read only without the token" : "read only; stop with `flexarm stop`");
    this.enable();
  }

  show(status) {
    if (textOf(status.state) !== this.state) setText(byId("stop-answer"), "");
    this.status = status;
    this.state = textOf(status.state);
    byId("sim").hidden = status.backend !== "sim";
    this.enable();
  }

  // Whether the daemon would take the command of a button in the state that is shown.
  mayGive(button) {
    if (button.getAttribute("aria-disabled") !== "true") return true;
    this.answer(button.textContent, `not sent: ${button.title}`, "bad");
    return false;
  }

  // A button that the daemon would refuse now says so; it keeps the focus.
  enable() {
    for (const button of document.querySelectorAll("[data-states]")) {
      const fits = button.dataset.states.split(" ").includes(this.state);
      button.setAttribute("aria-disabled", String(!fits));
      button.title = fits ? "" : `only in state ${button.dataset.states}`;
    }
  }

  setGone() {
    this.state = "";
    this.enable();
  }

  stop() {
    return this.give({command: "stop"});
  }

  jog(joint, direction) {
    const angles = anglesOf(this.status.joint_angle_deg);
    if (angles.includes(null)) return this.answer("jog", "not sent: an angle is not known", "bad");
    angles[joint] += direction * Number(byId("jog-step").value);
    return this.give({command: "move", to_deg: angles.map((angle) => Math.round(angle * 100) / 100)});
  }

  async sim(line, level) {
    if (line !== "reset-button") return this.give({command: "sim", line, level: Number(level)});
    await this.give({command: "sim", line, level: 1});
    await pause(PRESS_MS);
    return this.give({command: "sim", line, level: 0});
  }

  async give(command) {
    const name = command.command;
    if (byId("take-over").checked && name !== "stop" && name !== "sim") command.take_over = true;
    const began = performance.now();
    try {
      const response = await fetch("/api/command", {
        method: "POST",
        headers: {"Content-Type": "application/json", ...this.token.headers()},
        body: JSON.stringify(command),
        cache: "no-store",
      });
      const answer = objectOf(await response.json().catch(() => ({})));
      if (response.status === 401) {
        this.token.clear();
        this.showMode();
      }
      const remedy = textOf(answer.remedy);
      const ms = Math.round(performance.now() - began);
      this.answer(name, answer.ok === true ? `ok, after ${ms} ms`
        : `${textOf(answer.error, `refused (${response.status})`)}${remedy ? `; ${remedy}` : ""}`,
      answer.ok === true ? "good" : "bad");
      return answer;
    } catch {
      this.answer(name, "NOT SENT: the dashboard does not answer", "bad");
      return {};
    }
  }

  answer(name, text, look) {
    const time = new Date().toTimeString().slice(0, 8);
    const line = make("li", "", `${time} ${name}: ${text}`);
    line.dataset.look = look;
    if (name === "stop") {  // also where the answers are out of view
      setText(byId("stop-answer"), `stop: ${text}`);
      setLook(byId("stop-answer"), look);
    }
    byId("answers").prepend(line);
    while (byId("answers").children.length > MOST_ANSWERS) byId("answers").lastElementChild.remove();
  }
}
