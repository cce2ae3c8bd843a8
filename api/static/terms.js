/* Terms of the glossary: a tap or Enter shows the meaning beside the word, another one goes there. */

import { h } from "./dom.js";
import { getJson } from "./service.js";

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

let asked = null;

/** Terms by name, asked for once a visit. */
function terms() {
  asked ??= getJson("/glossary.json").then(({ terms: all }) => new Map(all.map((t) => [t.term, t])));
  return asked;
}

const LEFT_OUT = "a, button, code, pre, summary, select, svg, .term, .visually-hidden";
const capitals = (word) => (word.match(/[A-Z]/g) ?? []).length > 1;
const idOf = (term) => `term-${term}`.replace(/[^\p{L}\p{N}]/gu, "-").toLowerCase();

/** Link the abbreviations of a part of the page to their meaning, each once in it. */
export async function explain(place) {
  let known;
  try {
    known = await terms();
  } catch {
    asked = null; // the words stand without their meaning; another part may have more luck
    return;
  }
  const words = [...known.keys()].filter(capitals).sort((a, b) => b.length - a.length);
  const pattern = new RegExp(`(?<![\\w/-])(?:${words.map((w) => w.replace(/[.*+?^$()|[\]\\]/g, "\\$&")).join("|")})(?![\\w-])`);
  const met = new Set();
  const walker = document.createTreeWalker(place, NodeFilter.SHOW_TEXT, (node) =>
    (node.parentElement.closest(LEFT_OUT) ? NodeFilter.FILTER_REJECT : NodeFilter.FILTER_ACCEPT));
  const texts = [];
  while (walker.nextNode()) texts.push(walker.currentNode);
  for (const first of texts) {
    let text = first;
    let found = pattern.exec(text.data);
    while (found) {
      const rest = text.splitText(found.index);
      text = rest.splitText(found[0].length);
      const term = known.get(found[0]);
      if (!met.has(term.term)) {
        met.add(term.term);
        rest.replaceWith(h("a", { class: "term", href: `/glossary#${idOf(term.term)}`, title: term.short }, term.term));
      }
      found = pattern.exec(text.data);
    }
  }
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
