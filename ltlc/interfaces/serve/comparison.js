// The same sentence under each encoding, and the shortest runs that tell two of them apart.

import { badge, make } from "./dom.js";
import { exampleTable, table } from "./examples.js";

const SAID = {
  equivalent: "equivalent", stronger: "the first is stronger", weaker: "the second is stronger",
  incomparable: "neither implies the other",
};

export function showComparison(element, compared, load) {
  const undefinedHere = compared.undefined.map(({ name, reason }) => make("p", { class: "note" }, `${name}: ${reason}`));
  element.replaceChildren(
    make("div", { class: "wide" }, table(["encoding", "states", "class", "this run"], compared.encodings.map((each) => [
      each.name, each.states ?? each.limits?.monitor ?? "", each.class ?? each.limits?.class ?? "",
      make("span", { "data-encoding": each.name }),
    ]))),
    ...undefinedHere,
    ...compared.comparisons.map((each) => pair(each, load)));
}

// Say what the run shows under an encoding.
export function tellEncoding(element, name, verdict) {
  const place = [...element.querySelectorAll("[data-encoding]")].find((each) => each.dataset.encoding === name);
  place?.replaceChildren(verdict ? badge(verdict) : "");
}

function pair({ left, right, finite }, load) {
  const title = make("h3", {}, `${left} and ${right}`);
  if (!finite.relation) return make("div", {}, title, make("p", { class: "note" }, `not decided: ${finite.limits.relation}`));
  const runs = [[finite.left_only, left], [finite.right_only, right]].filter(([run]) => run);
  return make("div", { class: "pair-of-encodings" }, title, make("p", { class: "help" }, `${SAID[finite.relation]}.`),
    ...runs.map(([run, name]) => separating(run, name, left, right, load)));
}

function separating(run, name, left, right, load) {
  const caption = `${run.shortest ? "The shortest run" : "A run"} that satisfies only ${name}:`;
  const steps = run.steps.map((step) => ({
    ...step,
    values: step.values ?? {},
    remark: `${left}: ${step.left.replace("_", " ")}; ${right}: ${step.right.replace("_", " ")}`,
  }));
  if (run.steps.some((step) => step.values)) return exampleTable({ caption, steps, loop: run.loop }, load);
  const rows = steps.map((step, n) => [String(n), step.atoms.join(", ") || "none", step.remark]);
  return make("div", {}, make("p", { class: "help" }, caption),
    make("div", { class: "wide" }, table(["step", "what holds", ""], rows)));
}
