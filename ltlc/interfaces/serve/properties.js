// The properties with their verdicts, and what is to be said of the one that is chosen.

import { $, badge, make, picture } from "./dom.js";
import { exampleTable } from "./examples.js";

export function showProperties(properties, verdicts, chosen, choose) {
  const hasFocus = $("properties").contains(document.activeElement);
  $("properties").replaceChildren(...properties.map(({ label }, n) => make("button", {
    type: "button", "aria-pressed": String(n === chosen), onclick: () => choose(n),
  }, label, " ", ...verdicts?.[n] ? [badge(verdicts[n])] : [])));
  if (hasFocus) $("properties").children[chosen]?.focus();
}

// What a property says.
export function showCard(property) {
  $("card").hidden = !property;
  if (!property) return;
  $("card").replaceChildren(
    make("pre", { class: "property" }, make("code", {}, property.text)),
    make("p", { class: "english" }, property.english));
}

// What the run shows of a property; below the run, which so stays in its place while somebody draws.
export function showReason(judged) {
  $("told").textContent = judged?.told ?? "";
  $("reason").hidden = !judged?.figure;
  $("reason").firstElementChild.textContent = judged?.figure ?? "";
}

// The monitor with the way that the run took, up to the step `at` if one is chosen.
export function showMachine(shown, at) {
  const texts = shown ? [at === null ? "" : `After step ${at}:`, shown.described, shown.remark].filter(Boolean) : [];
  $("machine-text").textContent = texts.join(" ");
  $("machine").replaceChildren(...shown ? [picture(shown.svg)] : []);
  $("letters").replaceChildren(...(shown?.letters ?? []).map(([letter, text]) =>
    make("div", {}, make("dt", {}, letter), make("dd", {}, text))));
}

// The zones of the property, and the path among them.
export function showMaps(maps) {
  $("maps").replaceChildren(...maps.map(({ svg, described, remark }) => make("figure", { class: "plane" },
    make("div", { class: "wide picture", tabindex: "0", role: "img", "aria-label": described }, picture(svg)),
    make("figcaption", {}, `${described} ${remark}`))));
}

// A property explained: its class, and a run for each verdict that it can have.
export function showExplanation(element, explained, load) {
  const states = explained.states === null ? "" : `, ${explained.states} state${explained.states === 1 ? "" : "s"}`;
  element.replaceChildren(
    explained.class ? make("p", { class: "note" }, `${explained.class}${states}`) : "",
    explained.limit ? make("p", { class: "note" }, `No runs are shown: finding them ${explained.limit}.`) : "",
    ...explained.examples.map((example) => exampleTable(example, load)));
}
