// In a notebook, the frame is as tall as its content: links and the wheel scroll the notebook.
window.addEventListener("message", (event) => {
  if (event.data === "scrolled") scrolled = performance.now();
  if (event.data !== "height") return;
  const page = document.documentElement;
  new ResizeObserver(() => event.source.postMessage(page.offsetHeight, "*")).observe(page);
});

document.addEventListener("click", (event) => {
  const link = event.target.closest("a[href^='#']");
  if (link) document.getElementById(link.getAttribute("href").slice(1))?.scrollIntoView();
});
