/* With JavaScript: commands can be copied, terms open at a tap, addresses of forms are short, links open the fold that holds their target. */

import { copyable } from "./dom.js";
import { tips } from "./terms.js";

/** Make commands in a part of the page copiable. */
export function copiable(part) {
  for (const code of part.querySelectorAll(".copyable > code:only-child")) {
    code.parentElement.replaceWith(copyable(code.textContent, "this command"));
  }
}

copiable(document);
tips(document);
addEventListener("formdata", ({ target, formData }) => { // the address has no field that nobody filled in
  if (target.method !== "get") return;
  const filled = [...formData].filter(([, value]) => value !== "");
  for (const name of [...formData.keys()]) formData.delete(name);
  for (const pair of filled) formData.append(...pair);
});

/** Open the folded table that holds the row of the address. */
function unfold() {
  const fold = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)))?.closest("details:not([open])");
  if (!fold) return;
  fold.open = true;
  document.getElementById(decodeURIComponent(location.hash.slice(1))).scrollIntoView();
}
addEventListener("hashchange", unfold);
unfold();
