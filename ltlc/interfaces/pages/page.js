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
