/* What is asked, in one sentence whose parts can be taken out again, and what came of it. */

import { byId, copyable, h } from "./dom.js";
import { address, saveCsv } from "./service.js";
import { ATTRIBUTES, LIMITS, measuredCondition, requirements, set, setLimit, setRequirements, state } from "./state.js";
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
    ? h("p", { class: "question" }, "Asked for: ", clauses.map((clause, i) => [clause, i < clauses.length - 1 ? ", " : "."]))
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
  const url = address("/v1/recommendations", { ...asked, condition: measuredCondition(), limit: 500 });
  byId("answer-links").replaceChildren(
    h("a", { href: url }, "This answer as JSON"),
    h("button", { type: "button", onclick: () => saveCsv(url, "recommendations.csv") }, "as CSV"),
    copyable(commandLine(measuredCondition() ? { ...asked, condition: measuredCondition() } : asked), "the command line of this answer"));
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
    h("p", {}, h("strong", {}, "No path meets these requirements. "), `${blocked.detail.charAt(0).toUpperCase()}${blocked.detail.slice(1)}.`),
    h("p", {}, "The constraint that leaves nothing: ", h("code", { class: "culprit" }, blocked.constraint || "none: no study has a value at every level")),
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

/** One constraint of a relaxation in words; asked: the values or the bound. */
function constraintWords(constraint, asked, verb) {
  const limit = LIMIT_NAMES[constraint];
  if (limit) return `${limit.words} ${asked} ${limit.unit}`.replace(" °", "°");
  const excluded = constraint.startsWith("exclude_");
  const attribute = constraint.replace("exclude_", "");
  const subject = `${(ATTRIBUTE_NAMES[attribute] ?? attribute).toLowerCase()} ${[asked].flat().join(" or ")}`;
  if (excluded) return `${verb === "change" ? "only " : ""}the exclusion of ${subject}`;
  return subject;
}

function relaxationWords({ drop, change }) {
  const verb = drop ? "drop" : "change";
  const words = Object.entries(drop ?? change ?? {}).map(([c, asked]) => constraintWords(c, asked, verb));
  return `${verb === "drop" ? "Drop" : "Ask instead for"} ${words.join(" and ")}`;
}

/** The requirements with a relaxation applied. */
export function relax({ drop, change }) {
  setRequirements({ ...requirements(), ...Object.fromEntries(Object.keys(drop ?? {}).map((c) => [c, []])), ...change });
}
