/* The panel of requirements: values can be required or excluded, limits are numbers, and of hazards
   and properties all that are chosen must hold. */

import { byId, h } from "./dom.js";
import { ATTRIBUTES, LIMITS, required, reset, set, setLimit, setListed, sideOf, state } from "./state.js";
import { ATTRIBUTE_NAMES, HAZARDS, inUnit, LIMIT_NAMES, LIST_NAMES, ofUnit, PROPERTIES, worded, NEEDS } from "./wording.js";

const OPEN_AT_FIRST = new Set(["task", "detector"]);
const updates = []; // one function an element that shows the state

function facet(attribute, entry, count) {
  const { value, name } = entry;
  const spoken = name && name !== value ? `${value}, ${name}` : value;
  const include = h("button", {
    type: "button", class: "facet-include", "aria-label": `${spoken}: require. ${count} studies`,
    "data-attribute": attribute, "data-value": value, title: name,
    onclick: () => set(attribute, value, sideOf(attribute, value) === "include" ? null : "include"),
  }, h("b", {}, worded(attribute, value)), name !== value && h("span", { class: "name" }, name), h("span", { class: "count" }, String(count)));
  const exclude = h("button", {
    type: "button", class: "facet-exclude", "aria-label": `${spoken}: exclude`, title: `Exclude ${value}`,
    onclick: () => set(attribute, value, sideOf(attribute, value) === "exclude" ? null : "exclude"),
  }, "⊘");
  const item = h("li", { class: "facet" }, include, exclude);
  updates.push((present) => {
    const now = sideOf(attribute, value);
    item.dataset.side = now ?? "none";
    include.setAttribute("aria-pressed", String(now === "include"));
    exclude.setAttribute("aria-pressed", String(now === "exclude"));
    // Beside a required value the others are alternatives, whatever the answer holds now.
    if (present) item.dataset.absent = String(!present[attribute].has(value) && !state.include[attribute].length);
  });
  return item;
}

function group(attribute, vocabulary, counts) {
  const values = vocabulary.values(attribute);
  const families = [...new Set(values.map((e) => e.category))];
  // Families help where there are many values; a family of one needs no heading of its own.
  const split = attribute === "model" || attribute === "extractor";
  const list = (entries) => h("ul", { class: "facets" },
    entries.map((e) => facet(attribute, e, counts.get(`${attribute}:${e.value}`) ?? 0)));
  const chosen = h("span", { class: "chosen" });
  updates.push(() => {
    const words = [
      ...vocabulary.gathered(attribute, state.include[attribute]).map(([label]) => label),
      ...state.exclude[attribute].map((v) => `not ${v}`),
    ];
    chosen.textContent = words.length ? words.join(", ") : "any";
    chosen.classList.toggle("set", words.length > 0);
  });
  const open = state.include[attribute].length + state.exclude[attribute].length > 0
    || (OPEN_AT_FIRST.has(attribute) && matchMedia("(min-width: 1141px)").matches);
  return h("details", { class: "group", open, "data-group": attribute },
    h("summary", {}, ATTRIBUTE_NAMES[attribute], chosen),
    split
      ? families.map((family) => [
        family && h("p", { class: "family" }, family),
        list(values.filter((e) => e.category === family)),
      ])
      : list(values));
}

function limit(name) {
  const words = LIMIT_NAMES[name];
  const input = h("input", {
    type: "number", id: name, min: "0", max: words.smaller, step: "any", inputmode: "decimal", placeholder: "any",
    onchange: () => {
      const text = ofUnit(name, input.value);
      if (input.checkValidity() && text !== state.limits[name]) setLimit(name, text);
      else input.reportValidity();
    },
  });
  updates.push(() => {
    if (document.activeElement !== input || input.value === "") input.value = inUnit(name, state.limits[name]);
  });
  return h("label", { for: name }, words.name, input, h("span", { class: "unit" }, words.unit));
}

/** A group of which all that is chosen must hold; entries: [[value, words], ...] */
function listGroup(list, entries) {
  const chosen = h("span", { class: "chosen" });
  updates.push(() => {
    const asked = state.lists[list];
    chosen.textContent = asked.length ? asked.join(", ") : "any";
    chosen.classList.toggle("set", asked.length > 0);
  });
  const item = ([value, words]) => {
    const button = h("button", {
      type: "button", class: "facet-include", "data-list": list, "data-value": value, title: words || null,
      "aria-label": `${LIST_NAMES[list].name} ${value}${words ? `: ${words}` : ""}`,
      onclick: () => setListed(list, value, !state.lists[list].includes(value)),
    }, h("b", {}, value), words && h("span", { class: "name" }, words));
    updates.push(() => button.setAttribute("aria-pressed", String(state.lists[list].includes(value))));
    return h("li", { class: "facet" }, button);
  };
  return h("details", { class: "group", open: state.lists[list].length > 0, "data-group": list },
    h("summary", {}, LIST_NAMES[list].name, chosen),
    h("ul", { class: "facets" }, entries.map(item)));
}

/** Build the panel once; counts: Map "attribute:value" -> number of studies. */
export function buildRequirements(vocabulary, counts) {
  const form = byId("requirements-form");
  form.addEventListener("submit", (event) => event.preventDefault());
  const limits = h("details", { class: "group", open: true }, h("summary", {}, "Limits"),
    h("div", { class: "limits" }, LIMITS.map(limit)));
  form.replaceChildren(limits, listGroup("survive", Object.entries(HAZARDS)),
    ...ATTRIBUTES.map((a) => group(a, vocabulary, counts)), listGroup("properties", PROPERTIES.map((p) => [p])),
    listGroup("exclude_needs", Object.entries(NEEDS)));
  form.removeAttribute("aria-busy");
  byId("reset").addEventListener("click", () => {
    reset();
    byId("requirements").focus();
  });
}

/** Show the state; present: attribute -> Set of the values that occur in the answer, or null. */
export function updateRequirements(present) {
  for (const update of updates) update(present);
  byId("reset").disabled = !required();
}
