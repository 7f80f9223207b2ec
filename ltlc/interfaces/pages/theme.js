// The button that changes between light and dark; whoever draws with colours hears of it by the event `theme`.

const theme = document.getElementById("theme");
const system = matchMedia("(prefers-color-scheme: dark)");
const isDark = () => (document.documentElement.style.colorScheme || (system.matches ? "dark" : "light")) === "dark";
function sayTheme() {
  theme.setAttribute("aria-pressed", String(isDark()));
  theme.textContent = isDark() ? "Light" : "Dark";
  document.dispatchEvent(new Event("theme"));
}
theme.addEventListener("click", () => {
  document.documentElement.style.colorScheme = isDark() ? "light" : "dark";
  sayTheme();
});
system.addEventListener("change", sayTheme);
sayTheme();
