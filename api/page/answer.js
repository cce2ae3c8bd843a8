/* What is asked, in one sentence whose parts can be taken out again, and what came of it. */

import { byId, copyable, h } from "./dom.js";
import { address, saveCsv } from "./service.js";
import { ATTRIBUTES, LIMITS, requirements, set, setLimit, state } from "./state.js";
import { ATTRIBUTE_NAMES, LIMIT_NAMES, plural } from "./wording.js";

function chip(label, spoken, remove, not) {
  return h("button", {
    type: "button", class: not ? "chip not" : "chip", "aria-label": `Remove the requirement: ${spoken}`,
    onclick: () => {
      remove();
      // The chip is gone; keep the keyboard's place at the answer.
      byId("answer").focus();
    },
  }, label, h("span", { class: "x", "aria-hidden": true }, "×"));
}

function between(nodes, word) {
  return nodes.flatMap((node, i) => (i ? [` ${word} `, node] : [node]));
}

export function showQuestion(vocabulary) {
  const clauses = [];
  for (const attribute of ATTRIBUTES) {
    const subject = ATTRIBUTE_NAMES[attribute].toLowerCase();
    const wanted = vocabulary.gathered(attribute, state.include[attribute]);
    if (wanted.length) {
      clauses.push([`${subject} `, ...between(wanted.map(([label, values]) =>
        chip(label, `${subject} ${label}`, () => set(attribute, values, null))), "or")]);
    }
    if (state.exclude[attribute].length) {
      clauses.push([`${subject} not `, ...between(state.exclude[attribute].map((value) =>
        chip(value, `${subject} not ${value}`, () => set(attribute, value, null), true)), "nor")]);
    }
  }
  for (const limit of LIMITS) {
    const { words, unit } = LIMIT_NAMES[limit];
    if (state.limits[limit] === "") continue;
    const label = `${state.limits[limit]} ${unit}`.replace(" °", "°");
    clauses.push([`${words} `, chip(label, `${words} ${label}`, () => setLimit(limit, ""))]);
  }
  byId("question").replaceChildren(clauses.length
    ? h("p", { class: "question" }, "Asked for: ", clauses.map((clause, i) =>
      h("span", { class: "question" }, clause, i < clauses.length - 1 ? "," : "")))
    : h("p", { class: "muted" }, "Nothing is required yet: every path of the survey is shown. Choose requirements, or select a value in the flow."));
}

/** studies: how many are mapped in all. */
export function showSummary(answer, studies) {
  const used = new Set(answer.nodes.flatMap((n) => n.studies));
  const measured = answer.paths.filter((p) => p.measured).length;
  byId("summary").replaceChildren(
    h("strong", {}, plural(answer.count, "path")), " from ",
    h("strong", {}, plural(used.size, "study", "studies")), ` of ${studies} mapped; `,
    h("strong", {}, String(measured)), answer.count > answer.paths.length
      ? ` of the first ${answer.paths.length} measured here.` : " of them measured here.");
  const asked = requirements();
  const url = address("/v1/recommendations", { ...asked, condition: state.condition, limit: 500 });
  byId("answer-links").replaceChildren(
    h("a", { href: url }, "This answer as JSON"),
    h("button", { type: "button", onclick: () => saveCsv(url, "recommendations.csv") }, "as CSV"),
    copyable(commandLine(asked), "the command line of this answer"));
}

/** The same question to the command line. */
export function commandLine(asked) {
  const quoted = (v) => (/^[\w.+-]+$/.test(v) ? v : `'${v}'`);
  const options = Object.entries(asked).flatMap(([name, value]) =>
    [value].flat().map((v) => `--${name.replaceAll("_", "-")} ${quoted(v)}`));
  return ["sunatlas recommend", ...options].join(" ");
}

/** Why nothing is left, and what would leave something. */
export function showBlocked(blocked, relax) {
  byId("blocked").replaceChildren(...(blocked ? [h("div", { class: "notice" },
    h("p", {}, h("strong", {}, "No path meets these requirements. "), blocked.detail),
    h("p", {}, "The constraint that leaves nothing: ", h("code", { class: "culprit" }, blocked.constraint)),
    blocked.relaxations.length > 0 && h("p", { id: "relax-title" }, "What would leave something:"),
    blocked.relaxations.length > 0 && h("div", { class: "relaxations", role: "group", "aria-labelledby": "relax-title" },
      blocked.relaxations.map((r) => h("button", {
        type: "button", class: "relaxation",
        onclick: () => {
          relax(r);
          byId("answer").focus();
        },
      }, `${relaxationWords(r)} → ${plural(r.paths, "path")}`))))] : []));
}

function relaxationWords(relaxation) {
  const { constraint, drop, change } = relaxation;
  const limit = LIMIT_NAMES[constraint];
  if (limit && typeof change === "number") return `${limit.name}: ${change} ${limit.unit}`.replace(" °", "°");
  if (limit) return `Drop “${limit.words}”`;
  const excluded = constraint.startsWith("exclude_");
  const attribute = constraint.replace("exclude_", "");
  const values = Array.isArray(drop) ? drop.join(" or ") : typeof drop === "string" ? drop : "";
  const subject = (ATTRIBUTE_NAMES[attribute] ?? attribute).toLowerCase();
  if (Array.isArray(change) || typeof change === "string") return `${excluded ? "Exclude" : "Ask for"} ${subject} ${[change].flat().join(" or ")}`;
  return excluded ? `Allow ${subject} ${values}` : `Drop ${subject} ${values}`.trim();
}

/** Apply a relaxation to the state. */
export function relax({ constraint, drop, change }) {
  if (constraint in LIMIT_NAMES) {
    setLimit(constraint, typeof change === "number" ? String(change) : "");
    return;
  }
  const attribute = constraint.replace("exclude_", "");
  const where = constraint.startsWith("exclude_") ? "exclude" : "include";
  const values = Array.isArray(drop) || typeof drop === "string" ? [drop].flat() : state[where][attribute];
  if (change !== undefined && change !== null) set(attribute, [change].flat(), where);
  else set(attribute, [...values], null);
}
