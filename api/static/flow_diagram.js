/* Sankey diagrams and the sunburst as SVG, in the colours of the style sheet. */

import { svg } from "./dom.js";
import { layout } from "./sankey.js";
import { amount, plural, worded } from "./wording.js";

const THICKNESS = 12;
const LETTER = 7.4; // mean width of a letter of a label
const label = (node) => `${worded(node.level, node.value)}  ${amount(node.amount)}`;
const listed = (studies) => `${studies.slice(0, 6).join(", ")}${studies.length > 6 ? `, and ${studies.length - 6} more` : ""}`;
const listing = (studies) => `${plural(studies.length, "study", "studies")}: ${listed(studies)}`;

/** Pixels that the labels of the last level need beside it. */
export function labelRoom(flow) {
  const last = flow.nodes.filter((n) => n.level === flow.levels.at(-1));
  return 16 + Math.ceil(LETTER * Math.max(...last.map((n) => label(n).length), 8));
}

/** Draw a flow; required(node) colours a node, choose(node) is called on a click. */
export function drawSankey(container, flow, required, choose) {
  const linked = new Set(flow.links.flatMap((l) => [l.source, l.target]));
  const nodes = flow.nodes.filter((n) => linked.has(n.id));
  const known = new Map(nodes.map((n) => [n.id, n]));
  const tallest = Math.max(...flow.levels.map((level) => nodes.filter((n) => n.level === level).length));
  const height = Math.min(760, Math.max(200, 70 + tallest * (tallest > 14 ? 24 : 40)));
  const width = container.clientWidth;
  const places = layout({ ...flow, nodes }, width - labelRoom(flow), height - 16, THICKNESS);
  const sun = (id) => required(known.get(id));
  container.replaceChildren(svg("svg", { viewBox: `0 0 ${width} ${height}`, width, height, class: "sankey" },
    svg("g", { transform: "translate(0 8)" },
      places.links.map(({ link, path, width: wide }) => svg("path", {
        class: sun(link.source) || sun(link.target) ? "sankey-link required" : "sankey-link", d: path, "stroke-width": wide,
      }, svg("title", {}, `${known.get(link.source).value} to ${known.get(link.target).value}: ${amount(link.value)}, ${listed(link.studies)}`))),
      places.nodes.map(({ node, x, y, height: tall }) => svg("g", {
        class: required(node) ? "sankey-node required" : "sankey-node", onclick: () => choose(node),
      }, svg("title", {}, `${node.name}: ${listing(node.studies)}`),
      svg("rect", { class: "node-bar", x, y, width: THICKNESS, height: tall }),
      svg("text", { class: "node-label", x: x + THICKNESS + 4, y: y + tall / 2 + 4.5 }, label(node)),
      // A thin node is still something to press.
      svg("rect", { class: "node-rect hit", x: x - 4, y: y + tall / 2 - Math.max(tall, 14) / 2, width: THICKNESS + 8, height: Math.max(tall, 14) }))))));
}

const TURN = 2 * Math.PI;

function sector(from, to, inner, outer) {
  const end = Math.min(to, from + TURN - 1e-4);
  const at = (angle, radius) => `${(radius * Math.sin(angle)).toFixed(2)} ${(-radius * Math.cos(angle)).toFixed(2)}`;
  const long = end - from > Math.PI ? 1 : 0;
  return `M${at(from, outer)}A${outer} ${outer} 0 ${long} 1 ${at(end, outer)}L${at(end, inner)}A${inner} ${inner} 0 ${long} 0 ${at(from, inner)}Z`;
}

/** A label along its radius, where there is room for it. */
function radial(part, inner, outer) {
  const middle = (part.from + part.to) / 2;
  const room = (outer - inner - 8) / 6.4;
  if ((part.to - part.from) * ((inner + outer) / 2) < 13) return null;
  const text = part.label.length > room ? `${part.label.slice(0, Math.max(2, Math.floor(room) - 1))}…` : part.label;
  const turned = (middle * 360) / TURN - 90;
  const flipped = middle > Math.PI;
  return svg("text", {
    class: "slice-label", transform: `rotate(${turned}) translate(${(inner + outer) / 2} 0) rotate(${flipped ? 180 : 0})`,
    "text-anchor": "middle", dy: "0.35em",
  }, text);
}

/** Draw rings: family, calibration off or on line, model. */
export function drawSunburst(container, parts) {
  const children = new Map();
  for (const part of parts) children.set(part.parent, [...children.get(part.parent) ?? [], part]);
  const sum = (part) => (children.get(part.id) ?? []).reduce((s, c) => s + sum(c), 0) || part.amount;
  const size = Math.min(620, Math.max(300, container.clientWidth));
  const radius = size / 2 - 2;
  const edges = [0.16, 0.42, 0.62, 1].map((share) => share * radius);
  const drawn = [];
  const place = (parent, from, to, ring) => {
    const mine = [...children.get(parent) ?? []].sort((a, b) => sum(b) - sum(a) || a.label.localeCompare(b.label));
    const whole = mine.reduce((s, p) => s + sum(p), 0);
    let start = from;
    for (const part of mine) {
      const end = start + ((to - from) * sum(part)) / whole;
      drawn.push({ ...part, from: start, to: end, ring });
      place(part.id, start, end, ring + 1);
      start = end;
    }
  };
  place("", 0, TURN, 0);
  container.replaceChildren(svg("svg", { viewBox: `${-size / 2} ${-size / 2} ${size} ${size}`, width: size, height: size, class: "sunburst" },
    drawn.map((part) => svg("g", { class: `slice ring${part.ring}` },
      svg("title", {}, `${part.label}: ${listing([...part.studies])}`),
      svg("path", { d: sector(part.from, part.to, edges[part.ring], edges[part.ring + 1]) }),
      radial(part, edges[part.ring], edges[part.ring + 1])))));
}
