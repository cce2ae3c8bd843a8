/* The ranked paths: literature support and measured performance, each with its evidence. */

import { byId, choice, copyable, h } from "./dom.js";
import { address } from "./service.js";
import { show, standing, state } from "./state.js";
import { studyEntry } from "./studies.js";
import { degrees, LIMIT_NAMES, number, percent, plural, times } from "./wording.js";

const FIRST = 12;
const COLUMNS = ["Rank", "Path", "Literature support", "Measured here", ""]; // the last holds buttons
const CHAIN = ["task", "detector", "mask", "model", "extractor"];

let all = false; // whether rows beyond the first are shown

export function showPathsControls(conditions) {
  byId("paths-controls").replaceChildren(conditions.length > 1
    ? choice("Measured under", "condition", conditions.map((c) => [c, c]), state.condition, (condition) => show({ condition }))
    : "");
}

const cell = (label, extra, ...content) => h("td", { role: "cell", "data-label": label, ...extra }, ...content);

function scoreAddress(m) {
  return address("/v1/results", { dataset: m.dataset, condition: m.condition, extractor: m.extractor, model: m.model });
}

function measuredCell(m) {
  if (!m) return h("span", { class: "muted" }, "not measured");
  return [
    h("a", { href: scoreAddress(m), title: "The score row" }, `${degrees(m.rms_deg)} RMS`),
    h("div", { class: "below" }, `${times(m.over_bound)} the bound`),
    h("div", { class: "below" }, m.dataset),
  ];
}

function measuredEvidence(m) {
  if (!m) return h("p", { class: "muted" }, "No pipeline of this path is scored on a standard data set of its architecture in this condition.");
  return h("div", {}, h("h3", {}, "Measured"), h("dl", { class: "facts" }, [
    ["Data set", h("a", { href: address("/v1/datasets"), title: "Its card" }, m.dataset)],
    ["Condition", m.condition], ["Pipeline", `${m.extractor} → ${m.model}`],
    ["RMS error", degrees(m.rms_deg)], ["Cramér–Rao bound", degrees(m.bound_deg)], ["Times the bound", times(m.over_bound)],
    ["Answered", percent(m.availability)], ["False Suns", percent(m.false_sun)],
    ["Half field of view", degrees(m.half_fov_deg)],
    ["Latency a sample", number(m.latency_us) === "–" ? "–" : `${number(m.latency_us)} µs`],
  ].map(([term, value]) => h("div", {}, h("dt", {}, term), h("dd", {}, value)))),
  h("p", { class: "links" }, h("a", { href: scoreAddress(m) }, "Score row (JSON)"),
    h("button", { type: "button", onclick: () => {
      show({ dataset: m.dataset, board_condition: m.condition });
      byId("leaderboard").focus();
      byId("leaderboard").scrollIntoView();
    } }, "Show in the leaderboard")));
}

/** How the support comes about, and on what each limit was judged. */
function support(path) {
  const { studies, with_model: model, architecture } = path.literature;
  if (architecture === undefined) return null;
  const judged = Object.entries(path.basis ?? {}).map(([limit, basis]) =>
    `${LIMIT_NAMES[limit].name.toLowerCase()} judged on what is ${basis === "stated" ? "stated by the studies" : "measured here"}`);
  return h("p", { class: "note" }, `Support ${number(path.literature.support)} is the geometric mean of `
    + `${plural(architecture, "study", "studies")} with this task, detector and mask, ${model} that also used the model, `
    + `and ${studies} on the whole path.`, judged.length > 0 && ` Limits: ${judged.join("; ")}.`);
}

function row(path, studies) {
  const id = `path-${path.rank}`;
  const detail = h("tr", { class: "detail", id, role: "row", hidden: true });
  const words = CHAIN.map((level) => path[level]).join(", ");
  const expand = h("button", {
    type: "button", class: "expand", "aria-expanded": false, "aria-controls": id,
    "aria-label": `Evidence of path ${path.rank}: ${words}`,
    onclick: () => {
      const open = detail.hidden;
      if (open && !detail.firstChild) {
        const key = path.studies.find((k) => studies.get(k)?.state !== "none");
        detail.append(h("td", { colspan: String(COLUMNS.length), role: "cell" }, h("div", { class: "evidence" },
          h("div", {}, h("h3", {}, `Literature: ${plural(path.studies.length, "study", "studies")}`),
            h("ul", { class: "study-list" }, path.studies.map((k) => studyEntry(k, studies.get(k))))),
          support(path), measuredEvidence(path.measured),
          key && h("p", { class: "note" }, "Run it yourself: ", copyable(`sunatlas run ${key} --format json`, `the command that runs ${key}`)))));
      }
      detail.hidden = !open;
      expand.setAttribute("aria-expanded", String(open));
    },
  }, "Evidence");
  return [h("tr", { role: "row", class: "path" },
    cell("Rank", { class: "number" }, h("span", {}, String(path.rank)), path.pareto && h("div", {}, h("span", { class: "pareto-mark" }, "Pareto"))),
    h("td", { role: "cell" }, h("ol", { class: "pathway" }, CHAIN.map((level) =>
      h("li", {}, h("span", { class: standing(level, path[level]) === "include" && "asked" }, path[level]))))),
    cell("Literature support", { class: "number" }, h("strong", {}, number(path.literature.support)),
      h("div", { class: "below" }, plural(path.literature.studies, "study", "studies"))),
    cell("Measured here", { class: "number" }, measuredCell(path.measured)),
    h("td", { role: "cell", class: "number" }, expand)), detail];
}

export function showPaths(answer, studies, fresh) {
  if (fresh) all = false;
  const body = byId("paths-body");
  body.removeAttribute("aria-busy");
  if (answer.paths.length === 0) {
    body.replaceChildren(h("p", { class: "notice" }, "No path to rank: see above what would leave something."));
    return;
  }
  const shown = all ? answer.paths : answer.paths.slice(0, FIRST);
  body.replaceChildren(
    h("table", { class: "stacks paths", role: "table", "aria-labelledby": "paths-title" },
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, COLUMNS.map((name, i) =>
        h("th", { scope: "col", role: "columnheader", class: i !== 1 && "number" }, name || h("span", { class: "visually-hidden" }, "Evidence"))))),
      h("tbody", { role: "rowgroup" }, shown.map((p) => row(p, studies)))),
    shown.length < answer.paths.length
      ? h("button", {
        type: "button", class: "more",
        onclick: () => {
          all = true;
          showPaths(answer, studies, false);
          body.querySelectorAll(".expand")[FIRST]?.focus();
        },
      }, `Show all ${answer.paths.length} paths`)
      : "");
}
