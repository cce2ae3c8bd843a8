/* What pages gain with JavaScript: commands that copy at a press, terms that open at a tap. */

import { copyable } from "./dom.js";
import { tips } from "./terms.js";

for (const code of document.querySelectorAll(".copyable > code")) {
  code.parentElement.replaceWith(copyable(code.textContent, "this command"));
}
tips(document);

// On a narrow screen the parts are a row that scrolls: the one that is open is in sight.
document.querySelector(".masthead [aria-current]")?.scrollIntoView({ block: "nearest", inline: "center" });
