/* Flows as the diagrams need them. Pure functions: nothing here asks the server or draws. */

const GROUPED = { model: "model_category", extractor: "extractor_family" };

/** Attribute whose values a level shows, or null where a level is not an attribute. */
export function attributeOf(level) {
  const found = Object.keys(GROUPED).find((attribute) => GROUPED[attribute] === level);
  if (found) return found;
  return level === "offline/online" ? null : level;
}

/** Value of a path at a level, which may be a family. */
function valueAt(path, level, vocabulary) {
  const attribute = attributeOf(level);
  return level === attribute ? path[level] : vocabulary.family(attribute, path[attribute]);
}

/** Models and extractors by family: a study counts once a family. */
export function grouped(flow, vocabulary) {
  const id_of = new Map();
  const nodes = new Map();
  const join = (map, id, made, keys) => {
    const known = map.get(id) ?? { ...made, studies: new Set() };
    keys.forEach((key) => known.studies.add(key));
    map.set(id, known);
  };
  for (const node of flow.nodes) {
    const family = GROUPED[node.level];
    const level = family ?? node.level;
    const value = family ? vocabulary.family(node.level, node.value) : node.value;
    const id = `${level}:${value}`;
    id_of.set(node.id, id);
    join(nodes, id, { id, level, value, name: family ? value : node.name }, node.studies);
  }
  const links = new Map();
  for (const link of flow.links) {
    const [source, target] = [id_of.get(link.source), id_of.get(link.target)];
    join(links, `${source}\n${target}`, { source, target }, link.studies);
  }
  const counted = (map, field) => [...map.values()].map((made) => {
    const studies = [...made.studies].sort();
    return { ...made, studies, [field]: studies.length };
  });
  return {
    ...flow,
    levels: flow.levels.map((level) => GROUPED[level] ?? level),
    nodes: counted(nodes, "count"),
    links: counted(links, "value"),
  };
}

/**
 * A flow of paths with each study counted once in all: a study that shows k different
 * combinations of values gives 1/k to each, so that what flows into a value flows out of it.
 */
export function fractional(flow, paths, vocabulary) {
  const combinations = new Map(); // study -> combination -> its values
  for (const path of paths) {
    const values = flow.levels.map((level) => `${level}:${valueAt(path, level, vocabulary)}`);
    for (const key of path.studies) {
      if (!combinations.has(key)) combinations.set(key, new Map());
      combinations.get(key).set(values.join("\n"), values);
    }
  }
  const amounts = new Map();
  const add = (id, x) => amounts.set(id, (amounts.get(id) ?? 0) + x);
  for (const different of combinations.values()) {
    for (const values of different.values()) {
      values.forEach((id, i) => {
        add(id, 1 / different.size);
        if (i) add(`${values[i - 1]}\n${id}`, 1 / different.size);
      });
    }
  }
  return {
    ...flow,
    nodes: flow.nodes.map((n) => ({ ...n, amount: amounts.get(n.id) ?? 0 })),
    links: flow.links.map((l) => ({ ...l, value: amounts.get(`${l.source}\n${l.target}`) ?? 0 })),
  };
}

/** A flow of the service with what each node amounts to: its count, whole or fractional. */
export function withAmounts(flow) {
  return { ...flow, nodes: flow.nodes.map((n) => ({ ...n, amount: n.count })) };
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
