/* Sankey diagrams and the sunburst, drawn by Plotly in the colours of the page. */

import { amount, plural } from "./wording.js";

let asked = null;

/** Plotly from this server, loaded when first needed: the rest of the page does not wait for it. */
export function plotly() {
  asked ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = "/page/plotly.min.js";
    script.onload = () => resolve(window.Plotly);
    script.onerror = () => {
      asked = null;
      script.remove();
      reject(new Error("The chart library /page/plotly.min.js could not be loaded."));
    };
    document.head.append(script);
  });
  return asked;
}

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const narrow = () => matchMedia("(max-width: 700px)").matches;

const CONFIG = { displayModeBar: false, responsive: true };

function layout(height, right = 2) {
  return {
    height, margin: { l: 2, r: right, t: 8, b: 8 }, paper_bgcolor: "rgba(0,0,0,0)",
    font: { family: colour("--font"), size: 13, color: colour("--text") },
    hoverlabel: {
      bgcolor: colour("--surface"), bordercolor: colour("--line-strong"),
      font: { family: colour("--font"), size: 13, color: colour("--text") }, align: "left",
    },
  };
}

const listed = (studies) => `${studies.slice(0, 6).join(", ")}${studies.length > 6 ? `, and ${studies.length - 6} more` : ""}`;

/**
 * Where every node stands, for flows that do not all start at the first level: Plotly would
 * otherwise move a node without inflow to the first column.
 */
function placed(nodes, levels) {
  const x = [];
  const y = [];
  for (const [i, level] of levels.entries()) {
    const column = nodes.map((n, at) => [n, at]).filter(([n]) => n.level === level);
    const total = column.reduce((sum, [n]) => sum + n.amount, 0);
    const room = 0.92 - 0.03 * column.length;
    let top = 0.02;
    for (const [node, at] of column) {
      const size = room * (node.amount / total);
      x[at] = Math.min(0.999, Math.max(0.001, i / (levels.length - 1)));
      y[at] = top + size / 2;
      top += size + 0.03;
    }
  }
  return { x, y };
}

const THICKNESS = 12;
const label = (node) => `${node.value}  ${amount(node.amount)}`;

/** Pixels that the labels of the last level need beside it. */
export function labelRoom(flow) {
  const last = flow.nodes.filter((n) => n.level === flow.levels.at(-1));
  return 16 + Math.ceil(7.4 * Math.max(...last.map((n) => label(n).length), 8));
}

/** Plotly writes the last level's labels inward, over those of the level before: turn them out. */
function labelsOutward(container) {
  for (const text of container.querySelectorAll(".sankey-node .node-label")) {
    if (text.getAttribute("text-anchor") !== "end") continue;
    const [, , y] = /translate\(([-\d.]+)[, ]+([-\d.]+)\)/.exec(text.getAttribute("transform")) ?? [];
    if (y === undefined) continue;
    text.setAttribute("transform", `translate(${THICKNESS + 3},${y})`);
    text.setAttribute("text-anchor", "start");
    // Lines of a label carry their own anchor.
    for (const line of text.querySelectorAll("tspan")) line.setAttribute("text-anchor", "start");
  }
}

/** Draw a flow; required(node) colours a node, choose(node) is called on a click. */
export async function drawSankey(container, flow, required, choose) {
  const library = await plotly();
  const linked = new Set(flow.links.flatMap((l) => [l.source, l.target]));
  const nodes = flow.nodes.filter((n) => linked.has(n.id));
  const at = new Map(nodes.map((n, i) => [n.id, i]));
  const sun = nodes.map(required);
  const tallest = Math.max(...flow.levels.map((level) => nodes.filter((n) => n.level === level).length));
  const into = new Set(flow.links.map((l) => l.target));
  const adrift = nodes.some((n) => n.level !== flow.levels[0] && !into.has(n.id));
  const trace = {
    type: "sankey",
    arrangement: "fixed",
    node: {
      label: nodes.map(label),
      color: sun.map((yes) => colour(yes ? "--sun-node" : "--node")),
      customdata: nodes.map((n) => `<b>${n.name}</b><br>${plural(n.studies.length, "study", "studies")}: ${listed(n.studies)}`),
      hovertemplate: "%{customdata}<extra></extra>",
      line: { width: 0 }, thickness: THICKNESS, pad: tallest > 14 ? 9 : 14, align: "left",
      ...(adrift ? placed(nodes, flow.levels) : {}),
    },
    link: {
      source: flow.links.map((l) => at.get(l.source)),
      target: flow.links.map((l) => at.get(l.target)),
      value: flow.links.map((l) => l.value),
      color: flow.links.map((l) => colour(sun[at.get(l.source)] || sun[at.get(l.target)] ? "--sun-link" : "--node-link")),
      hovercolor: flow.links.map(() => colour("--node-link-hover")),
      customdata: flow.links.map((l) => `${amount(l.value)} · ${listed(l.studies)}`),
      hovertemplate: "%{source.label} → %{target.label}<br>%{customdata}<extra></extra>",
    },
    textfont: { size: narrow() ? 12 : 13, color: colour("--text"), shadow: halo() },
  };
  const height = Math.min(760, Math.max(200, 70 + tallest * (tallest > 14 ? 30 : 44)));
  // A changed drawing glides to its new form; one drawn afresh stands there at once.
  if (matchMedia("(prefers-reduced-motion: reduce)").matches) erase(container);
  await library.react(container, [trace], layout(height, labelRoom(flow)), CONFIG);
  labelsOutward(container);
  container.removeAllListeners("plotly_afterplot");
  container.on("plotly_afterplot", () => labelsOutward(container));
  container.removeAllListeners("plotly_click");
  container.on("plotly_click", (event) => {
    const point = event.points[0];
    const node = nodes[point.pointNumber];
    if (point.source === undefined && node) choose(node);
  });
}

/** Letters stay readable over links. */
function halo() {
  const ground = colour("--surface");
  return ["-1px -1px", "1px -1px", "-1px 1px", "1px 1px", "0 0"].map((at) => `${at} 2px ${ground}`).join(", ");
}

/** Draw rings; a click zooms. */
export async function drawSunburst(container, parts) {
  const library = await plotly();
  const children = new Set(parts.map((p) => p.parent));
  const trace = {
    type: "sunburst",
    ids: parts.map((p) => p.id), labels: parts.map((p) => p.label), parents: parts.map((p) => p.parent),
    // The rings inside show what their leaves add up to.
    values: parts.map((p) => (children.has(p.id) ? 0 : p.amount)),
    branchvalues: "remainder",
    customdata: parts.map((p) => `${plural(p.studies.size, "study", "studies")}: ${listed([...p.studies])}`),
    hovertemplate: "<b>%{label}</b><br>%{customdata}<extra></extra>",
    marker: { colors: parts.map((p) => colour(p.leaf ? "--bar" : "--sunken")), line: { color: colour("--line-strong"), width: 1 } },
    insidetextorientation: "radial", textfont: { color: colour("--text") },
  };
  const size = Math.min(620, Math.max(320, container.clientWidth));
  await library.react(container, [trace], layout(size), CONFIG);
}

/** Forget a drawing, so that the next one starts afresh. */
export function erase(container) {
  if (window.Plotly && container.classList.contains("js-plotly-plot")) window.Plotly.purge(container);
}
