/* The requirements as one sentence with removable parts, and a summary of the answer. */

import { byId, copyable, h } from "./dom.js";
import { address, saveCsv } from "./service.js";
import { ATTRIBUTES, LIMITS, LISTS, question, requirements, set, setLimit, setListed, setRequirements, show, state } from "./state.js";
import { ATTRIBUTE_NAMES, LIMIT_NAMES, limitText, LIST_NAMES, plural, quoted, sentence, studiesCount } from "./wording.js";

/** Architectures and calibrations of an answer that is handed on. */
const MOST = { limit: 500, calibrations: 500 };
const SPREADSHEET = { format: "csv", safe: true };

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
    if (state.limits[limit] === "") continue;
    const { words } = LIMIT_NAMES[limit];
    const label = limitText(limit, state.limits[limit]);
    clauses.push([`${words} `, chip(label, `${words} ${label}`, () => setLimit(limit, ""))]);
  }
  for (const list of LISTS) {
    const { words } = LIST_NAMES[list];
    if (!state.lists[list].length) continue;
    clauses.push([`${words} `, ...between(state.lists[list].map((value) =>
      chip(value, `${words} ${value}`, () => setListed(list, value, false))), "and")]);
  }
  byId("question").replaceChildren(clauses.length
    ? h("p", { class: "question" }, "Requirements: ", clauses.map((clause, i) => [clause, i < clauses.length - 1 ? ", " : "."]))
    : h("p", { class: "muted" }, "No requirements yet: all architectures are shown. Choose requirements, or select a value in the decision flow."));
}

/** studies: how many are mapped in all. */
export function showSummary(answer, studies) {
  const backing = new Set(answer.architectures.flatMap((a) => a.studies));
  const measured = answer.architectures.filter((a) => a.best.measured).length;
  byId("summary").replaceChildren(...(answer.count === 0 ? [h("strong", {}, "0 architectures"), " meet all requirements."] : [
    h("strong", {}, plural(answer.count, "architecture")), " with ",
    h("strong", {}, plural(answer.designs, "calibration")), ", used in ",
    h("strong", {}, studiesCount(backing.size)), ` of ${studies}; `,
    h("strong", {}, String(measured)), " of the architectures measured here."]));
  const url = address("/v1/recommendations", { ...question(), ...MOST });
  byId("answer-links").replaceChildren(
    h("a", { href: url }, "This answer as JSON"),
    h("button", { type: "button", onclick: () => saveCsv(url, "recommendations.csv") }, "as CSV"),
    h("a", { href: address("/v1/recommendations", { ...question(), ...MOST, ...SPREADSHEET }) }, "as CSV for spreadsheets"),
    copyable(commandLine(question()), "the command line of this answer"));
}

/** The same question to the command line. */
export function commandLine(asked) {
  const options = Object.entries(asked).filter(([, value]) => value !== null).flatMap(([name, value]) =>
    [value].flat().map((v) => `--${name.replaceAll("_", "-")} ${quoted(v)}`));
  return ["sunatlas recommend", ...options].join(" ");
}

/** Contradictions between kinds of evidence, accuracy lost by the ranking, and untested conditions. */
export function showFindings(answer) {
  const { contradictions, regret, untimed, untried } = answer;
  const best = regret?.ratio === 1;
  byId("findings").replaceChildren(...[
    ...contradictions.map((text) => finding("Measurement contradicts advice", sentence(text))),
    regret && finding(`Accuracy lost by this ranking${best ? ": none" : ""}`, sentence(regret.sentence),
      !best && h("button", { type: "button", onclick: () => {
        show({ sort: "measured" });
        byId("architectures").focus();
      } }, "Rank by measurement")),
    untimed > 0 && finding("Not timed", `${plural(untimed, "pipeline")} without a time on this machine; the latency limit excludes them. Run \`sunatlas leaderboard times\`, then restart the service.`),
    ...Object.entries(untried).filter(([, pairs]) => pairs.length).map(([hazard, pairs]) => notTried(hazard, pairs)),
  ].filter(Boolean));
}

const finding = (title, ...content) => h("div", { class: "finding" }, h("h2", {}, title), h("p", {}, ...content.flatMap((c) => [c, " "])));

function notTried(hazard, pairs) {
  const named = pairs.map(({ detector, mask }) => `${detector} + ${mask}`).join(", ");
  const title = `Not tested: ${hazard}`;
  const lead = `No data set tests ${hazard} on `;
  if (pairs.length <= 4) return finding(title, `${lead}${named}; the answer excludes them.`);
  return h("div", { class: "finding" }, h("h2", {}, title),
    h("details", { class: "flow-links" }, h("summary", {}, `${lead}${plural(pairs.length, "architecture")}; the answer excludes them.`), h("p", {}, `${named}.`)));
}

/** Requirements as the form names them, where the service has their parameters. */
function constraintWords(constraint) {
  const name = (key) => (key.startsWith("exclude_") ? `not that ${ATTRIBUTE_NAMES[key.slice(8)].toLowerCase()}`
    : (LIMIT_NAMES[key] ?? LIST_NAMES[key])?.words ?? ATTRIBUTE_NAMES[key]?.toLowerCase() ?? key);
  return constraint ? constraint.split(/(\W+)/).map((part) => (/^\w+$/.test(part) ? name(part) : part)).join("") : "there are no designs";
}

/** Why no architecture meets the requirements, and which changes would help. */
export function showBlocked(blocked, relax) {
  byId("blocked").replaceChildren(...(blocked ? [h("div", { class: "notice" },
    h("p", {}, h("strong", {}, "No architecture meets these requirements. "), sentence(blocked.detail)),
    h("p", {}, "Requirement that excludes all: ", h("strong", { class: "culprit" }, constraintWords(blocked.constraint))),
    blocked.relaxations.length > 0 && h("p", { id: "relax-title" }, "Changes that give results:"),
    blocked.relaxations.length > 0 && h("div", { class: "relaxations", role: "group", "aria-labelledby": "relax-title" },
      blocked.relaxations.map((r) => h("button", {
        type: "button", class: "relaxation",
        onclick: () => {
          relax(r);
          byId("answer").focus();
        },
      }, `${sentence(r.words).slice(0, -1)} → ${plural(r.architectures, "architecture")}`))))] : []));
}

/** The requirements with a relaxation applied. */
export function relax({ drop, change }) {
  setRequirements({ ...requirements(), ...Object.fromEntries(Object.keys(drop ?? {}).map((c) => [c, []])), ...change });
}
