// The stream of events of the server: reads it, and opens it again when it ends.

const SILENT_MS = 4000;  // the server sends something each second, whatever the daemon does
const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 5000;

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

// Calls `onEvent(name, data)` for each event of a text in pieces.
class EventParser {
  constructor(onEvent) {
    this.onEvent = onEvent;
    this.text = "";
  }

  add(piece) {
    this.text += piece;
    let end;
    while ((end = this.text.indexOf("\n\n")) >= 0) {
      this.take(this.text.slice(0, end));
      this.text = this.text.slice(end + 2);
    }
  }

  take(block) {
    let name = "message", data = "";
    for (const line of block.split("\n")) {
      if (line.startsWith("event: ")) name = line.slice(7);
      if (line.startsWith("data: ")) data += line.slice(6);
    }
    if (data) this.onEvent(name, JSON.parse(data));
  }
}

// Reads one stream until it ends. @returns why
async function follow(headers, onEvent) {
  const control = new AbortController();
  let timer = setTimeout(() => control.abort(), SILENT_MS);
  const alive = () => {
    clearTimeout(timer);
    timer = setTimeout(() => control.abort(), SILENT_MS);
  };
  try {
    const response = await fetch("/api/stream", {headers, cache: "no-store", signal: control.signal});
    if (!response.ok) {
      const refusal = await response.json().catch(() => ({}));
      return refusal.error || `the server answers ${response.status}`;
    }
    const parser = new EventParser(onEvent);
    const decoder = new TextDecoder();
    const reader = response.body.getReader();
    for (;;) {
      const {done, value} = await reader.read();
      if (done) return "the server has ended the stream";
      alive();
      parser.add(decoder.decode(value, {stream: true}));
    }
  } catch (error) {
    return control.signal.aborted ? "the server is silent" : "the server does not answer";
  } finally {
    clearTimeout(timer);
    control.abort();
  }
}

// Follows the server for ever. `onEvent(name, data)`; `onLost(why)` when a stream ends.
export async function followServer(headersNow, onEvent, onLost) {
  let wait = FIRST_WAIT_MS;
  for (;;) {
    let came = false;
    const why = await follow(headersNow(), (name, data) => {
      came = true;
      onEvent(name, data);
    });
    onLost(why);
    wait = came ? FIRST_WAIT_MS : Math.min(2 * wait, LONGEST_WAIT_MS);
    await pause(wait);
  }
}
