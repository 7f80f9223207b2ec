// The run that is edited: rows of cells as text, by the names of signals; an empty cell is no sample.

export const MOST_STEPS = 2000;
const PLAIN = /^\s*-?(0|[1-9]\d*)(\.\d+)?([eE][+-]?\d+)?\s*$/;
const USUAL = {
  number: "0", boolean: "false", "array of numbers": "[0]", "array of booleans": "[false]", "array of strings": '[""]',
};

// A time in nanoseconds as seconds, exactly.
export function secondsText(nanoseconds) {
  const digits = String(Math.abs(nanoseconds)).padStart(10, "0");
  const fraction = digits.slice(-9).replace(/0+$/, "");
  return `${nanoseconds < 0 ? "-" : ""}${digits.slice(0, -9)}${fraction ? `.${fraction}` : ""}`;
}

// `number` without the noise of binary fractions.
export const tidy = (number) => String(Number(number.toPrecision(12)));

// Where between two values a wave is, from 0 to 1, at each part of the run from 0 to 1.
export const WAVES = {
  constant: () => 0,
  step: (part) => (part < 0.5 ? 0 : 1),
  ramp: (part) => part,
  sine: (part) => 0.5 + 0.5 * Math.sin(2 * Math.PI * part),
};

export class Run {
  constructor() {
    this.rows = [];
    this.signals = [];
    this.known = new Set();
  }

  get times() {
    return this.rows.map((row) => Number(row.time));
  }
  cells(name) {
    return this.rows.map((row) => row.cells[name] ?? "");
  }

  // What a new row has of a signal.
  usual({ type, wanted }) {
    return USUAL[type] ?? wanted[0] ?? "";
  }

  // Take the signals of the specification; cells of signals that are gone stay, in case these come back.
  use(signals) {
    const isNew = (signal) => this.rows.every((row) => !(signal.name in row.cells));
    for (const signal of signals.filter(isNew)) {
      for (const row of this.rows) row.cells[signal.name] = this.usual(signal);
    }
    this.signals = signals;
    for (const { name } of signals) this.known.add(name);
  }

  // The rows without the cells of signals that the specification had, and has no more.
  get current() {
    const names = new Set(this.signals.map((signal) => signal.name));
    const stays = ([name]) => names.has(name) || !this.known.has(name);
    return this.rows.map(({ time, cells }) => ({ time, cells: Object.fromEntries(Object.entries(cells).filter(stays)) }));
  }

  blank(count, every) {
    this.rows = [];
    for (let n = 0; n < count; n++) this.insert(n, tidy(n * every));
  }

  insert(at, time = null) {
    const before = this.rows[at - 1], after = this.rows[at];
    const cells = before ? { ...before.cells } : Object.fromEntries(this.signals.map((s) => [s.name, this.usual(s)]));
    this.rows.splice(at, 0, { time: time ?? this.timeBetween(before, after), cells });
  }

  timeBetween(before, after) {
    if (before && after) return tidy((Number(before.time) + Number(after.time)) / 2);
    const others = this.times.slice(-2);
    const step = others.length === 2 ? others[1] - others[0] : 1;
    return before ? tidy(Number(before.time) + (step || 1)) : "0";
  }

  remove(at) {
    this.rows.splice(at, 1);
  }

  // So many rows at even times, each with what the run had at that time.
  even(count, every) {
    const start = Number(this.rows[0]?.time ?? 0), { rows, times } = this;
    this.rows = [];
    for (let n = 0; n < count; n++) {
      const time = start + n * every;
      const known = rows.filter((_, at) => times[at] <= time + every * 1e-9);
      const cells = Object.assign({}, ...known.map((row) => filled(row.cells)));
      this.insert(n, tidy(time));
      Object.assign(this.rows[n].cells, cells);
    }
  }

  // Give a number or boolean signal the values of a wave between two values, once in the whole run.
  fill({ name, type }, wave, from, to) {
    const known = this.times.filter(Number.isFinite), start = Math.min(...known), length = Math.max(...known) - start;
    this.times.forEach((time, at) => {
      if (!Number.isFinite(time)) return;
      const value = from + (to - from) * WAVES[wave](length ? (time - start) / length : 0);
      this.set(at, name, type === "number" ? tidy(Number(value.toPrecision(6))) : String(value > 0.5));
    });
  }

