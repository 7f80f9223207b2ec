// Example runs as tables; one that has values can be loaded into the run that is edited.

import { make } from "./dom.js";
import { secondsText } from "./run.js";

export function exampleTable(example, load) {
  const names = Object.keys(example.steps[0]?.values ?? {});
  const isTimed = example.steps.some((step) => "time_ns" in step);
  const head = [isTimed ? "time in s" : "step", ...names, ""];
  const rows = example.steps.map((step, n) => [
    `${isTimed ? secondsText(step.time_ns) : n}${example.loop !== null && n >= example.loop ? " *" : ""}`,
    ...names.map((name) => shown(step.values[name])),
    step.remark,
  ]);
  return make("div", { class: "example-run" },
    make("p", { class: "help" }, example.caption, " ", make("button", {
      type: "button", onclick: () => load(example.steps),
    }, "Load into the run")),
    make("div", { class: "wide" }, table(head, rows)),
    example.loop === null ? null : make("p", { class: "help" }, "the steps marked * repeat forever"));
}

export function table(head, rows) {
  return make("table", {},
    make("thead", {}, make("tr", {}, ...head.map((text) => make("th", { scope: "col" }, text)))),
    make("tbody", {}, ...rows.map((row) => make("tr", {}, ...row.map((cell) => make("td", {}, cell))))));
}

const shown = (value) => (value === undefined || value === null ? "" : typeof value === "string" ? `"${value}"` : JSON.stringify(value));
