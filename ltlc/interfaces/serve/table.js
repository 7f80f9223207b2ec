// The run as a table: a row for each step, with the verdict of each property after it.

import { badge, make } from "./dom.js";

export class RunTable {
  constructor(element, run, { edited, reshaped, chose, failed }) {
    Object.assign(this, { element, run, edited, reshaped, chose, failed, at: null });
    element.addEventListener("input", (event) => this.typed(event.target));
    element.addEventListener("focusin", (event) => this.look(event.target));
    element.addEventListener("keydown", (event) => this.key(event));
    element.addEventListener("paste", (event) => this.pasted(event));
  }

  get names() {
    return ["time", ...this.run.signals.map((signal) => signal.name)];
  }

  // Draw all of it anew; `labels` are those of the properties.
  draw(labels) {
    const focus = this.place(document.activeElement);
    const heads = [...this.names.map((name) => (name === "time" ? "time in s" : name)), ...labels];
    this.rows = this.run.rows.map((_, at) => this.row(at, labels));
    this.element.replaceChildren(make("table", { class: "steps" },
      make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "step"),
        ...heads.map((head) => make("th", { scope: "col" }, head)), make("td", {}))),
      make("tbody", {}, ...this.rows.map((row) => row.element))));
    if (focus) this.focus(focus.at, focus.column);
  }

  row(at, labels) {
    const inputs = this.names.map((name) => make("input", {
      "aria-label": `${name}, step ${at}`, "data-at": at, "data-name": name, size: 6, inputmode: "text",
    }));
    const verdicts = labels.map(() => make("td", { class: "verdict" }));
    const buttons = make("td", { class: "row-tools" },
      make("button", { type: "button", "aria-label": `add a step after step ${at}`, title: "add a step after this one",
        onclick: () => this.add(at + 1) }, "+"),
      make("button", { type: "button", "aria-label": `remove step ${at}`, title: "remove this step",
        onclick: () => this.remove(at) }, "×"));
    const element = make("tr", {}, make("th", { scope: "row" }, String(at)),
      ...inputs.map((input) => make("td", {}, input)), ...verdicts, buttons);
    const row = { element, inputs, verdicts };
    this.fill(row, at);
    return row;
  }

  fill(row, at) {
    const { time, cells } = this.run.rows[at];
    row.inputs.forEach((input) => {
      const text = input.dataset.name === "time" ? time : cells[input.dataset.name] ?? "";
      if (input.value !== text) input.value = text;
    });
  }

  // Show the cells as they are in the run, after something else has changed them.
  refresh() {
    this.rows.forEach((row, at) => this.fill(row, at));
  }

  // Show `verdicts`, for each property those of the rows, and mark the rows in which one is violated first, and one
  // that could not be judged.
  tell(verdicts) {
    const bad = verdicts?.[0]?.indexOf(null) ?? -1;
    this.rows.forEach((row, at) => {
      row.element.classList.toggle("bad", at === bad);
      let isFailing = false;
      row.verdicts.forEach((cell, n) => {
        const verdict = verdicts?.[n]?.[at];
        cell.replaceChildren(...verdict ? [badge(verdict, true)] : []);
        isFailing ||= verdict === "violated" && verdicts[n][at - 1] !== "violated";
      });
      row.element.classList.toggle("failing", isFailing);
    });
  }

  choose(at) {
    this.at = at;
    this.rows.forEach((row, n) => row.element.classList.toggle("at", n === at));
  }

  add(at) {
    this.run.insert(at);
    this.reshaped();
    this.focus(at, 1);
  }

  remove(at) {
    if (this.run.rows.length === 1) return;
    this.run.remove(at);
    this.reshaped();
    this.focus(Math.min(at, this.run.rows.length - 1), 0);
  }

  place(input) {
    if (!this.element.contains(input) || input.dataset.at === undefined) return null;
    return { at: Number(input.dataset.at), column: this.names.indexOf(input.dataset.name) };
  }
  focus(at, column) {
    this.rows[at]?.inputs[Math.min(column, this.names.length - 1)]?.focus();
  }
  look(input) {
    const place = this.place(input);
    if (place && place.at !== this.at) this.chose(place.at);
  }

  typed(input) {
    const place = this.place(input);
    this.run.set(place.at, input.dataset.name, input.value);
    this.edited(input);
  }

  key(event) {
    const place = this.place(event.target);
    const by = { ArrowDown: 1, Enter: 1, ArrowUp: -1 }[event.key];
    if (!place || !by) return;
    event.preventDefault();
    if (event.key === "Enter" && place.at === this.run.rows.length - 1) {
      this.run.insert(place.at + 1);
      this.reshaped();
    }
    this.focus(place.at + by, place.column);
    document.activeElement.select?.();
  }

  pasted(event) {
    const text = event.clipboardData.getData("text"), place = this.place(event.target);
    if (!place || !/[\t\n,]/.test(text.trim())) return;
    event.preventDefault();
    try {
      this.run.paste(text, place.at, place.column);
      this.reshaped();
    } catch (error) {
      this.failed(error);
    }
  }
}
