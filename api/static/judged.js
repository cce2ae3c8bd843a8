/* Requirements checked on a leaderboard: which its pipelines meet, which cannot be checked there. */

import { h } from "./dom.js";
import { state } from "./state.js";
import { limitText, plural, wide } from "./wording.js";

const share = (rows, met) => `${rows.filter(met).length} of ${plural(rows.length, "pipeline")}`;

function error(rows, limit, card) {
  const asked = Number(state.limits.min_fov_deg) || null;
  const half = rows.find((r) => r.half_fov_deg !== null)?.half_fov_deg ?? null;
  const over = asked && half !== null && asked < 2 * half
    ? " (over the whole field here; the answer uses the required field of view)" : "";
  const scored = rows.filter((r) => r.rms_deg !== null);
  if (!scored.length) return `cannot be checked: no pipeline is scored on ${card.name} under this condition`;
  return `${share(rows, (r) => r.rms_deg !== null && r.rms_deg <= limit)} meet it${over}`;
}

function field(rows, limit) {
  const half = rows.find((r) => r.half_fov_deg !== null)?.half_fov_deg ?? null;
  if (half === null) return "met: this sensor sees all directions";
  return 2 * half >= limit ? `met: its field of view is ${wide(2 * half)}` : `not met: its field of view is ${wide(2 * half)}`;
}

function availability(rows, limit) {
  const known = rows.filter((r) => r.availability !== null);
  return known.length ? `${share(rows, (r) => r.availability !== null && r.availability >= limit)} meet it`
    : "cannot be checked: no pipeline has an availability under this condition";
}

function latency(rows, limit) {
  const timed = rows.filter((r) => r.latency_us !== null && r.latency_us !== undefined);
  return timed.length ? `${share(rows, (r) => timed.includes(r) && r.latency_us <= limit)} meet it`
    : "cannot be checked: no pipeline here is timed";
}

const JUDGES = { max_error_deg: error, min_fov_deg: field, min_availability: availability, max_latency_us: latency };
const WORDS = {
  max_error_deg: "Error at most", min_fov_deg: "Field of view at least",
  min_availability: "Availability at least", max_latency_us: "Latency at most",
};

/** List the requirements with the number of pipelines that meet each; empty without requirements. */
export function judged({ rows, card, condition }) {
  const limits = Object.keys(JUDGES).filter((name) => state.limits[name] !== "");
  const hazards = state.lists.survive;
  if (!limits.length && !hazards.length) return "";
  return h("div", { class: "finding judged" }, h("h3", {}, `Requirements on ${card.name}, ${condition}`),
    h("ul", { class: "bullets" },
      limits.map((name) => h("li", {}, `${WORDS[name]} ${limitText(name, state.limits[name])}: ${JUDGES[name](rows, Number(state.limits[name]), card)}.`)),
      hazards.map((hazard) => h("li", {}, `Must tolerate ${hazard}: ${survived(hazard, condition, card)}.`))));
}

function survived(hazard, condition, card) {
  if (condition.includes(hazard)) return "tested by this condition";
  const there = card.conditions.some((c) => c.includes(hazard));
  return `not tested by this condition; ${there ? "another condition of this data set tests it" : "no condition of this data set tests it"}`;
}
