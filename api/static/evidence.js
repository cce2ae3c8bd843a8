/* Three kinds of evidence, a cell each: advised, used in studies, measured. */

import { h } from "./dom.js";
import { address } from "./service.js";
import { ATTRIBUTES, state } from "./state.js";
import { degrees, number, percent, studiesCount, times, wide } from "./wording.js";

export const KINDS = [
  ["advised", "Advised by the survey"], ["proposed", "Used in studies"], ["measured", "Measured here"],
];

const OF_STUDIES = ["task", "error", "accuracy"];

/** A cell of one kind of evidence. */
export function evidenceCell(kind, ...content) {
  const [, label] = KINDS.find(([name]) => name === kind);
  return h("td", { role: "cell", class: `kind ${kind}`, "data-label": label }, h("div", {}, ...content));
}

export const below = (...content) => h("div", { class: "below" }, ...content);
const none = (text, title) => h("span", { class: "muted", title }, text);

/** Section of the survey, by the label that its source gives it. */
const section = (label) => h("a", { class: "term", href: "/glossary#term-survey-label", title: "label in the survey's source" }, label);

/** What advice is for: tasks by name, classes of accuracy as such. */
export function advisedFor(advice) {
  const of = (requirement) => [...new Set(advice.filter((a) => a.requirement === requirement).map((a) => a.value))];
  const [tasks, classes] = [of("task"), of("accuracy")];
  return [tasks.join(", "), classes.length && `${classes.length > 1 ? "classes" : "class"} ${classes.join(", ")}`].filter(Boolean).join("; ");
}

export function advisedContent(advice) {
  if (!advice.length) return none(ATTRIBUTES.some((a) => ["task", "accuracy"].includes(a) && state.include[a].length) ? "not for these requirements" : "not advised");
  return [h("strong", {}, `for ${advisedFor(advice)}`), below("in ", [...new Set(advice.map((a) => a.section))].map((s, i) => [i > 0 && ", ", section(s)]))];
}

export const studyLink = (key) => h("a", { href: `/studies/${encodeURIComponent(key)}` }, key);

/** Number of studies and the first of them. */
export function proposedContent(keys, most) {
  if (!keys.length) return notProposed();
  return [h("strong", {}, studiesCount(keys.length)),
    below(keys.slice(0, most).map((key, i) => [i > 0 && ", ", studyLink(key)]), keys.length > most && ` and ${keys.length - most} more`)];
}

/** Shown where no study, or no study that meets the requirements, used it. */
export function notProposed() {
  return OF_STUDIES.some((a) => state.include[a].length || state.exclude[a].length)
    ? h("span", { class: "novel", title: "No study that meets the requirements used it" }, "in no study that meets the requirements")
    : h("span", { class: "novel", title: "No study used it" }, "not in the literature");
}

/** Page of the leaderboard of a score. */
export function boardAddress({ dataset, condition }) {
  return `${address(`/datasets/${encodeURIComponent(dataset)}`, { condition })}#board`;
}

/** A pipeline below 95 % availability with less than a third of the error. */
export function finerContent(m) {
  if (!m?.finer) return null;
  const { dataset, extractor, model, error_deg: error, availability } = m.finer;
  return h("div", { class: "below finer" }, h("strong", {},
      h("a", { class: "term", href: "/glossary#term-finer", title: "lower error at lower availability" }, "Lower error at lower availability"), ": "),
    h("a", { href: `/datasets/${encodeURIComponent(dataset)}#board`, title: "Leaderboard of this data set" }, degrees(error)),
    ` at ${percent(availability)} (${extractor} + ${model})`);
}

/** RMS error with its field of view, data set, bound and availability. */
export function measuredContent(m) {
  if (!m) return none("not measured");
  const { nominal, units } = m;
  const narrowed = m.error_deg !== nominal.rms_deg;
  return [
    m.error_deg === null
      ? h("strong", {}, "availability below 95 %")
      : [h("strong", {}, h("a", { href: boardAddress(m), title: "Leaderboard of this data set" }, degrees(m.error_deg))),
        h("span", {}, m.field_deg === null ? " over all directions" : ` over ${wide(m.field_deg)}`)],
    below(`${m.dataset}, ${m.condition}`),
    below(narrowed && (m.error_deg === null ? `nominal ${degrees(nominal.rms_deg)} at that availability, ` : `nominal ${degrees(nominal.rms_deg)}, `),
      h("span", { title: `Nominal error over the whole field, divided by the Cramér–Rao bound of ${degrees(nominal.bound_deg)}` }, `${times(nominal.over_bound)} the bound`)),
    below(`availability ${percent(m.availability)}`, units && units.count > 1 && `; ${units.count} units ${number(units.least_deg)}–${degrees(units.largest_deg)}`),
    units && units.within_limit !== null && below(`${units.within_limit} of ${units.of} units meet it with a calibration bench of ${degrees(m.bench_deg)}; own error ${degrees(m.own_deg)}`),
    m.needs.length > 0 && below(`also needs ${m.needs.join(", ")}`),
  ];
}
