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
