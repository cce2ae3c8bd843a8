/* The page: asks the service, hands what it says to the parts, follows the state. */

import { relax, showBlocked, showQuestion, showSummary } from "./answer.js";
import { byId, h, problemNotice } from "./dom.js";
import { CROSS, showFlow, showFlowControls } from "./flow.js";
import { resort, showLeaderboard } from "./leaderboard.js";
import { showPaths, showPathsControls } from "./paths.js";
import { buildRequirements, updateRequirements } from "./requirements.js";
import { address, getAll, getJson } from "./service.js";
import { ATTRIBUTES, measuredCondition, onChange, requirements, state } from "./state.js";
import { Vocabulary } from "./wording.js";

const MOST_PATHS = 500;
const known = { vocabulary: null, studies: new Map(), datasets: [] };
let answer = null;
let asking = null;

/** Values of each attribute that occur in the answer: by path for the chain, by study for the rest. */
function present(of) {
  const found = Object.fromEntries(ATTRIBUTES.map((a) => [a, new Set()]));
  for (const node of of.nodes) {
    if (CROSS.includes(node.level)) found[node.level].add(node.value);
    for (const key of node.studies) {
      for (const a of ["accuracy", "error"]) known.studies.get(key)?.values[a]?.forEach((v) => found[a].add(v));
    }
  }
  return of.nodes.length ? found : null;
}

async function ask() {
  asking?.abort();
  asking = new AbortController();
  const { signal } = asking;
  showQuestion(known.vocabulary);
  updateRequirements(null);
  for (const id of ["flow-body", "paths-body"]) {
    byId(id).setAttribute("aria-busy", "true");
    byId(id).classList.add("stale");
  }
  try {
    answer = await getJson(address("/v1/recommendations", { ...requirements(), condition: measuredCondition(), limit: MOST_PATHS }), signal);
    showSummary(answer, known.studies.size);
    showBlocked(answer.blocked, relax);
    updateRequirements(present(answer));
    showPaths(answer, known.studies, true);
    byId("paths-body").classList.remove("stale");
    await showFlow(answer, known.vocabulary, known.studies.size, signal);
  } catch (problem) {
    if (problem.name === "AbortError") return;
    answer = null;
    byId("summary").textContent = "";
    byId("answer-links").replaceChildren();
    byId("blocked").replaceChildren(problemNotice(problem, ask));
    for (const id of ["flow-body", "paths-body"]) {
      byId(id).replaceChildren(h("p", { class: "muted" }, "Nothing to show: the question was not answered."));
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

function follow(changed) {
  if (any(changed, FLOW)) {
    const focused = document.activeElement;
    showFlowControls();
    // The controls are new elements; the keyboard stays where it was.
    const again = focused?.name
      ? byId("flow-controls").querySelector(`[name="${focused.name}"]:checked`)
      : focused?.id === "chart" && byId("chart");
    again?.focus?.();
  }
  if (any(changed, ["requirements", "condition"])) ask();
  else if (any(changed, FLOW)) redrawFlow();
  if (any(changed, BOARD)) {
    const focused = document.activeElement?.id;
    showLeaderboard(known.datasets);
    if (["dataset", "board-condition", "board-field"].includes(focused)) byId(focused)?.focus();
  } else if (any(changed, ["sort", "order"])) resort();
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
  for (const id of ["flow-body", "paths-body"]) byId(id).replaceChildren(h("p", { class: "loading" }, "Loading…"));
  byId("blocked").replaceChildren();
  showFlowControls();
  try {
    const [taxonomy, studies] = await Promise.all([
      getJson("/v1/taxonomy"), getAll("/v1/studies", { limit: 500 }),
    ]);
    known.vocabulary = new Vocabulary(taxonomy.attributes);
    known.studies = new Map(studies.map((s) => [s.key, s]));
    buildRequirements(known.vocabulary, countValues(studies));
  } catch (problem) {
    for (const id of ["requirements-form", "flow-body", "paths-body"]) {
      byId(id).replaceChildren(h("p", { class: "muted" }, "Not loaded."));
      byId(id).removeAttribute("aria-busy");
    }
    byId("blocked").replaceChildren(problemNotice(problem, start));
    return;
  }
  onChange(follow);
  showProvenance().catch(() => { byId("provenance").textContent = "The survey states 128 studies and cites 129 keys."; });
  const board = getAll("/v1/datasets", { limit: 500 }).then((datasets) => {
    known.datasets = datasets;
    const conditions = [...new Set(["nominal", ...datasets.flatMap((d) => d.conditions)])];
    showPathsControls(conditions);
    return showLeaderboard(datasets);
  }).catch((problem) => {
    byId("board-body").removeAttribute("aria-busy");
    byId("board-body").replaceChildren(problemNotice(problem));
  });
  await Promise.all([ask(), board]);
  document.addEventListener("themechange", redrawFlow);
}

start();
