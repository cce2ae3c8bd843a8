/* A study as evidence: bibliography, implementation, and the basis of every value. */

import { copyable, h, problemNotice } from "./dom.js";
import { getOnce } from "./service.js";
import { ATTRIBUTE_NAMES, BASES, IDENTITIES } from "./wording.js";

const known = (text) => text !== null && text !== undefined && text !== "";

function bibliography(study) {
  return h("p", { class: "note" }, [
    study.authors, known(study.year) && String(study.year), study.venue,
  ].filter(known).filter(Boolean).join(" · "));
}

function links(study) {
  const record = `/studies/${encodeURIComponent(study.key)}`;
  return h("p", { class: "links" },
    known(study.doi) && h("a", { href: `https://doi.org/${study.doi}`, rel: "noreferrer" }, `doi:${study.doi}`),
    !known(study.doi) && /^https?:/.test(study.url ?? "") && h("a", { href: study.url, rel: "noreferrer" }, "Record"),
    h("a", { href: record }, "Details"),
    h("span", { class: "state", title: IDENTITIES[study.identity] }, `identity ${study.identity}`),
    h("span", { class: "state", title: study.sentence }, study.grade === "none" ? "cannot run" : study.grade));
}

/** "source" as a link where it is an address. */
function source(text) {
  if (!known(text)) return "–";
  return /^https?:\/\//.test(text) ? h("a", { href: text, rel: "noreferrer" }, new URL(text).hostname) : text;
}

/** "data set (condition) error", or the reason for none. */
function measured(score) {
  const at = `${score.dataset} (${score.condition})`;
  if (score.rms_deg !== null) return `${at} ${Number(score.rms_deg.toPrecision(3))} deg`;
  return `${at} ${score.status === null ? "not measured yet" : "no error"}`;
}

function provenance(detail) {
  const values = detail.attributes;
  const reported = [detail.reported_accuracy, detail.reported_precision]
    .filter(known).map((one) => `${one.label} ${one.value_deg} deg`);
  const cell = (label, ...content) => h("td", { role: "cell", "data-label": label }, h("span", {}, ...content));
  return h("div", { class: "provenance" },
    h("table", { class: "stacks", role: "table" },
      h("caption", {}, `Sources of the values of ${detail.key}`),
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, ["Attribute", "Value", "Basis", "Source", "Note"].map((t) => h("th", { scope: "col", role: "columnheader" }, t)))),
      h("tbody", { role: "rowgroup" }, values.map((v) => h("tr", { role: "row" },
        cell("Attribute", ATTRIBUTE_NAMES[v.attribute] ?? v.attribute),
        cell("Value", known(v.value) ? v.value : "–"),
        cell("Basis", h("span", { class: "basis", title: BASES[v.basis] }, v.basis)),
        cell("Source", source(v.source)),
        cell("Note", v.note ?? ""))))),
    h("p", {}, reported.length
      ? `Reported by the study of its own sensor: ${reported.join(", ")}.`
      : "No reported accuracy or precision known."),
    detail.pipelines.length > 0 && h("div", {}, h("p", {}, "Implementation in the Atlas, with errors on simulated sensors:"),
      h("ul", {}, detail.pipelines.slice(0, 12).map((p) => h("li", {},
        `${p.detector} · ${p.mask} · ${p.extractor} + ${p.model}: ${p.scores.map(measured).join(", ")}`,
        ...Object.entries(p.assumed).map(([part, rule]) => h("p", { class: "note" },
          `${ATTRIBUTE_NAMES[part] ?? part} ${p.basis[part]}: ${rule}`))))),
      copyable(`sunatlas run ${detail.key} --format json`, `the command that runs ${detail.key}`)),
    detail.gaps.length > 0 && h("div", {}, h("p", {}, "Not implemented"),
      h("ul", {}, detail.gaps.map((g) => h("li", {}, `${ATTRIBUTE_NAMES[g.attribute] ?? g.attribute}${known(g.value) ? ` ${g.value}` : ""}: ${g.reason}`)))));
}

function evidence(key) {
  const place = h("div", { "aria-live": "polite" }, h("p", { class: "muted" }, "Loading…"));
  const load = () => getOnce(`/v1/studies/${encodeURIComponent(key)}`).then(
    (detail) => place.replaceChildren(provenance(detail)),
    (problem) => place.replaceChildren(problemNotice(problem, load)));
  load();
  return place;
}

/** A study with its evidence behind a disclosure. */
export function studyEntry(key, study) {
  if (!study) return h("li", { class: "study" }, h("a", { href: `/studies/${encodeURIComponent(key)}` }, key));
  const disclosure = h("details", { class: "flow-links" }, h("summary", {}, `Basis of each value of ${key}`));
  disclosure.addEventListener("toggle", () => disclosure.append(evidence(key)), { once: true });
  return h("li", { class: "study" },
    h("p", { class: "study-title" }, known(study.title) ? study.title : `${key} (title not known)`, " ", h("span", { class: "muted note" }, key)),
    bibliography(study), links(study), disclosure);
}
