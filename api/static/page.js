/* The page: asks the service, hands what it says to the parts, follows the state. */

import { relax, showBlocked, showFindings, showQuestion, showSummary } from "./answer.js";
import { showArchitectures, showSort } from "./architectures.js";
import { byId, h, problemNotice } from "./dom.js";
import { clearDrawings, fetchDrawings, keepDrawings, showScatterControls } from "./drawings.js";
import { CROSS, showFlow, showFlowControls } from "./flow.js";
import { followAnswer, resort, showLeaderboard } from "./leaderboard.js";
import { buildRequirements, updateRequirements } from "./requirements.js";
import { address, getAll, getJson } from "./service.js";
import { ATTRIBUTES, onChange, question, state } from "./state.js";
import { explain, tips } from "./terms.js";
import { Vocabulary } from "./wording.js";

const ASKED = { limit: 500, calibrations: 5 }; // an opened row asks for more calibrations
const BODIES = ["architectures-body", "flow-body"];
const known = { vocabulary: null, studies: new Map(), datasets: [] };
let answer = null;
let asking = null;
let first = true; // the server has drawn the answer that the page came with

/** Values of each attribute that occur in the answer: in its architectures and on its studies' paths. */
function present(of) {
  const found = Object.fromEntries(ATTRIBUTES.map((a) => [a, new Set()]));
  for (const node of of.nodes) {
    if (CROSS.includes(node.level)) found[node.level].add(node.value);
    for (const key of node.studies) {
      for (const a of ["accuracy", "error"]) known.studies.get(key)?.values[a]?.forEach((v) => found[a].add(v));
    }
  }
  for (const { detector, mask, calibrations, best } of of.architectures) {
    found.detector.add(detector);
    found.mask.add(mask);
    for (const { extractor, compensations, model } of [...calibrations, best]) {
      found.extractor.add(extractor);
      [...compensations, model].forEach((stage) => found.model.add(stage));
    }
  }
  return of.count ? found : null;
}

async function ask() {
  asking?.abort();
  asking = new AbortController();
  const { signal } = asking;
  showQuestion(known.vocabulary);
  updateRequirements(null);
  for (const id of BODIES) {
    byId(id).setAttribute("aria-busy", "true");
    byId(id).classList.add("stale");
  }
  try {
    const drawn = first ? null : fetchDrawings(signal);
    answer = await getJson(address("/v1/recommendations", { ...question(), ...ASKED }), signal);
    await drawn;
    first = false;
    showSummary(answer, known.studies.size);
    showFindings(answer);
    showBlocked(answer.blocked, relax);
    updateRequirements(present(answer));
    showArchitectures(answer, known.studies, true);
    byId("architectures-body").classList.remove("stale");
    followAnswer(answer, known.datasets);
    for (const id of ["findings", "architectures-body"]) explain(byId(id));
    await showFlow(answer, known.vocabulary, known.studies.size, signal);
  } catch (problem) {
    if (problem.name === "AbortError") return;
    answer = null;
    first = false;
    clearDrawings();
    byId("summary").textContent = "";
    for (const id of ["answer-links", "findings"]) byId(id).replaceChildren();
    byId("blocked").replaceChildren(problemNotice(problem, ask));
    for (const id of BODIES) {
      byId(id).replaceChildren(h("p", { class: "muted" }, "No answer: the request failed."));
      byId(id).removeAttribute("aria-busy");
      byId(id).classList.remove("stale");
    }
  }
}

function redrawFlow() {
  if (answer) showFlow(answer, known.vocabulary, known.studies.size, asking?.signal);
}

const BOARD = ["dataset", "board_condition", "board_field"];
const FLOW = ["chart", "counting", "detail", "view"];
const any = (changed, names) => names.some((n) => changed.has(n));

/** Make controls anew; the keyboard stays where it was. */
function renewed(make) {
  const { name, id } = document.activeElement ?? {};
  make();
  const again = name ? document.querySelector(`.controls [name="${name}"]:checked`) : id === "chart" && byId("chart");
  again?.focus?.();
}

function follow(changed) {
  if (any(changed, FLOW)) renewed(showFlowControls);
  if (changed.has("sort")) renewed(showSort);
  if (any(changed, ["requirements", "sort"])) ask();
  else if (any(changed, FLOW)) redrawFlow();
  if (changed.has("across")) {
    renewed(showScatterControls);
    if (!any(changed, ["requirements", "sort"])) fetchDrawings();
  }
  if (any(changed, BOARD)) {
    const focused = document.activeElement?.id;
    showLeaderboard(known.datasets);
    if (["dataset", "board-condition", "board-field"].includes(focused)) byId(focused)?.focus();
  } else if (any(changed, ["board_sort", "board_order"])) resort();
}

function countValues(studies) {
  const counts = new Map();
  for (const study of studies) {
    for (const [attribute, values] of Object.entries(study.values)) {
      for (const value of new Set(values)) {
        counts.set(`${attribute}:${value}`, (counts.get(`${attribute}:${value}`) ?? 0) + 1);
      }
    }
  }
  return counts;
}

async function showProvenance() {
  const health = await getJson("/healthz");
  byId("provenance").textContent = `Version ${health.version}: ${health.studies} mapped studies (the survey states 128 and cites 129 keys), `
    + `${health.datasets} data sets, ${health.scores} scores.`;
}

async function start() {
  // What the server has drawn stands until it can be followed.
  for (const id of [...BODIES, "board-body"]) byId(id).setAttribute("aria-busy", "true");
  if (first) keepDrawings();
  byId("blocked").replaceChildren();
  showFlowControls();
  showScatterControls();
  showSort();
  try {
    const [taxonomy, studies] = await Promise.all([
      getJson("/v1/taxonomy"), getAll("/v1/studies", { limit: 500, ...(state.edition === "all" && { edition: "all" }) }),
    ]);
    known.vocabulary = new Vocabulary(taxonomy.attributes);
    known.studies = new Map(studies.map((s) => [s.key, s]));
    buildRequirements(known.vocabulary, countValues(studies));
  } catch (problem) {
    for (const id of ["requirements-form", ...BODIES]) {
      byId(id).replaceChildren(h("p", { class: "muted" }, "Not loaded."));
      byId(id).removeAttribute("aria-busy");
    }
    byId("blocked").replaceChildren(problemNotice(problem, start));
    return;
  }
  onChange(follow);
  showProvenance().catch(() => { byId("provenance").textContent = "The survey states 128 studies and cites 129 keys."; });
  const asked = ask();
  try {
    known.datasets = await getAll("/v1/datasets", { limit: 500 });
    await asked;
    followAnswer(answer, known.datasets);
    await showLeaderboard(known.datasets);
    explain(byId("board-card"));
  } catch (problem) {
    byId("board-body").removeAttribute("aria-busy");
    byId("board-body").replaceChildren(problemNotice(problem));
  }
}

/** On a phone the panel is closed at first: the answer comes before the controls. */
function foldRequirements() {
  const [panel, toggle] = [byId("requirements"), byId("requirements-toggle")];
  toggle.hidden = false;
  toggle.addEventListener("click", () => {
    const open = panel.classList.toggle("open");
    toggle.setAttribute("aria-expanded", String(open));
    toggle.textContent = open ? "Close" : "Change";
  });
}

foldRequirements();
tips(document);
start().finally(() => { document.documentElement.dataset.live = "true"; });

let width = innerWidth;
addEventListener("resize", () => {
  if (innerWidth === width) return; // a phone's bars come and go
  width = innerWidth;
  redrawFlow();
});