  // The signals that can be drawn, and filled.
  get drawable() {
    return this.signals.filter(({ type }) => ["number", "boolean"].includes(type));
  }

  // Take the steps of an example; those without a time follow one another at the rate of the specification.
  load(steps, rate) {
    this.rows = steps.map((step, n) => ({
      time: "time_ns" in step ? secondsText(step.time_ns) : tidy(n / (rate || 1)),
      cells: step.by_time ? {} : Object.fromEntries(
        this.signals.filter(({ name }) => name in (step.values ?? {})).map(({ name }) => [name, cellOf(step.values[name])])),
    }));
  }

  // The steps as JSON text: numbers as they were written, whatever is no value of its signal as a string.
  steps() {
    const types = new Map(this.signals.map(({ name, type }) => [name, type]));
    const objects = this.current.map(({ time, cells }) => {
      const given = Object.entries(cells).filter(([name, cell]) => cell.trim() !== "" || types.get(name) === "string");
      const pairs = given.map(([name, cell]) => `${JSON.stringify(name)}: ${valueText(cell, types.get(name))}`);
      return `{${[`"time": ${JSON.stringify(time)}`, ...pairs].join(", ")}}`;
    });
    return `[${objects.join(", ")}]`;
  }

  csv() {
    const rows = this.current;
    const names = [...new Set(rows.flatMap((row) => Object.keys(row.cells)))];
    const lines = [["time", ...names], ...rows.map((row) => [row.time, ...names.map((n) => row.cells[n] ?? "")])];
    return lines.map((line) => `${line.map(quoted).join(",")}\n`).join("");
  }

  // Take a table that somebody has copied: with a head that has `time`, or without one from a cell on. Raises Error.
  paste(text, row = 0, column = 0) {
    const lines = parsed(text);
    if (lines.length > MOST_STEPS) throw new Error(`a run has at most ${MOST_STEPS} steps here`);
    const head = lines[0]?.map((cell) => cell.trim());
    if (head?.includes("time")) this.rows = lines.slice(1).map((line) => named(head, line));
    else this.pasteCells(lines, row, column);
  }

  pasteCells(lines, row, column) {
    const names = ["time", ...this.signals.map((signal) => signal.name)];
    lines.forEach((line, n) => {
      if (row + n >= this.rows.length) this.insert(this.rows.length);
      line.forEach((cell, m) => { if (names[column + m]) this.set(row + n, names[column + m], cell.trim()); });
    });
  }

  set(at, name, text) {
    if (name === "time") this.rows[at].time = text;
    else this.rows[at].cells[name] = text;
  }
}

const filled = (cells) => Object.fromEntries(Object.entries(cells).filter(([, cell]) => cell !== ""));

function named(head, line) {
  const cells = Object.fromEntries(head.map((name, n) => [name, line[n] ?? ""]));
  const { time, ...others } = cells;
  return { time: time.trim(), cells: others };
}

const cellOf = (value) => (typeof value === "string" ? value : JSON.stringify(value));

function valueText(cell, type) {
  const text = cell.trim();
  if (type === "number" && PLAIN.test(text)) return text;
  if (type === "boolean" && ["true", "false", "1", "0"].includes(text.toLowerCase())) return text.toLowerCase();
  if (type?.startsWith("array") && isJson(text)) return text;
  return JSON.stringify(type === "string" ? cell : text);
}

function isJson(text) {
  try {
    return Array.isArray(JSON.parse(text));
  } catch {
    return false;
  }
}

const quoted = (cell) => (/[",\r\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);

// The cells of CSV, or of what a spreadsheet copies, which has tabs.
function parsed(text) {
  const comma = text.split("\n")[0].includes("\t") ? "\t" : ",";
  const lines = [[""]];
  let isQuoted = false;
  const clean = text.replaceAll("\r\n", "\n");
  for (let i = 0; i < clean.length; i++) {
    const line = lines.at(-1), character = clean[i];
    if (isQuoted && character === '"' && clean[i + 1] === '"') line[line.length - 1] += clean[++i];
    else if (character === '"' && (isQuoted || line.at(-1) === "")) isQuoted = !isQuoted;
    else if (isQuoted) line[line.length - 1] += character;
    else if (character === comma) line.push("");
    else if (character === "\n") lines.push([""]);
    else line[line.length - 1] += character;
  }
  return lines.filter((line) => line.some((cell) => cell.trim()));
}
