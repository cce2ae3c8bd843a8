/* Layout of a flow: columns of nodes whose labels keep clear of each other, links between them. */

const LABEL = 15; // pixels that a line of a label takes
const SWEEPS = 6;

/** What a node weighs: its amount, or what flows in or out where that is more. */
function weights(nodes, links) {
  const sums = (end) => links.reduce((by, l) => by.set(l[end], (by.get(l[end]) ?? 0) + l.value), new Map());
  const [out, into] = [sums("source"), sums("target")];
  return new Map(nodes.map((n) => [n.id, Math.max(n.amount, out.get(n.id) ?? 0, into.get(n.id) ?? 0)]));
}

/** Pixels of a unit, so that every column has room for its nodes and their labels. */
function unit(columns, weight, height, pad) {
  const fits = (k) => columns.every((column) =>
    column.reduce((sum, n) => sum + Math.max(k * weight.get(n.id), LABEL), 0) + pad * (column.length - 1) <= height);
  let [low, high] = [0, height];
  for (let i = 0; i < 40; i += 1) {
    const middle = (low + high) / 2;
    if (fits(middle)) low = middle;
    else high = middle;
  }
  return low;
}

/** Put each column in the order of the middles of what it is linked to, to and fro. */
function ordered(columns, links) {
  const sorted = columns.map((c) => [...c].sort((a, b) => b.amount - a.amount || a.value.localeCompare(b.value)));
  const sweep = (indices, near, far) => {
    for (const i of indices) {
      const place = new Map(sorted.flatMap((c) => c.map((n, at) => [n.id, (at + 0.5) / c.length])));
      const middle = (node) => {
        const mine = links.filter((l) => l[near] === node.id);
        const total = mine.reduce((s, l) => s + l.value, 0);
        return total ? mine.reduce((s, l) => s + l.value * place.get(l[far]), 0) / total : place.get(node.id);
      };
      const keys = new Map(sorted[i].map((n) => [n.id, middle(n)]));
      sorted[i].sort((a, b) => keys.get(a.id) - keys.get(b.id));
    }
  };
  const forward = sorted.map((_, i) => i).slice(1);
  for (let k = 0; k < SWEEPS; k += 1) {
    sweep(forward, "target", "source");
    sweep([...forward].reverse().map((i) => i - 1), "source", "target");
  }
  return sorted;
}

/**
 * Places of nodes and links: { nodes: [{node, x, y, height}], links: [{link, path, width}] }.
 * levels: in order; width and height: of the drawing, without the room for the last labels.
 */
export function layout({ levels, nodes, links }, width, height, thickness) {
  const columns = levels.map((level) => nodes.filter((n) => n.level === level)).filter((c) => c.length);
  const weight = weights(nodes, links);
  const tallest = Math.max(...columns.map((c) => c.length));
  const pad = tallest > 14 ? 5 : 9;
  const k = unit(columns, weight, height, pad);
  const placed = new Map();
  const sorted = ordered(columns, links);
  for (const [i, column] of sorted.entries()) {
    const slots = column.map((n) => Math.max(k * weight.get(n.id), LABEL));
    const used = slots.reduce((s, x) => s + x, 0);
    const gap = column.length > 1 ? Math.min(28, Math.max(pad, (height - used) / (column.length - 1))) : 0;
    let y = (height - used - gap * (column.length - 1)) / 2;
    const x = sorted.length > 1 ? (i / (sorted.length - 1)) * (width - thickness) : 0;
    for (const [at, node] of column.entries()) {
      const tall = Math.max(k * weight.get(node.id), 1.5);
      placed.set(node.id, { node, x, y: y + (slots[at] - tall) / 2, height: tall, out: 0, into: 0 });
      y += slots[at] + gap;
    }
  }
  const middle = (id) => placed.get(id).y + placed.get(id).height / 2;
  const starts = new Map();
  for (const l of [...links].sort((a, b) => middle(a.target) - middle(b.target))) {
    const from = placed.get(l.source);
    starts.set(l, from.y + from.out + (k * l.value) / 2);
    from.out += k * l.value;
  }
  const drawn = [...links].sort((a, b) => middle(a.source) - middle(b.source)).map((link) => {
    const [from, to] = [placed.get(link.source), placed.get(link.target)];
    const end = to.y + to.into + (k * link.value) / 2;
    to.into += k * link.value;
    const [x0, x1, y0] = [from.x + thickness, to.x, starts.get(link)];
    const half = (x0 + x1) / 2;
    return { link, width: Math.max(1, k * link.value), path: `M${x0} ${y0}C${half} ${y0} ${half} ${end} ${x1} ${end}` };
  });
  return { nodes: [...placed.values()], links: drawn };
}
