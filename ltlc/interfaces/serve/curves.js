// The run as curves to be drawn by hand: one for each signal, over the verdicts of the properties.

import { draw, make, sign, words } from "./dom.js";
import { tidy } from "./run.js";

const WIDTH = 640, EDGE = 8, TALL = 110, LOW = 44, BAND = 22, MOST_DOTS = 80;

export class Curves {
  constructor(element, run, { edited, chose }) {
    Object.assign(this, { element, run, edited, chose, at: null, curves: [] });
    this.axis = make("div", { class: "axis", "aria-hidden": "true" });
  }

  // Draw all of it anew; `labels` are those of the properties.
  draw(labels) {
    this.curves = this.run.drawable.map((signal) => new Curve(signal, this));
    this.bands = labels.map((label) => ({ label, picture: draw("svg", {
      viewBox: `0 0 ${WIDTH} ${BAND}`, preserveAspectRatio: "none", class: "band", role: "img",
    }), words: make("div", { class: "band-words", "aria-hidden": "true" }) }));
    this.element.replaceChildren(...this.curves.map((curve) => curve.element),
      ...this.bands.map(({ label, picture, words: told }) => make("div", { class: "lane" },
        make("div", { class: "lane-title" }, label), make("div", { class: "strip" }, picture, told))), this.axis);
    this.refresh();
  }

  refresh() {
    const times = this.run.times.filter(Number.isFinite);
    this.from = times.length ? Math.min(...times) : 0;
    this.to = Math.max(...times, this.from);
    if (!(this.to > this.from)) this.to = this.from + 1;
    this.axis.replaceChildren(...[this.from, this.to].map((time) => make("span", {}, `${tidy(time)} s`)));
    for (const curve of this.curves) curve.refresh();
  }

  x(time) {
    return EDGE + (time - this.from) / (this.to - this.from) * (WIDTH - 2 * EDGE);
  }
  // The number of the row that is nearest to `x`.
  row(x) {
    const away = this.run.times.map((time) => Math.abs(this.x(time) - x));
    return away.indexOf(Math.min(...away));
  }

  choose(at) {
    this.at = at;
    for (const curve of this.curves) curve.choose();
  }

  changed(at, curve) {
    this.edited(curve);
    this.chose(at);
  }

  // Show the changes of verdict of each property; null while they are not known.
  tell(properties) {
    this.bands.forEach(({ label, picture, words: told }, n) => {
      const changes = properties?.[n]?.changes ?? [];
      const stretches = changes.map(({ time_ns, verdict }, k) => ({
        verdict,
        from: Math.max(0, this.x(time_ns / 1e9)),
        to: k + 1 < changes.length ? Math.min(WIDTH, this.x(changes[k + 1].time_ns / 1e9)) : WIDTH,
      }));
      picture.setAttribute("aria-label", `${label}: ${changes.map((c) => `${words(c.verdict)} from ${c.text}`).join(", ")}`);
      picture.replaceChildren(...stretches.map(({ verdict, from, to }) => draw("rect", {
        class: `stretch ${verdict}`, x: from, y: 0, width: Math.max(to - from, 1.5), height: BAND,
      })));
      told.replaceChildren(...stretches.map(({ verdict, from, to }) => {
        const room = to - from;
        const text = room > 24 ? `${sign(verdict)} ${words(verdict)}` : "";
        const word = make("span", { class: verdict }, text);
        word.style.left = `${100 * from / WIDTH}%`;
        word.style.width = `${100 * Math.max(0, room) / WIDTH}%`;
        return word;
      }));
    });
  }
}

// The curve of one signal: its value is held from one step to the next.
class Curve {
  constructor(signal, curves) {
    Object.assign(this, { signal, curves, run: curves.run });
    this.isNumber = signal.type === "number";
    this.height = this.isNumber ? TALL : LOW;
    this.picture = draw("svg", {
      viewBox: `0 0 ${WIDTH} ${this.height}`, preserveAspectRatio: "none", class: this.isNumber ? "curve" : "curve low", tabindex: 0, role: "slider",
      "aria-label": `${signal.name}: draw, or use the arrow keys`, "aria-orientation": "vertical",
    });
    this.scale = make("div", { class: "scale", "aria-hidden": "true" });
    this.element = make("div", { class: "lane" }, make("div", { class: "lane-title" }, signal.name,
      ...signal.limits.map((limit) => make("span", { class: "limit-text" }, ` — ${limit.text}`))),
    make("div", { class: "strip" }, this.picture, this.scale));
    this.listen();
  }

  value(cell) {
    const text = cell.trim().toLowerCase();
    if (!this.isNumber) return { true: 1, 1: 1, false: 0, 0: 0 }[text] ?? NaN;
    return text === "" ? NaN : Number(text);
  }
  get values() {
    return this.run.cells(this.signal.name).map((cell) => this.value(cell));
  }

