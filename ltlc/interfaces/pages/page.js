let scrolled = 0;
window.addEventListener("scroll", () => { scrolled = performance.now(); }, { passive: true });

readColours();
const views = new Map();
const timelines = [...document.querySelectorAll(".timeline")].map((element) => {
  const content = data.timelines[Number(element.dataset.timeline)];
  const name = element.dataset.view;
  if (!views.has(name)) views.set(name, new View(content.end));
  return new Timeline(element, content, views.get(name));
});

function repaint() {
  readColours();
  for (const timeline of timelines) timeline.redraw();
}

document.addEventListener("theme", repaint);

// Paper cannot wait for what is not read yet, so that is read once the page is there.
window.addEventListener("load", async () => {
  for (const timeline of timelines) await timeline.load();
});

// On paper: light colours, everything unfolded, all timelines drawn; afterwards as it was.
let asShown = null;
window.addEventListener("beforeprint", () => {
  const { style } = document.documentElement;
  asShown ??= { scheme: style.colorScheme, folded: [...document.querySelectorAll("details:not([open])")] };
  style.colorScheme = "light";
  readColours();
  for (const each of asShown.folded) each.open = true;
  for (const timeline of timelines) timeline.print();
});
window.addEventListener("afterprint", () => {
  document.documentElement.style.colorScheme = asShown.scheme;
  for (const each of asShown.folded) each.open = false;
  asShown = null;
  readColours();
  for (const timeline of timelines) timeline.resize();
});
