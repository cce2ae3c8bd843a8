/* Terms of the glossary: a tap or Enter shows the meaning beside the word, another one goes there. */

import { h } from "./dom.js";

let open = null;

function close() {
  open?.remove();
  open = null;
}

function show(link) {
  close();
  const tip = h("span", { class: "tip", role: "status" }, link.title, " ", h("a", { href: link.href }, "More"));
  document.body.append(tip);
  const at = link.getBoundingClientRect();
  const room = document.documentElement.clientWidth - tip.offsetWidth - 8;
  tip.style.left = `${Math.max(8, Math.min(at.left, room)) + scrollX}px`;
  tip.style.top = `${at.bottom + scrollY + 4}px`;
  open = tip;
}

/** Let the terms in `place` tell their meaning where they stand. */
export function tips(place) {
  place.addEventListener("click", (event) => {
    const link = event.target.closest("a.term");
    if (!link || event.ctrlKey || event.metaKey || event.shiftKey) {
      if (!event.target.closest(".tip")) close();
      return;
    }
    event.preventDefault();
    show(link);
  });
  place.addEventListener("keydown", (event) => {
    if (event.key === "Escape") close();
  });
}
