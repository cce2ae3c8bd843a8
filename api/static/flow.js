/* The decision flow: which chart, how it is counted, drawn and as lists and a table. */

import { byId, choice, h, problemNotice, segmented } from "./dom.js";
import { attributeOf, fractional, grouped, rings, withAmounts } from "./flow_data.js";
import { drawSankey, drawSunburst, labelRoom } from "./flow_diagram.js";
import { address, getJson } from "./service.js";
import { ATTRIBUTES, LIMITS, LISTS, set, show, sideOf, state } from "./state.js";
import { amount, ATTRIBUTE_NAMES, plural, worded } from "./wording.js";

export const CROSS = ["task", "detector", "mask", "model", "extractor"];
const CHARTS = [
  ["cross-analysis", "Cross-analysis"], ["error", "Errors"], ["performance", "Performance"],
  ["task", "Tasks"], ["model-sunburst", "Models (sunburst)"],
];

let drawing = 0; // the last call of showFlow: what an earlier one brings is out of date

export function showFlowControls() {
  byId("flow-controls").replaceChildren(
    choice("Chart", "chart", CHARTS, state.chart, (chart) => show({ chart })),
    state.chart === "cross-analysis"
      ? segmented("Detail of models and extractors", "detail", [["grouped", "Families"], ["all", "All values"]], state.detail, (detail) => show({ detail }))
      : "",
    segmented("Counting", "counting", [["studies", "Studies"], ["fractional", "Fractional"]], state.counting, (counting) => show({ counting })),
    segmented("Form", "view", [["diagram", "Diagram"], ["table", "Table"]], state.view, (view) => show({ view })));
}

/** The flow to show: of the answer's paths, or one of the survey's charts filtered by study. */
async function flowOf(answer, vocabulary, signal) {
  if (state.chart === "cross-analysis") {
    const all = { chart: state.chart, levels: CROSS, counting: state.counting, nodes: answer.nodes, links: answer.links };
    const flow = state.detail === "grouped" ? grouped(all, vocabulary) : all;
    return state.counting === "fractional" ? fractional(flow, answer.paths, vocabulary) : withAmounts(flow);
  }
  const filters = Object.fromEntries(ATTRIBUTES.map((a) => [a, state.include[a]]));
  const flow = await getJson(address(`/v1/flows/${state.chart}`, { counting: state.counting, ...filters }), signal);
  return withAmounts(flow);
}

const wanting = (left) => left.map((l) => `${plural(l.count, "study", "studies")} without ${nameOf(l.level).toLowerCase()}`).join(", ");

function noteOf(flow, answer, studies) {
  const parts = [];
  if (state.chart === "cross-analysis") {
    parts.push("Studies of the architectures above, from task to feature extractor. Select a value to add it as a requirement.");
    if (answer.left_out?.length) {
      parts.push(`Not shown, attribute unknown: ${wanting(answer.left_out)}.`);
    }
  } else {
    parts.push("Studies that have the required values.");
    const unheeded = ATTRIBUTES.some((a) => state.exclude[a].length) || LIMITS.some((l) => state.limits[l] !== "")
      || LISTS.some((l) => state.lists[l].length);
    if (unheeded) parts.push("Excluded values, limits and conditions to tolerate apply to the cross-analysis only.");
    if (flow.left_out?.length) parts.push(`Not shown, attribute unknown: ${wanting(flow.left_out)}.`);
  }
  parts.push(state.counting === "fractional"
    ? "Fractional: a study with several values is divided among them, so that inflow equals outflow."
    : `Each study counts once per value; a study with several values is on several links (${studies} studies).`);
  return parts.join(" ");
}

const nameOf = (level) => (level === "calibration" ? "Calibration" : ATTRIBUTE_NAMES[level] ?? level);

function valuesOf(node, vocabulary) {
  const attribute = attributeOf(node.level);
  if (!attribute || !ATTRIBUTES.includes(attribute)) return null;
  return { attribute, values: node.level === attribute ? [node.value] : vocabulary.inFamily(attribute, node.value) };
}

function toggle(node, vocabulary) {
  const target = valuesOf(node, vocabulary);
  if (!target) return;
  set(target.attribute, target.values, isRequired(node, vocabulary) ? null : "include");
}

function isRequired(node, vocabulary) {
  const target = valuesOf(node, vocabulary);
  return Boolean(target) && target.values.every((v) => sideOf(target.attribute, v) === "include");
}

