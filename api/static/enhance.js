/* With JavaScript: commands can be copied, terms open at a tap, links open the fold that holds their target. */

import { copyable } from "./dom.js";
import { tips } from "./terms.js";

for (const code of document.querySelectorAll(".copyable > code")) {
  code.parentElement.replaceWith(copyable(code.textContent, "this command"));
}
tips(document);

/** Open the folded table that holds the row of the address. */
function unfold() {
  const fold = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)))?.closest("details:not([open])");
  if (!fold) return;
  fold.open = true;
  document.getElementById(decodeURIComponent(location.hash.slice(1))).scrollIntoView();
}
addEventListener("hashchange", unfold);
unfold();

// On a narrow screen the parts are a row that scrolls: the one that is open is in sight.
const current = document.querySelector(".masthead [aria-current]");
if (current) {
  // not scrollIntoView: the tab key would go on from there, past the link that skips to the content
  const nav = current.closest("nav");
  const [inner, outer] = [current.getBoundingClientRect(), nav.getBoundingClientRect()];
  nav.scrollLeft += inner.left + inner.width / 2 - (outer.left + outer.width / 2);
}
