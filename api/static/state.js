/* What is asked and what is shown, kept in the address so that an answer can be shared. */

export const ATTRIBUTES = ["task", "accuracy", "error", "detector", "mask", "model", "extractor"];
export const LIMITS = ["max_error_deg", "min_fov_deg", "min_availability", "max_latency_us", "bench_deg", "confidence"];
/** Of which all that is asked must hold: hazards, properties of the survey's assessment. */
export const LISTS = ["survive", "properties", "exclude_needs"];
const VIEW = {
  sort: "advice", chart: "cross-analysis", counting: "studies", detail: "grouped", view: "diagram",
  dataset: "", board_condition: "", board_field: "", board_sort: "rank", board_order: "ascending",
  across: "field",
};

const listeners = new Set();
export const state = read(location.search);

function read(search) {
  const parameters = new URLSearchParams(search);
  const found = { include: {}, exclude: {}, limits: {}, lists: {}, ...VIEW };
  for (const attribute of ATTRIBUTES) {
    found.include[attribute] = [...new Set(parameters.getAll(attribute))];
    found.exclude[attribute] = [...new Set(parameters.getAll(`exclude_${attribute}`))];
  }
  for (const limit of LIMITS) found.limits[limit] = parameters.get(limit) ?? "";
  for (const list of LISTS) found.lists[list] = [...new Set(parameters.getAll(list))];
  found.edition = parameters.get("edition") === "all" ? "all" : "survey";
  for (const name of Object.keys(VIEW)) found[name] = parameters.get(name) || VIEW[name];
  return found;
}

/** The requirements, without the order of the answer, as the service's query parameters. */
export function requirements(of = state) {
  const query = {};
  for (const attribute of ATTRIBUTES) {
    if (of.include[attribute].length) query[attribute] = of.include[attribute];
    if (of.exclude[attribute].length) query[`exclude_${attribute}`] = of.exclude[attribute];
  }
  for (const limit of LIMITS) if (of.limits[limit] !== "") query[limit] = of.limits[limit];
  for (const list of LISTS) if (of.lists[list].length) query[list] = of.lists[list];
  if (of.edition === "all") query.edition = "all";
  return query;
}

function search() {
  const parameters = new URLSearchParams();
  for (const [name, value] of Object.entries(requirements())) {
    for (const one of [value].flat()) parameters.append(name, one);
  }
  for (const [name, usual] of Object.entries(VIEW)) if (state[name] !== usual) parameters.append(name, state[name]);
  const text = parameters.toString();
  return text ? `?${text}` : location.pathname;
}

/** Called with the set of what changed: "requirements" and/or names of view settings. */
export function onChange(listener) {
  listeners.add(listener);
}

/** Every step is one that Back undoes. */
function tell(changed) {
  history.pushState(null, "", search());
  for (const listener of listeners) listener(new Set(changed));
}

/** Change how the answer is shown. */
export function show(settings) {
  Object.assign(state, settings);
  tell(Object.keys(settings));
}

/** "include", "exclude" or null for one value; several values at once for a family. */
export function set(attribute, values, side) {
  const list = [values].flat();
  for (const where of ["include", "exclude"]) {
    const others = state[where][attribute].filter((v) => !list.includes(v));
    state[where][attribute] = side === where ? [...others, ...list] : others;
  }
  tell(["requirements"]);
}

/** Ask for one value of a list, or no longer. */
export function setListed(list, value, wanted) {
  const others = state.lists[list].filter((v) => v !== value);
  state.lists[list] = wanted ? [...others, value] : others;
  tell(["requirements"]);
}

export function sideOf(attribute, value) {
  if (state.include[attribute].includes(value)) return "include";
  return state.exclude[attribute].includes(value) ? "exclude" : null;
}

export function setLimit(name, text) {
  state.limits[name] = text;
  tell(["requirements"]);
}

/** Replace all requirements by those of a query. */
export function setRequirements(query) {
  for (const attribute of ATTRIBUTES) {
    state.include[attribute] = [query[attribute] ?? []].flat();
    state.exclude[attribute] = [query[`exclude_${attribute}`] ?? []].flat();
  }
  for (const limit of LIMITS) state.limits[limit] = String([query[limit] ?? ""].flat()[0] ?? "");
  for (const list of LISTS) state.lists[list] = [query[list] ?? []].flat();
  tell(["requirements"]);
}

export function reset() {
  setRequirements({});
}

/** Whether anything is required. */
export const required = () => Object.keys(requirements()).some((name) => name !== "edition");

/** Requirements and order as the service's query parameters; the usual order is not named. */
export function question() {
  return { ...requirements(), sort: state.sort === VIEW.sort ? null : state.sort };
}

addEventListener("popstate", () => {
  Object.assign(state, read(location.search));
  for (const listener of listeners) listener(new Set(["requirements", ...Object.keys(VIEW)]));
});
