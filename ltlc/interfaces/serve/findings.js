// The findings as a list below the text, with the page of each code, and fixes to be carried out.

import { make } from "./dom.js";
import { exampleTable } from "./examples.js";

let shown = "";

// Show `findings`; the list stays as it is if it shows these, so that nothing is taken from under a pointer.
export function showFindings(list, findings, editor, load) {
  const text = JSON.stringify(findings);
  if (text === shown) return;
  shown = text;
  list.replaceChildren(...findings.map((finding) => item(finding, editor, load)));
}

export function summary(findings) {
  const count = (severity) => findings.filter((each) => each.severity === severity).length;
  const said = [["error", "errors"], ["warning", "warnings"], ["note", "notes"]]
    .map(([one, several]) => [count(one), one, several]).filter(([number]) => number)
    .map(([number, one, several]) => `${number} ${number === 1 ? one : several}`);
  return said.join(", ") || "no problems found";
}

export function markHere(list, findings, editor) {
  findings.forEach((finding, n) => list.children[n]?.classList.toggle("here", editor.holds(finding.span)));
}

function item(finding, editor, load) {
  const { code, severity, message, span, help, fixes, example, related } = finding;
  return make("li", { class: `remark ${severity}` },
    make("strong", {}, `${severity} `),
    make("a", { href: `codes/${code}`, target: "_blank", rel: "noopener", title: `${finding.name}: read more` }, code),
    " ",
    make("button", { type: "button", class: "place", onclick: () => editor.show(span) }, `line ${span.start.line}`),
    " ", message,
    ...related.filter((each) => each.message).map((each) => make("div", { class: "help" },
      make("button", { type: "button", class: "place", onclick: () => editor.show(each.span) },
        `line ${each.span.start.line}`), " ", each.message)),
    help ? make("div", { class: "help" }, help) : null,
    fixes.length ? make("div", { class: "tools" }, ...fixes.map((fix) => make("button", {
      type: "button", class: "fix", onclick: () => editor.apply(fix.edits),
    }, fix.title))) : null,
    example ? exampleTable(example, load) : null);
}
