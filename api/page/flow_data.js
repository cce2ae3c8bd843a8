/* Flows as the diagrams need them. Pure functions: nothing here asks the server or draws. */

const GROUPED = { model: "model_category", extractor: "extractor_family" };

const unionSize = (sets) => new Set(sets.flat()).size;

/** Attribute whose values a level shows, or null where a level is not an attribute. */
export function attributeOf(level) {
  const found = Object.keys(GROUPED).find((attribute) => GROUPED[attribute] === level);
  if (found) return found;
  return level === "offline/online" ? null : level;
}

/**
 * The flow of a recommendation, with each study counted once over all its paths: a study on
 * k paths gives 1/k to each, so that what flows into a value flows out of it.
 */
export function fractional(flow, paths, levels) {
  const paths_of = new Map();
  for (const path of paths) for (const key of path.studies) paths_of.set(key, (paths_of.get(key) ?? 0) + 1);
  const nodes = new Map();
  const links = new Map();
  const add = (map, id, x) => map.set(id, (map.get(id) ?? 0) + x);
  for (const path of paths) {
    const weight = path.studies.reduce((sum, key) => sum + 1 / paths_of.get(key), 0);
    levels.forEach((level, i) => {
      add(nodes, `${level}:${path[level]}`, weight);
      if (i) add(links, `${levels[i - 1]}:${path[levels[i - 1]]}\n${level}:${path[level]}`, weight);
    });
  }
  return {
    ...flow,
    nodes: flow.nodes.map((n) => ({ ...n, amount: nodes.get(n.id) ?? 0 })),
    links: flow.links.map((l) => ({ ...l, value: links.get(`${l.source}\n${l.target}`) ?? 0 })),
  };
}

/** Models and extractors by family: studies are counted once a family, fractions are added. */
export function grouped(flow, vocabulary) {
  const id_of = new Map();
  const nodes = new Map();
  for (const node of flow.nodes) {
    const level = GROUPED[node.level];
    const value = level ? vocabulary.family(node.level, node.value) : node.value;
    const id = `${level ?? node.level}:${value}`;
    id_of.set(node.id, id);
    const known = nodes.get(id) ?? { id, level: level ?? node.level, value, name: level ? value : node.name, parts: [] };
    known.parts.push(node);
    nodes.set(id, known);
  }
  const links = new Map();
  for (const link of flow.links) {
    const source = id_of.get(link.source);
    const target = id_of.get(link.target);
    const id = `${source}\n${target}`;
    const known = links.get(id) ?? { source, target, parts: [] };
    known.parts.push(link);
    links.set(id, known);
  }
  const fraction = flow.counting === "fractional";
  const studies = (parts) => [...new Set(parts.flatMap((p) => p.studies))].sort();
  const total = (parts, field) => parts.reduce((sum, p) => sum + p[field], 0);
  return {
    ...flow,
    levels: flow.levels.map((level) => GROUPED[level] ?? level),
    nodes: [...nodes.values()].map(({ parts, ...node }) => ({
      ...node,
      studies: studies(parts),
      count: unionSize(parts.map((p) => p.studies)),
      amount: fraction ? total(parts, "amount") : unionSize(parts.map((p) => p.studies)),
    })),
    links: [...links.values()].map(({ parts, ...link }) => ({
      ...link,
      studies: studies(parts),
      value: fraction ? total(parts, "value") : unionSize(parts.map((p) => p.studies)),
    })),
  };
}

/** What a node amounts to under fractional counting: what flows through it. */
export function withAmounts(flow) {
  if (flow.counting !== "fractional") return { ...flow, nodes: flow.nodes.map((n) => ({ ...n, amount: n.count })) };
  const into = new Map();
  const out = new Map();
  for (const { source, target, value } of flow.links) {
    out.set(source, (out.get(source) ?? 0) + value);
    into.set(target, (into.get(target) ?? 0) + value);
  }
  return {
    ...flow,
    nodes: flow.nodes.map((n) => ({ ...n, amount: Math.max(into.get(n.id) ?? 0, out.get(n.id) ?? 0) || n.count })),
  };
}

/** Leaves and rings of the model sunburst: family > calibration off or on line > model. */
export function rings(flow, vocabulary) {
  const value_of = new Map(flow.nodes.map((n) => [n.id, n.value]));
  const level_of = new Map(flow.nodes.map((n) => [n.id, n.level]));
  const [, middle, outer] = flow.levels;
  const parts = new Map();
  const add = (id, parent, label, x, studies, leaf) => {
    const known = parts.get(id) ?? { id, parent, label, amount: 0, studies: new Set(), leaf };
    known.amount += x;
    studies.forEach((s) => known.studies.add(s));
    parts.set(id, known);
  };
  for (const link of flow.links) {
    if (level_of.get(link.source) !== middle || level_of.get(link.target) !== outer) continue;
    const model = value_of.get(link.target);
    const when = value_of.get(link.source);
    const family = vocabulary.family("model", model);
    add(family, "", family, link.value, link.studies, false);
    add(`${family}/${when}`, family, when, link.value, link.studies, false);
    add(`${family}/${when}/${model}`, `${family}/${when}`, model, link.value, link.studies, true);
  }
  return [...parts.values()];
}
