/* Calibrations of an architecture with their evidence. */

import { byId, copyable, h, problemNotice } from "./dom.js";
import { advisedContent, below, evidenceCell, KINDS, measuredContent, proposedContent, boardAddress } from "./evidence.js";
import { address, getJson } from "./service.js";
import { question, show, sideOf } from "./state.js";
import { studyEntry } from "./studies.js";
import { ATTRIBUTE_NAMES, degrees, JUDGED_ON, LIMIT_NAMES, LIST_NAMES, plural, quoted, sentence, studiesCount, wide, worded } from "./wording.js";

const NAMED = 4; // studies that a row names

/** Name of the method that was measured, and the survey's labels of its parts. */
export function method({ extractor, compensations, model, measured }) {
  const link = (name) => h("a", { href: `/algorithms/${encodeURIComponent(name)}` }, name);
  const asked = (attribute, name) => sideOf(attribute, name) === "include" && "asked";
  return [measured && h("div", { class: "method" }, link(measured.extractor), " + ", link(measured.model)),
    h("div", { class: measured ? "below" : "" }, "survey: ", h("ol", { class: "labels" },
      h("li", { class: asked("extractor", extractor) }, worded("extractor", extractor)),
      [...compensations, model].map((stage) => h("li", { class: asked("model", stage) }, worded("model", stage)))))];
}

/** Evidence of each requirement: "error, field of view by our measurements". */
function judgedOn(basis) {
  const names = { ...LIMIT_NAMES, ...LIST_NAMES };
  const by = new Map();
  for (const [name, on] of Object.entries(basis)) {
    by.set(on, [...by.get(on) ?? [], names[name]?.subject ?? ATTRIBUTE_NAMES[name].toLowerCase()]);
  }
  return [...by].map(([on, subjects]) => `${subjects.join(", ")} by ${JUDGED_ON[on]}`).join("; ");
}

function elsewhere(others) {
  return others.length > 0 && below("also ", others.map((m, i) => [i > 0 && "; ", `${m.dataset} `,
    h("a", { href: boardAddress(m) }, m.error_deg === null ? "availability below 95 %" : degrees(m.error_deg)),
    m.error_deg !== null && m.field_deg !== null && ` over ${wide(m.field_deg)}`]));
}

function calibrationRow(calibration, architecture, judged) {
  const { rank, measured, studies, advised } = calibration;
  const advice = architecture.advice.filter((a) => advised.includes(a.id));
  return h("tr", { role: "row", class: "calibration" },
    h("td", { role: "cell", class: "rank" }, String(rank)),
    h("td", { role: "cell", class: "design" }, method(calibration),
      rank === architecture.best.rank && measured && h("span", { class: "pareto-mark" }, "lowest error"),
      judged && below(`checked: ${judged}`)),
    evidenceCell("advised", advisedContent(advice)),
    evidenceCell("proposed", proposedContent(studies, NAMED)),
    evidenceCell("measured", measuredContent(measured), elsewhere(calibration.other_datasets)));
}

function calibrationTable(architecture) {
  const { calibrations, best } = architecture;
  const listed = calibrations.some((c) => c.rank === best.rank) ? calibrations : [...calibrations, best];
  const judged = listed.map((c) => judgedOn(c.basis));
  const alike = judged.every((words) => words === judged[0]);
  return [alike && judged[0] && h("p", { class: "muted note" }, `Requirements checked: ${judged[0]}.`),
    h("table", { class: "stacks calibrations", role: "table", "aria-label": `Calibrations of ${architecture.detector} + ${architecture.mask}` },
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" },
        [["rank", "Rank"], ["design", "Method (survey labels)"], ...KINDS.map(([kind, label]) => [`kind ${kind}`, label])].map(([kind, label]) =>
          h("th", { scope: "col", role: "columnheader", class: kind }, label)))),
      h("tbody", { role: "rowgroup" }, listed.map((c, i) => calibrationRow(c, architecture, !alike && judged[i]))))];
}

/** First calibrations, with a button that loads all. */
function calibrations(architecture) {
  const { detector, mask, count } = architecture;
  const place = h("div", { class: "calibrations-body" }, calibrationTable(architecture));
  if (architecture.calibrations.length === count) return place;
  const button = h("button", {
    type: "button", class: "more",
    onclick: async () => {
      button.disabled = true;
      try {
        const asked = address("/v1/recommendations", { ...question(), detector, mask, limit: 500, calibrations: 500 });
        const found = (await getJson(asked)).architectures.find((a) => a.detector === detector && a.mask === mask);
        place.replaceChildren(h("div", {}, calibrationTable({ ...architecture, calibrations: found.calibrations })));
      } catch (problem) {
        button.disabled = false;
        place.querySelector(".notice")?.remove();
        place.append(problemNotice(problem));
      }
    },
  }, `Show all ${count} calibrations`);
  place.append(button);
  return place;
}

/** Advice of the survey: models and extractors by name. */
function adviceList(advice) {
  const by = new Map();
  for (const a of advice) {
    const what = `${a.requirement === "task" ? a.value : `class ${a.value}`}`;
    const how = [a.model_category && `${a.model_category} model`, a.extractor].filter(Boolean).join(", ") || "any calibration";
    const known = by.get(what) ?? { how: [], notes: new Set() };
    known.how.push(how);
    if (a.note) known.notes.add(a.note);
    by.set(what, known);
  }
  return h("ul", { class: "plain-list" }, [...by].map(([what, { how, notes }]) => h("li", {},
    h("strong", {}, what), `: ${how.join("; or ")}`, notes.size > 0 && h("span", { class: "muted" }, ` (${[...notes].join("; ")})`))));
}

function studyList(keys, studies) {
  const disclosure = h("details", { class: "flow-links" }, h("summary", {}, `${studiesCount(keys.length)} used it, with the basis of each value`));
  disclosure.addEventListener("toggle", () => disclosure.append(
    h("ul", { class: "study-list" }, keys.map((key) => studyEntry(key, studies.get(key))))), { once: true });
  return disclosure;
}

function measureAgain({ measured }, studies, keys) {
  const key = keys.find((k) => studies.get(k)?.grade !== "none");
  return h("div", { class: "note plain-list" },
    measured && h("p", {}, "Measure the best again: ",
      copyable(`sunatlas benchmark --dataset ${measured.dataset} --extractor ${measured.extractor} --model ${quoted(measured.model)}`, "the command that measures the best calibration"), " ",
      h("button", { type: "button", class: "linklike", onclick: () => {
        show({ dataset: measured.dataset, board_condition: measured.condition });
        byId("leaderboard").focus();
        byId("leaderboard").scrollIntoView();
      } }, "Show in leaderboard")),
    key && h("p", {}, "Run a study: ", copyable(`sunatlas run ${key} --format json`, `the command that runs ${key}`)));
}

/** Details of an architecture, shown when its row is opened. */
export function openedRow(architecture, studies) {
  const { advice, contradiction, best, count, detector, mask, studies: keys } = architecture;
  return h("div", { class: "evidence" },
    contradiction && h("p", { class: "contradiction" }, h("strong", {}, "Measurement contradicts literature: "), sentence(contradiction)),
    h("div", {}, h("h3", {}, `${plural(count, "calibration")} of ${detector} + ${mask}`), calibrations(architecture)),
    advice.length > 0 && h("div", {}, h("h3", {}, "Advice of the survey"), adviceList(advice)),
    keys.length > 0 && studyList(keys, studies),
    measureAgain(best, studies, keys));
}
