/* Element creation without markup strings: text from the server can never become markup. */

/**
 * h("button", {class: "quiet", onclick: f, "aria-pressed": true}, "text", node, [nodes])
 * null, undefined and false children and attributes are left out.
 */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name.startsWith("aria-")) element.setAttribute(name, String(value));
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false) element.setAttribute(name, String(value));
  }
  element.append(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  return element;
}

/** The path of the service without its last slash: "" or the prefix that a proxy gives it. */
export const ROOT = new URL(import.meta.url).pathname.replace(/\/page\/.*$/, "");

export const byId = (id) => document.getElementById(id);

/** A command or address to copy. */
export function copyable(text, label) {
  const button = h("button", {
    type: "button", class: "quiet small", "aria-label": `Copy: ${label}`,
    onclick: async () => {
      try {
        await navigator.clipboard.writeText(text);
        button.textContent = "Copied";
      } catch {
        // No clipboard without a secure origin: select the text, so that the user can copy it.
        getSelection().selectAllChildren(button.previousElementSibling);
        button.textContent = "Selected";
      }
      setTimeout(() => { button.textContent = "Copy"; }, 1500);
    },
  }, "Copy");
  return h("span", { class: "copyable" }, h("code", {}, text), button);
}

/** The state of a part that failed: what the server's problem document says, and a way to try again. */
export function problemNotice(problem, retry) {
  return h("div", { class: "notice error", role: "alert" },
    h("p", {}, h("strong", {}, problem.title || "Something went wrong"),
      problem.status ? ` (${problem.status})` : ""),
    problem.detail && !problem.errors?.length && h("p", {}, problem.detail),
    problem.errors?.length > 0 && h("ul", {}, problem.errors.map((e) => h("li", {},
      h("code", {}, e.parameter ?? ""), `: expected ${e.expected ?? "another value"}`,
      e.value !== undefined && e.value !== null && `, got “${e.value}”`,
      e.nearest && `; did you mean “${e.nearest}”?`))),
    retry && h("button", { type: "button", onclick: retry }, "Try again"));
}
