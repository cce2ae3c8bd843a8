/* Classic script, run before the first paint: the stored choice wins over the system's scheme. */
(function () {
  "use strict";
  const system = window.matchMedia("(prefers-color-scheme: dark)");

  function stored() {
    try {
      const theme = localStorage.getItem("theme");
      return theme === "auto" ? null : theme; // as the guide's theme wrote it
    } catch {
      return null; // storage refused: follow the system
    }
  }

  function set(theme) {
    if (document.documentElement.dataset.theme === theme) return;
    document.documentElement.dataset.theme = theme;
    document.documentElement.classList.toggle("dark-mode", theme === "dark"); // as Swagger UI reads it
    if (document.body?.dataset.theme) document.body.dataset.theme = theme; // and the guide
    document.dispatchEvent(new CustomEvent("themechange"));
  }

  const apply = () => set(stored() || (system.matches ? "dark" : "light"));

  function choose(theme) {
    try {
      // A choice equal to the system's is no choice: the page follows the system again.
      if (theme === (system.matches ? "dark" : "light")) localStorage.removeItem("theme");
      else localStorage.setItem("theme", theme);
    } catch {
      set(theme);
      return;
    }
    apply();
  }

  apply();
  system.addEventListener("change", apply);

  document.addEventListener("DOMContentLoaded", () => {
    if (document.body.dataset.theme) document.body.dataset.theme = document.documentElement.dataset.theme;
    const button = document.getElementById("theme-toggle");
    const label = () => {
      const other = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
      button.textContent = other === "dark" ? "Dark" : "Light";
      button.setAttribute("aria-label", `Switch to the ${other} colour scheme`);
      button.dataset.to = other;
    };
    button.hidden = false;
    button.addEventListener("click", () => choose(button.dataset.to));
    document.addEventListener("themechange", label);
    label();
  });
})();
