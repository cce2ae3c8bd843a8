/* The decision flow: which chart, how it is counted, drawn and as lists and a table. */

import { byId, choice, h, problemNotice, segmented } from "./dom.js";
import { attributeOf, fractional, grouped, rings, withAmounts } from "./flow_data.js";
import { drawSankey, drawSunburst, labelRoom } from "./flow_diagram.js";
import { address, getJson, getOnce } from "./service.js";
import { amount, ATTRIBUTE_NAMES, plural, Vocabulary, worded } from "./wording.js";

const ATTRIBUTES = ["task", "accuracy", "error", "detector", "mask", "model", "extractor"];
const OF_PAGE = ["cursor", "across"]; // which the page reads and the flow does not
const CHARTS = [
  ["cross-analysis", "Cross-analysis"], ["error", "Errors"], ["performance", "Performance"],
  ["task", "Tasks"], ["model-sunburst", "Models (sunburst)"],
];
const shown = { chart: "cross-analysis", counting: "studies", detail: "grouped", view: "diagram" };

let asked = new URLSearchParams(); // the question that is drawn
let choose = () => {}; // called with an attribute and values that were pressed
let drawing = 0; // the last call: what an earlier one brings is out of date

/** Make the controls anew; the keyboard stays where it was. */
function showControls() {
  const { name, id } = document.activeElement ?? {};
  const set = (setting) => (value) => {
    shown[setting] = value;
    showControls();
    redrawFlow();
  };
  byId("flow-controls").replaceChildren(
    choice("Chart", "chart", CHARTS, shown.chart, set("chart")),
    shown.chart === "cross-analysis"
      ? segmented("Detail of models and extractors", "detail", [["grouped", "Families"], ["all", "All values"]], shown.detail, set("detail"))
      : "",
    segmented("Counting", "counting", [["studies", "Studies"], ["fractional", "Fractional"]], shown.counting, set("counting")),
    segmented("Form", "view", [["diagram", "Diagram"], ["table", "Table"]], shown.view, set("view")));
  const again = name ? document.querySelector(`#flow-controls [name="${name}"]:checked`) : id === "chart" && byId("chart");
  again?.focus?.();
}

/** The flow to show: of the answer's paths, or one of the survey's charts filtered by study. */
async function flowOf(vocabulary, signal) {
  if (shown.chart === "cross-analysis") {
    const found = await getJson(`/v1/recommendations/flow?${asked}`, signal);
    const flow = shown.detail === "grouped" ? grouped(found, vocabulary) : found;
    return shown.counting === "fractional" ? fractional(flow, found.paths, vocabulary) : withAmounts(flow);
  }
  const filters = Object.fromEntries([...ATTRIBUTES, "edition"].map((name) => [name, asked.getAll(name)]));
  return withAmounts(await getJson(address(`/v1/flows/${shown.chart}`, { counting: shown.counting, ...filters }), signal));
}

const wanting = (left) => left.map((l) => `${plural(l.count, "study", "studies")} without ${nameOf(l.level).toLowerCase()}`).join(", ");

function noteOf(flow) {
  const parts = [];
  if (shown.chart === "cross-analysis") {
    parts.push("Studies of the architectures above, from task to feature extractor. Select a value to add it as a requirement.");
  } else {
    parts.push("Studies that have the required values.");
    if ([...asked.keys()].some((name) => ![...ATTRIBUTES, "edition", "sort"].includes(name))) {
      parts.push("Excluded values, limits and conditions to tolerate apply to the cross-analysis only.");
    }
  }
  if (flow.left_out?.length) parts.push(`Not shown, attribute unknown: ${wanting(flow.left_out)}.`);
  const studies = new Set(flow.nodes.flatMap((node) => node.studies)).size;
  parts.push(shown.counting === "fractional"
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
  choose(target.attribute, target.values);
}

function isRequired(node, vocabulary) {
  const target = valuesOf(node, vocabulary);
  return Boolean(target) && target.values.every((v) => asked.getAll(target.attribute).includes(v));
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
        "aria-label": `${node.name}: ${amount(node.amount)} ${shown.counting === "fractional" ? "study shares" : "studies"}, require`,
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

/** Draw the flow again, as what is shown or the width has changed. */
export async function redrawFlow(signal) {
  const turn = ++drawing;
  const body = byId("flow-body");
  body.setAttribute("aria-busy", "true");
  body.classList.add("stale");
  try {
    const vocabulary = new Vocabulary((await getOnce("/v1/taxonomy")).attributes);
    const flow = await flowOf(vocabulary, signal);
    if (turn !== drawing) return;
    byId("flow-note").textContent = noteOf(flow);
    if (flow.links.length === 0) {
      clear(body, h("p", { class: "notice" }, "No study has all required values."));
      return;
    }
    if (shown.view === "table") {
      const focused = document.activeElement?.dataset?.node;
      clear(body, levelLists(flow, vocabulary), linkTable(flow));
      // The lists are new elements; the keyboard stays on the value it was on.
      [...body.querySelectorAll("[data-node]")].find((b) => b.dataset.node === focused)?.focus();
      return;
    }
    diagram(body, flow, vocabulary);
  } catch (problem) {
    if (problem.name === "AbortError" || turn !== drawing) return;
    if (problem.status === 400 || problem.status === 422) { // the answer says what is wrong
      byId("flow-note").textContent = "";
      clear(body, h("p", { class: "muted" }, "Nothing to show: the question was refused."));
      return;
    }
    if (!problem.title) problem.title = "The diagram could not be drawn";
    clear(body, problemNotice({ title: problem.title, status: problem.status, detail: problem.detail ?? problem.message, errors: problem.errors },
      () => redrawFlow()));
  } finally {
    if (turn === drawing) {
      body.removeAttribute("aria-busy");
      body.classList.remove("stale");
    }
  }
}

/**
 * Draw the flow of the answer to a query; a later call overtakes an earlier one.
 * pressed(attribute, values) is called for a value that is pressed.
 */
export function drawFlow(query, signal, pressed = choose) {
  choose = pressed;
  asked = new URLSearchParams([...new URLSearchParams(query)].filter(([name, value]) => value !== "" && !OF_PAGE.includes(name)));
  showControls();
  return redrawFlow(signal);
}

function clear(body, ...content) {
  body.replaceChildren(...content);
}

function diagram(body, flow, vocabulary) {
  const round = shown.chart === "model-sunburst";
  const description = `${CHARTS.find(([c]) => c === shown.chart)[1]}: ${flow.levels.map(nameOf).join(", ")}. The table view has the same values.`;
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
  picture.dataset.chart = shown.chart;
  picture.dataset.nodes = flow.nodes.map((n) => n.id).join("|");
}
