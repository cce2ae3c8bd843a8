/* The page: a change of the form asks anew, and what the service answers takes the answer's place. */

import { byId, problemNotice } from "./dom.js";
import { drawFlow, redrawFlow } from "./flow.js";
import { Problem } from "./service.js";

const PARTS = ["summary", "answer"];
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
    response = await fetch(query ? `/?${query}` : "/", { headers: { Accept: "text/html" }, signal });
  } catch (cause) {
    if (cause.name === "AbortError") throw cause;
    throw new Problem({
      title: "The server does not answer", detail: 'Is "sunatlas serve" still running?',
    });
  }
  // A refusal is a page, too, with the service's words.
  const page = new DOMParser().parseFromString(await response.text(), "text/html");
  if (page.getElementById("answer")) return page;
  throw new Problem({ title: response.statusText || "Error", status: response.status, detail: "" });
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
    for (const id of PARTS) byId(id).replaceChildren(...page.getElementById(id).childNodes);
  } catch (problem) {
    if (problem.name === "AbortError") return;
    byId("summary").replaceChildren();
    answer.replaceChildren(problemNotice(problem, () => show(query, { ofForm })));
  }
  answer.removeAttribute("aria-busy");
  await drawFlow(query, signal);
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
  history.pushState(null, "", query ? `/?${query}` : "/");
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

/** Require values of an attribute, or no longer where all of them are required. */
function toggle(attribute, values) {
  const query = new URLSearchParams(location.search);
  const now = query.getAll(attribute);
  const off = values.every((value) => now.includes(value));
  query.delete(attribute);
  query.delete("cursor");
  const kept = now.filter((value) => !values.includes(value));
  for (const value of off ? kept : [...kept, ...values]) query.append(attribute, value);
  ask(query.toString());
}

listen();
addEventListener("popstate", () => show(new URLSearchParams(location.search).toString()));
drawFlow(new URLSearchParams(location.search).toString(), undefined, toggle)
  .finally(() => { document.documentElement.dataset.live = "true"; });

let width = innerWidth;
addEventListener("resize", () => {
  if (innerWidth === width) return; // a phone's bars come and go
  width = innerWidth;
  redrawFlow();
});
