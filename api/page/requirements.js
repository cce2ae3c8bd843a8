/* The panel of requirements: every value can be required or excluded, limits are numbers. */

import { byId, h } from "./dom.js";
import { ATTRIBUTES, LIMITS, reset, set, setLimit, standing, state } from "./state.js";
import { ATTRIBUTE_NAMES, LIMIT_NAMES } from "./wording.js";

const OPEN_AT_FIRST = new Set(["task", "detector"]);
const updates = []; // one function an element that shows the state

function facet(attribute, entry, count) {
  const { value, name } = entry;
  const spoken = name && name !== value ? `${value}, ${name}` : value;
  const include = h("button", {
    type: "button", class: "facet-include", "aria-label": `${spoken}: require. ${count} studies`,
    "data-attribute": attribute, "data-value": value, title: name,
    onclick: () => set(attribute, value, standing(attribute, value) === "include" ? null : "include"),
  }, h("b", {}, value), name !== value && h("span", { class: "name" }, name), h("span", { class: "count" }, String(count)));
  const exclude = h("button", {
    type: "button", class: "facet-exclude", "aria-label": `${spoken}: exclude`, title: `Exclude ${value}`,
    onclick: () => set(attribute, value, standing(attribute, value) === "exclude" ? null : "exclude"),
  }, "⊘");
  const item = h("li", { class: "facet" }, include, exclude);
  updates.push((present) => {
    const now = standing(attribute, value);
    item.dataset.standing = now ?? "none";
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
    || (OPEN_AT_FIRST.has(attribute) && matchMedia("(min-width: 901px)").matches);
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
    type: "number", id: name, min: "0", step: "any", inputmode: "decimal", placeholder: "any",
    onchange: () => {
      if (input.checkValidity() && input.value !== state.limits[name]) setLimit(name, input.value);
      else input.reportValidity();
    },
  });
  updates.push(() => {
    if (document.activeElement !== input || input.value === "") input.value = state.limits[name];
  });
  return h("label", { for: name }, words.name, input, h("span", { class: "unit" }, words.unit));
}

/** Build the panel once; counts: Map "attribute:value" -> number of studies. */
export function buildRequirements(vocabulary, counts) {
  const form = byId("requirements-form");
  form.addEventListener("submit", (event) => event.preventDefault());
  const limits = h("details", { class: "group", open: true }, h("summary", {}, "Limits"),
    h("div", { class: "limits" }, LIMITS.map(limit)));
  form.replaceChildren(limits, ...ATTRIBUTES.map((a) => group(a, vocabulary, counts)));
  form.removeAttribute("aria-busy");
  byId("reset").addEventListener("click", () => {
    reset();
    byId("requirements").focus();
  });
}

/** Show the state; present: attribute -> Set of the values that occur in the answer, or null. */
export function updateRequirements(present) {
  for (const update of updates) update(present);
  const asked = ATTRIBUTES.some((a) => state.include[a].length || state.exclude[a].length)
    || LIMITS.some((l) => state.limits[l] !== "");
  byId("reset").disabled = !asked;
}
