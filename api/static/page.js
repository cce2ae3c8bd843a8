/* The page: a change of the form asks anew, and what the service answers takes the answer's place. */

import { byId, problemNotice, ROOT } from "./dom.js";
import { copiable } from "./enhance.js";
import { watch } from "./live.js";

const PARTS = ["summary", "answer", "flow"];
let asking = null;

/** What the form asks, without its empty fields, as a query; each value once. */
function asked() {
  const pairs = [...new FormData(byId("question"))].filter(([, value]) => value !== "")
    .map(([name, value]) => [name, value.replace(/^\./, "0.")]);
  const distinct = new Map(pairs.map((pair) => [pair.join("="), pair]));
  return new URLSearchParams([...distinct.values()]).toString();
}

/** The home page of a question, as a document. */
async function fetchPage(query, signal) {
  let response;
  try {
    response = await fetch(ROOT + (query ? `/?${query}` : "/"), { headers: { Accept: "text/html" }, signal });
  } catch (cause) {
    if (cause.name === "AbortError") throw cause;
    throw Object.assign(cause, { title: "The server does not answer", detail: 'Is "sunatlas serve" still running?' });
  }
  // A refusal is a page, too, with the service's words.
  const page = new DOMParser().parseFromString(await response.text(), "text/html");
  if (page.getElementById("answer")) return page;
  throw Object.assign(new Error(), { title: response.statusText || "Error", status: response.status });
}

/** Show the answer to a query; the form is replaced where the query did not come from it. */
async function show(query, { ofForm = false } = {}) {
  asking?.abort();
  asking = new AbortController();
  const { signal } = asking;
  const answer = byId("answer");
  answer.setAttribute("aria-busy", "true");
  try {
    const page = await fetchPage(query, signal);
    if (ofForm) {
      // What a mission implies stands in the empty fields.
      for (const field of page.querySelectorAll("#question [placeholder]")) {
        byId("question").elements[field.name].placeholder = field.placeholder;
      }
    } else {
      const open = [...document.querySelectorAll("#question details[open] > summary")].map((s) => s.textContent);
      byId("question").replaceWith(page.getElementById("question"));
      for (const summary of document.querySelectorAll("#question summary")) {
        if (open.includes(summary.textContent)) summary.parentElement.open = true;
      }
      listen();
    }
    for (const id of PARTS) {
      byId(id).replaceChildren(...page.getElementById(id).childNodes);
      watch(byId(id));
      copiable(byId(id));
    }
  } catch (problem) {
    if (problem.name === "AbortError") return;
    byId("summary").replaceChildren();
    answer.replaceChildren(problemNotice(problem, () => show(query, { ofForm })));
  }
  answer.removeAttribute("aria-busy");
}

/** A query in the one order that can be compared. */
function sorted(query) {
  const pairs = new URLSearchParams(query);
  pairs.sort();
  return pairs.toString();
}

/** Ask a query and keep it in the address, so that Back leads here. */
function ask(query, settings) {
  if (sorted(query) === sorted(location.search)) return;
  history.pushState(null, "", ROOT + (query ? `/?${query}` : "/"));
  show(query, settings);
}

function listen() {
  const form = byId("question");
  const asks = () => form.checkValidity() && ask(asked(), { ofForm: true });
  form.addEventListener("change", asks);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    asks();
    byId("answer").focus();
  });
}

listen();
addEventListener("popstate", () => show(new URLSearchParams(location.search).toString()));
// What a click in the flow asks for is asked without leaving the page.
addEventListener("figurenarrow", (event) => {
  event.preventDefault();
  ask(event.detail.searchParams.toString());
});
document.documentElement.dataset.live = "true";
