"use strict";
// What the timelines have in common. `data` has, for each, verdicts, episodes, deadlines and panels; times are ns since
// the beginning of the recording.

const data = JSON.parse(document.getElementById("data").textContent);
const VERDICTS = ["not_started", "presumably_satisfied", "presumably_violated", "satisfied", "violated"];
const NAMES = ["page", "surface", "text", "quiet", "line", "link", "signal", "bound", "limit", "episode",
  "episode-area", "owed", "owed-area", ...VERDICTS, ...VERDICTS.map((verdict) => `${verdict}-text`)];
const FONT = "12px system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', 'DejaVu Sans', sans-serif";
const HEIGHTS = { number: 116, boolean: 40, string: 40, news: 26, age: 80 };
const BAND = 24, BAR = 16, HEAD = 19, GAP = 9, AXIS = 26, EDGE = 6;
const SHORTEST = 20; // ns that a view shows at least

let colours = {};

function readColours() {
  const probe = document.body.appendChild(document.createElement("i"));
  colours = Object.fromEntries(NAMES.map((name) => {
    probe.style.color = `var(--${name})`;
    return [name, getComputedStyle(probe).color];
  }));
  probe.remove();
}

// --- numbers ---------------------------------------------------------------------------------------------------------

const ARRAYS = { f4: Float32Array, f8: Float64Array, u4: Uint32Array };
const inflated = new Map();

function numbers({ blob, type }) {
  const key = `${blob} ${type}`;
  if (!inflated.has(key)) {
    const bytes = Uint8Array.from(atob(data.blobs[blob]), (character) => character.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    inflated.set(key, new Response(stream).arrayBuffer().then((buffer) => new ARRAYS[type](buffer)));
  }
  return inflated.get(key);
}

async function readLine(line) {
  const [gaps, values] = await Promise.all([numbers(line.gaps), numbers(line.values)]);
  line.times = new Float64Array(gaps.length);
  let time = 0;
  for (let i = 0; i < gaps.length; i++) line.times[i] = time += gaps[i];
  line.samples = values;
  return line;
}

// That of the first message counts from the beginning.
async function readAge(line) {
  const { times, samples } = await readLine(line);
  if (times.length && Number.isNaN(samples[0])) samples[0] = times[0] / 1e9;
}

// How old the last message is, in s; `line` has those of a topic.
function age(line, time) {
  const at = upTo(line.times, time) - 1;
  return (time - (at < 0 ? 0 : line.times[at])) / 1e9;
}

// How many of the ascending `times` are at most `time`.
function upTo(times, time) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1; else high = middle;
  }
  return low;
}

function held(line, time) {
  const at = upTo(line.times, time) - 1;
  return at < 0 ? undefined : line.samples[at];
}

function short(value) {
  if (Number.isNaN(value)) return "not a number";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  return String(Number(value.toPrecision(7))).replace("-", "−");
}

function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least * 0.9999);
}

function decimals(step) {
  return Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
}

// --- views: what part of the time is shown, by all timelines of a recording together --------------------------------

class View {
  constructor(end) {
    this.end = Math.max(end, SHORTEST);
    this.timelines = [];
    this.reset();
  }
  reset() {
    this.show(-0.01 * this.end, 1.01 * this.end);
  }
  show(from, to) {
    const span = Math.min(Math.max(to - from, SHORTEST), 1.02 * this.end);
    this.from = Math.min(Math.max((from + to - span) / 2, -0.01 * this.end), 1.01 * this.end - span);
    this.to = this.from + span;
    for (const timeline of this.timelines) timeline.redraw();
  }
  get isWhole() {
    return this.to - this.from > 1.0199 * this.end;
  }
  zoom(factor, around = (this.from + this.to) / 2) {
    this.show(around - (around - this.from) * factor, around + (this.to - around) * factor);
  }
  move(share) {
    const by = share * (this.to - this.from);
    const least = -0.01 * this.end - this.from, most = 1.01 * this.end - this.to;
    const within = Math.min(Math.max(by, least), most);
    this.show(this.from + within, this.to + within);
  }
}