  // The values that the height stands for; while somebody draws, it stays as it is.
  setRange() {
    if (this.last) return;
    const known = [...this.values, ...this.signal.limits.map((limit) => limit.value)].filter(Number.isFinite);
    const low = Math.min(...known, this.isNumber ? 0 : -0.2), high = Math.max(...known, this.isNumber ? 1 : 1.2);
    const room = this.isNumber ? 0.2 * (high - low) : 0;
    this.low = low - (low < 0 ? room : 0.1 * (high - low) * this.isNumber);
    this.high = high + room;
  }
  y(value) {
    return (this.high - value) / (this.high - this.low) * this.height;
  }

  refresh() {
    this.setRange();
    const { values, curves } = this, times = this.run.times;
    let path = "", isDown = false;
    values.forEach((value, n) => {
      if (!Number.isFinite(times[n])) return;
      const x = curves.x(times[n]).toFixed(2);
      if (isDown) path += `H${x}`;
      if (!Number.isFinite(value)) return;
      path += isDown ? `V${this.y(value).toFixed(2)}` : `M${x},${this.y(value).toFixed(2)}`;
      isDown = true;
    });
    if (isDown) path += `H${WIDTH}`;
    const limits = this.signal.limits.filter(({ value }) => Number.isFinite(value)).map(({ value }) => draw("line", {
      class: "limit", x1: 0, x2: WIDTH, y1: this.y(value), y2: this.y(value),
    }));
    this.cursor = draw("line", { class: "cursor", y1: 0, y2: this.height });
    const dotted = times.length > MOST_DOTS ? [] : times.map((_, n) => n);
    const dots = dotted.filter((n) => Number.isFinite(values[n]) && Number.isFinite(times[n])).map((n) => draw("line", {
      class: "dot", x1: curves.x(times[n]), x2: curves.x(times[n]), y1: this.y(values[n]), y2: this.y(values[n]) + 0.01,
    }));
    this.picture.replaceChildren(...limits, this.cursor, draw("path", { class: "line", d: path }), ...dots);
    const shown = this.isNumber ? [this.high, this.low].map((value) => Number(value.toPrecision(2))) : ["true", "false"];
    this.scale.replaceChildren(...shown.map((text) => make("span", {}, String(text))));
    this.choose();
  }

  choose() {
    const at = this.curves.at, time = this.run.times[at ?? 0];
    const x = at === null || !Number.isFinite(time) ? -10 : this.curves.x(time);
    this.cursor?.setAttribute("x1", x);
    this.cursor?.setAttribute("x2", x);
    const cell = this.run.cells(this.signal.name)[at ?? 0] ?? "";
    this.picture.setAttribute("aria-valuenow", Number.isFinite(this.value(cell)) ? this.value(cell) : 0);
    this.picture.setAttribute("aria-valuetext", `step ${at ?? 0}: ${cell || "no sample"}`);
  }

  set(at, value) {
    if (!(at in this.run.rows)) return;
    const rounded = Number(value.toPrecision(3)), step = (this.high - this.low) / 200;
    const written = Math.abs(value) < step ? "0" : tidy(rounded);
    this.run.set(at, this.signal.name, this.isNumber ? written : String(value > 0.5));
  }

  // --- what people do ---

  listen() {
    const { picture } = this;
    picture.addEventListener("pointerdown", (event) => {
      picture.setPointerCapture(event.pointerId);
      this.last = this.place(event);
      this.stroke(this.last);
    });
    picture.addEventListener("pointermove", (event) => { if (this.last) this.stroke(this.place(event)); });
    for (const name of ["pointerup", "pointercancel"]) {
      picture.addEventListener(name, () => {
        this.last = null;
        this.refresh();
      });
    }
    picture.addEventListener("keydown", (event) => this.key(event));
  }

  place(event) {
    const box = this.picture.getBoundingClientRect();
    const y = Math.min(Math.max((event.clientY - box.top) / box.height, 0), 1);
    const at = this.curves.row((event.clientX - box.left) / box.width * WIDTH);
    return { at, value: this.high - y * (this.high - this.low) };
  }

  // A stroke from the place before: the steps that were passed in between get what is in between.
  stroke(to) {
    const from = this.last, steps = Math.abs(to.at - from.at);
    for (let n = 0; n <= steps; n++) {
      const share = steps ? n / steps : 1;
      this.set(Math.round(from.at + (to.at - from.at) * share), from.value + (to.value - from.value) * share);
    }
    this.last = to;
    this.refresh();
    this.curves.changed(to.at, this);
  }

  key(event) {
    const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!by) return;
    event.preventDefault();
    const at = Math.min(Math.max((this.curves.at ?? 0) + by[0], 0), this.run.rows.length - 1);
    if (!by[1]) return this.curves.chose(at);
    const now = this.values[at];
    const step = this.isNumber ? 10 ** Math.floor(Math.log10((this.high - this.low) / 10)) : 1;
    const value = (Number.isFinite(now) ? now : 0) + by[1] * step;
    this.set(at, this.isNumber ? Math.round(value / step) * step : value);
    this.refresh();
    this.curves.changed(at, this);
  }
}
