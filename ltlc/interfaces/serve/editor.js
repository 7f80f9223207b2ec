// The text with marks in it: a text area over a copy of its text, which has colours, and findings underlined.

import { make } from "./dom.js";

export class Editor {
  constructor(area, marks, changed, moved) {
    Object.assign(this, { area, marks, findings: [], colours: (line) => [[line, null]], drawn: new Map() });
    area.addEventListener("input", () => {
      this.findings = [];
      this.draw();
      changed();
    });
    document.addEventListener("selectionchange", () => { if (document.activeElement === area) moved(); });
  }

  get text() {
    return this.area.value;
  }
  // The cursor goes behind what is different.
  set text(text) {
    const old = this.area.value;
    let end = 0;
    while (end < text.length && text.at(-1 - end) === old.at(-1 - end)) end++;
    this.area.value = text;
    this.area.setSelectionRange(text.length - end, text.length - end);
    this.findings = [];
    this.draw();
  }

  // Where a place is in the text: places count lines and characters from 1, a character above U+FFFF once.
  offset({ line, column }) {
    const lines = this.area.value.split("\n");
    const before = lines.slice(0, line - 1).reduce((sum, each) => sum + each.length + 1, 0);
    return before + [...(lines[line - 1] ?? "")].slice(0, column - 1).join("").length;
  }
  range(span) {
    return [this.offset(span.start), this.offset(span.end)];
  }

  get cursor() {
    return this.area.selectionStart;
  }
  holds(span) {
    const [start, end] = this.range(span);
    return start <= this.cursor && this.cursor <= end;
  }

  show(span) {
    const [start, end] = this.range(span);
    this.area.focus();
    this.area.setSelectionRange(start, Math.max(end, start));
    this.marks.children[span.start.line - 1]?.scrollIntoView({ block: "nearest" });
  }

  // Carry out the edits of a fix as if they were typed, so that they can be undone.
  apply(edits) {
    const found = edits.map(({ span, text }) => [...this.range(span), text]).sort((a, b) => b[0] - a[0]);
    this.area.focus();
    for (const [start, end, text] of found) {
      this.area.setSelectionRange(start, end);
      document.execCommand(text ? "insertText" : "delete", false, text);
    }
  }

  mark(findings) {
    this.findings = findings;
    this.draw();
  }

  // Lines that are as they were are not made again.
  draw() {
    const spans = this.findings.map(({ span, severity }) => [...this.range(span), severity]);
    const before = this.drawn;
    this.drawn = new Map();
    let start = 0;
    const lines = this.area.value.split("\n").map((line) => {
      const here = spans.map(([from, to, severity]) => [from - start, Math.max(to, from + 1) - start, severity])
        .filter(([from, to]) => from <= line.length && to > 0);
      start += line.length + 1;
      const key = JSON.stringify([line, here]);
      const element = before.get(key)?.pop() ?? make("div", {}, ...this.pieces(line, here));
      if (!this.drawn.get(key)?.push(element)) this.drawn.set(key, [element]);
      return element;
    });
    this.marks.replaceChildren(...lines);
  }

  // A line in pieces, each with the weightiest of the findings that are about it.
  pieces(line, here) {
    const end = line.length;
    const cuts = [...new Set([0, end, ...here.flatMap(([from, to]) => [from, to])])]
      .filter((cut) => 0 <= cut && cut <= end).sort((a, b) => a - b);
    const weigh = (severity) => ["error", "warning", "note"].indexOf(severity);
    const colours = this.colours(line);
    const pieces = cuts.slice(1).flatMap((cut, n) => {
      const about = here.filter(([from, to]) => from <= cuts[n] && to >= cut).map((each) => each[2]);
      const text = coloured(colours, cuts[n], cut);
      return about.length ? [make("mark", { class: about.sort((a, b) => weigh(a) - weigh(b))[0] }, ...text)] : text;
    });
    const atEnd = here.filter(([from]) => from === end).map((each) => each[2]);
    if (atEnd.length) return [...pieces, make("mark", { class: atEnd[0] }, " ")];
    return line ? pieces : ["\u200b"]; // so that an empty line has its height; after a blank it would begin another
  }
}

// The part of a line between two of its places, with colours.
function coloured(pieces, from, to) {
  let end = 0;
  return pieces.flatMap(([piece, kind]) => {
    const start = end;
    end += piece.length;
    const text = piece.slice(Math.max(from - start, 0), Math.max(to - start, 0));
    if (!text) return [];
    return [kind ? make("span", { class: `token ${kind}` }, text) : text];
  });
}
