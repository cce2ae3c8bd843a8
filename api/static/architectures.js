/* The first level of the answer: architectures, each with its three kinds of evidence. */

import { openedRow, method } from "./calibrations.js";
import { byId, h, segmented } from "./dom.js";
import { sensor } from "./drawings.js";
import { advisedContent, below, evidenceCell, finerContent, KINDS, measuredContent, notProposed, proposedContent } from "./evidence.js";
import { show, sideOf, state } from "./state.js";
import { plural, SORTS, studiesCount } from "./wording.js";

const FIRST = matchMedia("(max-width: 700px)").matches ? 4 : 10;
const NAMED = 2; // studies that a row names

let all = false; // whether rows beyond the first are shown

export function showSort() {
  byId("sort-controls").replaceChildren(h("span", { class: "muted note" }, "Rank by"),
    segmented("Rank by", "sort", SORTS, state.sort, (sort) => show({ sort })));
}

function tag({ task, studies, advised }) {
  const asked = sideOf("task", task) === "include";
  const spoken = `${task}: ${studiesCount(studies)}${advised ? ", advised by the survey" : ""}`;
  return h("li", { class: `tag${advised ? " advised" : ""}${asked ? " asked" : ""}`, title: spoken },
    advised && h("span", { class: "mark", "aria-hidden": true }, "✓"), task,
    h("span", { class: "count", "aria-hidden": true }, String(studies)),
    h("span", { class: "visually-hidden" }, spoken.slice(task.length)));
}

const value = (attribute, name) => h("a", { class: `value${sideOf(attribute, name) === "include" ? " asked" : ""}`, href: `/${attribute}s/${encodeURIComponent(name)}` }, name);

function row(architecture, known) {
  const { rank, detector, mask, tasks, advice, studies, best, measures } = architecture;
  const id = `architecture-${rank}`;
  const detail = h("tr", { class: "detail", id, role: "row", hidden: true });
  const expand = h("button", {
    type: "button", class: "expand", "aria-expanded": false, "aria-controls": id,
    "aria-label": `Calibrations and evidence of ${detector} + ${mask}`,
    onclick: () => {
      if (!detail.firstChild) detail.append(h("td", { colspan: "5", role: "cell" }, openedRow(architecture, known)));
      detail.hidden = !detail.hidden;
      expand.setAttribute("aria-expanded", String(!detail.hidden));
    },
  }, plural(architecture.count, "calibration"));
  const page = h("a", { class: "note", href: `/architectures/${encodeURIComponent(detector)}/${encodeURIComponent(mask)}` }, "Details");
  return [h("tr", { role: "row", class: "architecture" },
    h("td", { role: "cell", class: "rank" }, String(rank)),
    h("td", { role: "cell", class: "design" },
      h("div", { class: "pictured" }, sensor(detector, mask),
        h("strong", {}, value("detector", detector), " + ", value("mask", mask))),
      h("ul", { class: "tags" }, tasks.map(tag)),
      h("div", { class: "marks" }, expand, page, " ", architecture.contradiction && h("span", { class: "against", title: architecture.contradiction }, "literature contradicted"),
      architecture.pareto && h("span", { class: "pareto-mark", title: "No other has both more studies and a lower error" }, "Pareto")),
      measures.filter(({ task }) => task !== "Accuracy").map(({ words }) => below(words))),
    evidenceCell("advised", advisedContent(advice)),
    evidenceCell("proposed", proposedContent(studies, NAMED)),
    evidenceCell("measured", measuredContent(best.measured), finerContent(best.measured),
      best.measured && below(method(best), !best.studies.length && notProposed()))), detail];
}

export function showArchitectures(answer, known, fresh) {
  if (fresh) all = false;
  const body = byId("architectures-body");
  body.removeAttribute("aria-busy");
  if (answer.architectures.length === 0) {
    body.replaceChildren(h("p", { class: "notice" }, "No architecture to rank. Change a requirement."));
    return;
  }
  const shown = all ? answer.architectures : answer.architectures.slice(0, FIRST);
  const heads = [["rank", "Rank"], ["design", "Detector + mask, and tasks"], ...KINDS.map(([kind, label]) => [`kind ${kind}`, label])];
  body.replaceChildren(
    h("table", { class: "stacks architectures", role: "table", "aria-labelledby": "architectures-title" },
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" },
        heads.map(([kind, label]) => h("th", { scope: "col", role: "columnheader", class: kind }, label)))),
      h("tbody", { role: "rowgroup" }, shown.map((a) => row(a, known)))),
    shown.length < answer.architectures.length
      ? h("button", {
        type: "button", class: "more",
        onclick: () => {
          all = true;
          showArchitectures(answer, known, false);
          body.querySelectorAll(".expand")[FIRST]?.focus();
        },
      }, `Show all ${answer.architectures.length} architectures`)
      : "");
}
