// Making elements: whatever comes from a specification or a run becomes text, never markup.

export const $ = (id) => document.getElementById(id);

export function make(name, attributes = {}, ...children) {
  return fill(document.createElement(name), attributes, children);
}

export function draw(name, attributes = {}, ...children) {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== false) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

// A picture that the server has drawn.
export function picture(svg) {
  return document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true);
}

const SIGNS = {
  violated: "✗", presumably_violated: "(✗)", not_started: "–", presumably_satisfied: "(✓)", satisfied: "✓",
};
export const VERDICTS = Object.keys(SIGNS);
export const sign = (verdict) => SIGNS[verdict];
export const words = (verdict) => verdict.replace("_", " ");

export function badge(verdict, brief = false) {
  const text = brief ? SIGNS[verdict] : `${SIGNS[verdict]} ${words(verdict)}`;
  return make("span", { class: `badge ${verdict}`, title: words(verdict) }, text,
    brief ? make("span", { class: "hidden" }, ` ${words(verdict)}`) : null);
}

export function later(milliseconds, act) {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(act, milliseconds);
  };
}
