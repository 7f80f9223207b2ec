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

const theme = document.getElementById("theme");
const system = matchMedia("(prefers-color-scheme: dark)");
const isDark = () => (document.documentElement.style.colorScheme || (system.matches ? "dark" : "light")) === "dark";
function sayTheme() {
  theme.setAttribute("aria-pressed", String(isDark()));
  theme.textContent = isDark() ? "Light" : "Dark";
}
theme.addEventListener("click", () => {
  document.documentElement.style.colorScheme = isDark() ? "light" : "dark";
  sayTheme();
  repaint();
});
system.addEventListener("change", () => { sayTheme(); repaint(); });
sayTheme();