/** Values by level, longest first: buttons that require a value. */
function levelLists(flow, vocabulary) {
  return h("div", { class: "level-list" }, flow.levels.map((level) => {
    const nodes = flow.nodes.filter((n) => n.level === level).sort((a, b) => b.amount - a.amount);
    const most = Math.max(...nodes.map((n) => n.amount), 1e-9);
    return h("section", {}, h("h3", {}, nameOf(level)), h("ol", {}, nodes.map((node) => {
      const required = isRequired(node, vocabulary);
      return h("li", {}, h("button", {
        type: "button", class: required ? "level-value required" : "level-value", title: node.name,
        disabled: !valuesOf(node, vocabulary), "aria-pressed": required, "data-node": node.id,
        "aria-label": `${node.name}: ${amount(node.amount)} ${state.counting === "fractional" ? "study shares" : "studies"}, require`,
        onclick: () => toggle(node, vocabulary),
      }, h("span", { class: "bar", css: { "--share": node.amount / most } }),
      h("span", {}, worded(node.level, node.value)), h("span", { class: "count" }, amount(node.amount))));
    })));
  }));
}

function linkTable(flow) {
  const node = new Map(flow.nodes.map((n) => [n.id, n]));
  const rank = (link) => flow.levels.indexOf(node.get(link.source).level);
  const links = [...flow.links].sort((a, b) => rank(a) - rank(b) || b.value - a.value);
  return h("details", { class: "flow-links" }, h("summary", {}, `All ${links.length} links with their studies`),
    h("div", { class: "table-scroll", tabindex: "0", role: "region", "aria-label": "Links of the flow" },
      h("table", { class: "plain" },
        h("thead", {}, h("tr", {}, ["From", "To", "Studies", "Keys"].map((t, i) => h("th", { scope: "col", class: i === 2 && "number" }, t)))),
        h("tbody", {}, links.map((l) => h("tr", {},
          [l.source, l.target].map((id) => h("td", {}, worded(node.get(id).level, node.get(id).value))),
          h("td", { class: "number" }, amount(l.value)),
          h("td", { class: "note" }, l.studies.map((key, i) => [i > 0 && ", ", h("a", { href: `/studies/${encodeURIComponent(key)}` }, key)]))))))));
}

/** Draw the flow of an answer; a later call overtakes an earlier one. */
export async function showFlow(answer, vocabulary, studies, signal) {
  const turn = ++drawing;
  const body = byId("flow-body");
  body.setAttribute("aria-busy", "true");
  body.classList.add("stale");
  try {
    const flow = await flowOf(answer, vocabulary, signal);
    if (turn !== drawing) return;
    byId("flow-note").textContent = noteOf(flow, answer, studies);
    if (flow.links.length === 0) {
      clear(body, h("p", { class: "notice" }, "No study has all required values."));
      return;
    }
    if (state.view === "table") {
      const focused = document.activeElement?.dataset?.node;
      clear(body, levelLists(flow, vocabulary), linkTable(flow));
      // The lists are new elements; the keyboard stays on the value it was on.
      [...body.querySelectorAll("[data-node]")].find((b) => b.dataset.node === focused)?.focus();
      return;
    }
    diagram(body, flow, vocabulary);
  } catch (problem) {
    if (problem.name === "AbortError" || turn !== drawing) return;
    if (!problem.title) problem.title = "The diagram could not be drawn";
    clear(body, problemNotice({ title: problem.title, status: problem.status, detail: problem.detail ?? problem.message, errors: problem.errors },
      () => showFlow(answer, vocabulary, studies, signal)));
  } finally {
    if (turn === drawing) {
      body.removeAttribute("aria-busy");
      body.classList.remove("stale");
    }
  }
}

function clear(body, ...content) {
  body.replaceChildren(...content);
}

function diagram(body, flow, vocabulary) {
  const round = state.chart === "model-sunburst";
  const description = `${CHARTS.find(([c]) => c === state.chart)[1]}: ${flow.levels.map(nameOf).join(", ")}. The table view has the same values.`;
  let picture = body.querySelector(round ? ".diagram.round" : ".diagram:not(.round)");
  if (!picture) {
    picture = h("div", { class: round ? "diagram round" : "diagram", role: "img" });
    clear(body,
      h("p", { class: "swipe", hidden: round }, "Scroll the diagram sideways, or choose “Table”."),
      h("div", { class: round ? "" : "scroller", tabindex: round ? null : "0", role: round ? null : "region", "aria-label": round ? null : "Flow diagram" },
        h("div", { class: "diagram-frame" }, h("div", { class: "levels-head", "aria-hidden": true, hidden: round }), picture)));
  }
  picture.setAttribute("aria-label", description);
  const heads = body.querySelector(".levels-head");
  heads.replaceChildren(...flow.levels.map((level, i) =>
    h("span", { css: { "--at": i / (flow.levels.length - 1) } }, nameOf(level))));
  heads.style.setProperty("--labels", `${labelRoom(flow)}px`);
  if (round) drawSunburst(picture, rings(flow, vocabulary));
  else drawSankey(picture, flow, (n) => isRequired(n, vocabulary), (n) => toggle(n, vocabulary));
  picture.dataset.chart = state.chart;
  picture.dataset.nodes = flow.nodes.map((n) => n.id).join("|");
}
