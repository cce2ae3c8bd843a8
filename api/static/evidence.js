/* Three kinds of evidence, each in a cell of its own: advised, proposed, measured. */

import { h } from "./dom.js";
import { address } from "./service.js";
import { ATTRIBUTES, state } from "./state.js";
import { degrees, number, percent, studiesCount, times, wide } from "./wording.js";

export const KINDS = [
  ["advised", "The survey advises it"], ["proposed", "Studies proposed it"], ["measured", "Measured here"],
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
  if (!advice.length) return none(ATTRIBUTES.some((a) => ["task", "accuracy"].includes(a) && state.include[a].length) ? "not for what is asked" : "not advised");
  return [h("strong", {}, `for ${advisedFor(advice)}`), below("in ", [...new Set(advice.map((a) => a.section))].map((s, i) => [i > 0 && ", ", section(s)]))];
}

export const studyLink = (key) => h("a", { href: `/studies/${encodeURIComponent(key)}` }, key);

/** Number of studies and the first of them. */
export function proposedContent(keys, most) {
  if (!keys.length) return notProposed();
  return [h("strong", {}, studiesCount(keys.length)),
    below(keys.slice(0, most).map((key, i) => [i > 0 && ", ", studyLink(key)]), keys.length > most && ` and ${keys.length - most} more`)];
}

/** Said of what no study stands for; where studies are asked for, only of those. */
export function notProposed() {
  return OF_STUDIES.some((a) => state.include[a].length || state.exclude[a].length)
    ? h("span", { class: "novel", title: "No study that meets the requirements stands for it" }, "in no such study")
    : h("span", { class: "novel", title: "No study stands for it" }, "not in the literature");
}

/** Page of the board that a score stands on. */
export function boardAddress({ dataset, condition }) {
  return `${address(`/datasets/${encodeURIComponent(dataset)}`, { condition })}#board`;
}

/** What errs far less on the part of the samples that it answers. */
export function finerContent(m) {
  if (!m?.finer) return null;
  const { dataset, extractor, model, error_deg: error, availability } = m.finer;
  return h("div", { class: "below finer" }, h("strong", {},
      h("a", { class: "term", href: "/glossary#term-finer", title: "far finer on the part it answers" }, "Far finer on the part it answers"), ": "),
    h("a", { href: `/datasets/${encodeURIComponent(dataset)}#board`, title: "The board it stands on" }, degrees(error)),
    ` on ${percent(availability)} of the samples (${extractor} → ${model})`);
}

/** The error, where it holds, and all that stands beside it. */
export function measuredContent(m) {
  if (!m) return none("not measured");
  const { nominal, units } = m;
  const narrowed = m.error_deg !== nominal.rms_deg;
  return [
    m.error_deg === null
      ? h("strong", {}, "answers too seldom")
      : [h("strong", {}, h("a", { href: boardAddress(m), title: "The board it stands on" }, degrees(m.error_deg))),
        h("span", {}, m.field_deg === null ? " over all its directions" : ` over ${wide(m.field_deg)}`)],
    below(`${m.dataset}, ${m.condition}`),
    below(narrowed && (m.error_deg === null ? `nominal ${degrees(nominal.rms_deg)} where it answers, ` : `nominal ${degrees(nominal.rms_deg)}, `),
      h("span", { title: `Nominal error over the whole field, over the Cramér–Rao bound of ${degrees(nominal.bound_deg)}` }, `${times(nominal.over_bound)} the bound`)),
    below(`answers ${percent(m.availability)}`, units && units.count > 1 && `; ${units.count} units ${number(units.least_deg)}–${degrees(units.largest_deg)}`),
    units && units.meeting !== null && below(`${units.meeting} of ${units.of} units meet it on a bench of ${degrees(m.bench_deg)}; own error ${degrees(m.own_deg)}`),
    m.needs.length > 0 && below(`also reads ${m.needs.join(", ")}`),
  ];
}
