/* Leaderboard of a data set: every pipeline, with the Cramér–Rao bound. */

import { byId, choice, coded, copyable, h, problemNotice } from "./dom.js";
import { judged } from "./judged.js";
import { address, getAll, getJson, saveCsv } from "./service.js";
import { show, state } from "./state.js";
import { degrees, number, percent, plural, studiesCount, times } from "./wording.js";

const RANK = { field: "rank", name: "Rank", write: (rank, row) => (rank === null ? "–" : `${rank}${row.tied ? "=" : ""}`), title: "By own error; pipelines below 95 % availability rank last. 2= is a tie: a paired test over sensor units cannot separate the pipelines" };
const NAMES = [{ field: "extractor", name: "Extractor", text: true }, { field: "model", name: "Model", text: true, write: studies }];
const ERROR = { field: "own_deg", name: "Own error", write: (value, row) => [degrees(value), units(row)], title: "RMS error calibrated with true directions, geometric mean over sensor units" };
const BENCH = { field: "on_bench_deg", name: "On a bench", write: degrees, title: "Error expected when calibrated on the standard bench" };
const BOUND = {
  field: "over_bound", name: "× bound", title: "RMS error divided by the Cramér–Rao bound of the same samples for a known sensor unit",
  write: times,
};
const ANSWERED = {
  field: "availability", name: "Availability", title: "Share of observable samples with an answer. False detections: share of the other samples with an answer, such as those in eclipse",
  write: (share, row) => [percent(share), row.false_sun > 0 && h("div", { class: "below" }, `${percent(row.false_sun)} false detections`)],
};
const TIME = { field: "latency_us", name: "Time", write: (us) => (us === null ? "–" : `${number(us)} µs`), title: "Extraction and prediction of one sample of a batch on one core of the machine that /v1/leaderboard names in timed_on" };
const WHOLE = "";
const FIELDS = [10, 20, 30, 40, 50, 60, 70, 90, 180];

/** Number of studies that used a pipeline on such a sensor. */
function studies(row) {
  return row.studies.length > 0 && h("div", { class: "below", title: `Used on such a sensor by ${row.studies.join(", ")}, or the nearest method to theirs` }, studiesCount(row.studies.length));
}

/** Columns that have values in the rows shown. */
function columns() {
  const { rows, field } = shown;
  const errors = field === WHOLE ? [ERROR, ...(rows.some((r) => r.on_bench_deg > 0) ? [BENCH] : []), BOUND]
    : [{ field: "field_rms_deg", name: `RMS within ${field}°`, write: degrees, title: "Weighted by the solid angle of each ring of the field" }, ERROR];
  return [RANK, ...NAMES, ...errors, ANSWERED, ...(rows.some((r) => r.latency_us > 0) ? [TIME] : [])];
}

/** Smallest and largest error of the units a pipeline was scored on. */
const units = (row) => row.low_deg > 0 && h("div", { class: "below", title: `On ${row.unit_rms_deg.length} sensor units` },
  `${number(row.low_deg)}–${degrees(row.high_deg)}`);
const errorOf = (row) => (row.field_deg ? row.field_rms_deg : row.own_deg);

const SCALE = "Error, log scale";
const FIRST = 16;
const MOST_ENTRIES = 8; // of a list of lists, such as the apertures of a mask

let shown = null; // what the rows on screen belong to
let turn = 0;

/** Bound and range over units, for errors over the whole field. */
const limits = (row) => (row.field_deg ? [] : [row.bound_deg, row.low_deg, row.high_deg]);

/** A logarithmic scale that all rows share: position of a number from 0 to 1, and its ticks. */
const scaleOf = (rows) => {
  const values = rows.flatMap((r) => [errorOf(r), ...limits(r)]).filter((x) => x > 0 && Number.isFinite(x));
  if (!values.length) return null;
  const low = Math.floor(Math.log10(Math.min(...values) * 0.999));
  const high = Math.max(low + 1, Math.ceil(Math.log10(Math.max(...values))));
  const at = (x) => Math.min(1, Math.max(0, (Math.log10(x) - low) / (high - low)));
  const ticks = Array.from({ length: high - low + 1 }, (_, i) => 10 ** (low + i));
  const step = Math.ceil((high - low) / 2); // labels of more decades than two would run together
  return { at, ticks, labelled: ticks.filter((_, i) => (high - low - i) % step === 0) };
};

function bar(row, scale) {
  const value = errorOf(row);
  if (!scale || !(value > 0)) return h("span", { class: "muted" }, "–");
  const error = scale.at(value);
  const [limit = null, low = null, high = null] = limits(row).map((x) => (x > 0 ? scale.at(x) : null));
  const from = limit ?? error;
  const bound = row.field_deg ? "" : ` against a bound of ${degrees(row.bound_deg)}`;
  return h("div", { class: "scale", role: "img", "aria-label": `${degrees(value)}${bound}` },
    scale.ticks.map((t) => h("i", { class: "tick", css: { "--at": scale.at(t) } })),
    h("i", { class: "span", css: { "--from": Math.min(from, error), "--to": Math.max(from, error) } }),
    low !== null && high !== null && h("i", { class: "units", css: { "--from": low, "--to": high } }),
    h("i", { class: "dot", css: { "--at": error } }),
    limit !== null && h("i", { class: "limit", css: { "--at": limit } }));
}

/** Whether rows stand as the service lists them: the best of each extractor first, by rank. */
const asListed = () => state.board_sort === RANK.field && state.board_order === "ascending";

function sorted(rows) {
  const { board_sort: sort, board_order: order } = state;
  if (asListed()) return rows;
  const sign = order === "descending" ? -1 : 1;
  const missing = (x) => x === null || x === undefined || x === "" || Number.isNaN(x);
  return [...rows].sort((a, b) => {
    const [x, y] = [a[sort], b[sort]];
    if (missing(x) || missing(y)) return missing(x) - missing(y); // what failed stands last, whatever the order
    return sign * (typeof x === "string" ? x.localeCompare(y) : x - y);
  });
}

function heading(column) {
  const active = state.board_sort === column.field;
  return h("th", {
    scope: "col", role: "columnheader", class: !column.text && "number", title: column.title,
    "aria-sort": active ? state.board_order : null,
  }, h("button", {
    type: "button", "data-sort": column.field,
    onclick: () => show({ board_sort: column.field, board_order: active && state.board_order === "ascending" ? "descending" : "ascending" }),
  }, column.name));
}

function evidence(row) {
  const address_of = address("/v1/results", { dataset: row.dataset, condition: row.condition, extractor: row.extractor, model: row.model });
  const facts = Object.entries(row).filter(([, v]) => v !== null && v !== "" && typeof v !== "object");
  return h("div", { class: "evidence" },
    h("dl", { class: "facts" }, facts.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, String(value))))),
    h("p", { class: "links" }, h("a", { href: address_of }, "Score row (JSON)")));
}

function tableRow(row, shownColumns, scale, i) {
  const id = `score-${i}`;
  const detail = h("tr", { class: "detail", id, role: "row", hidden: true });
  const expand = h("button", {
    type: "button", class: "expand", "aria-expanded": false, "aria-controls": id, "aria-label": `Score of ${row.extractor} with ${row.model}`,
    onclick: () => {
      if (!detail.firstChild) detail.append(h("td", { colspan: String(shownColumns.length + 2), role: "cell" }, evidence(row)));
      detail.hidden = !detail.hidden;
      expand.setAttribute("aria-expanded", String(!detail.hidden));
    },
  }, "Score");
  const failed = row.status !== "ok";
  const taxonomy = (field) => row[`${field}_taxonomy`] && row[`${field}_taxonomy`].toLowerCase() !== row[field].toLowerCase() && row[`${field}_taxonomy`];
  const cell = (c) => h("td", { role: "cell", "data-label": c.name, class: c.text ? "word" : c === RANK ? "number rank" : "number" },
    c.text ? [h("a", { class: "value", href: `/algorithms/${encodeURIComponent(row[c.field])}`, title: taxonomy(c.field) || null }, row[c.field]), c.write?.(row)] : c.write(row[c.field], row));
  const leading = shownColumns.filter((c) => c.text || c === RANK);
  const numbers = shownColumns.filter((c) => !leading.includes(c));
  return [h("tr", { role: "row", class: "score" },
    leading.map(cell),
    failed
      ? h("td", { role: "cell", class: "wide failed note", colspan: String(numbers.length + 1), "aria-colspan": numbers.length + 1 },
        `${row.status}: ${row.reason || "no reason stored"}`)
      : [numbers.map(cell), h("td", { role: "cell", class: "wide" }, bar(row, scale))],
    h("td", { role: "cell", class: "number last" }, expand)), detail];
}

/** Leaves of a nested object as [dotted name, text]; lists of plain values are one leaf. */
function leaves(value, name = "") {
  if (value === null || value === undefined) return [];
  if (Array.isArray(value)) {
    const nested = value.some((v) => typeof v === "object" && v !== null);
    if (nested && value.length > MOST_ENTRIES) return [[name, `${value.length} entries, in the JSON`]];
    return nested
      ? value.flatMap((v, i) => leaves(v, `${name}[${i}]`))
      : [[name, value.join(", ")]];
  }
  if (typeof value !== "object") return [[name, String(value)]];
  return Object.entries(value).flatMap(([k, v]) => leaves(v, name ? `${name}.${k}` : k));
}

/** Its picture, and what the numbers depend on: geometry, splits, regime, seeds, parameters,
 * last those that the condition has instead. */
function cardParts(card, condition, url) {
  const { units, splits, regime, seeds, parameters } = card;
  const own = card.setups?.[condition] ?? {};
  const geometry = own.geometry ?? card.geometry;
  const facts = [...leaves({ units, geometry, splits, regime, seeds, parameters }), ...leaves(own.parameters, condition)];
  return [
    h("img", { class: "preview", src: card.preview, width: 1000, alt: `Nominal samples of ${card.name}: ${card.observation}` }),
    h("dl", { class: "facts card-facts" }, facts.filter(([name]) => !name.endsWith(".type")).map(([name, value]) =>
      h("div", {}, h("dt", {}, name), h("dd", {}, value)))),
    h("p", { class: "links" }, h("a", { href: url }, `Description of ${card.name} (JSON)`))];
}

/** The whole card, asked for when it is opened. */
function cardOf(card, condition) {
  const url = `/v1/datasets/${encodeURIComponent(card.name)}`;
  const body = h("div", {});
  const load = async () => {
    body.replaceChildren(h("p", { class: "loading" }, "Loading the description…"));
    try {
      body.replaceChildren(...cardParts(await getJson(url), condition, url));
    } catch (problem) {
      body.replaceChildren(problemNotice(problem, load));
    }
  };
  return h("details", {
    class: "flow-links",
    ontoggle: (event) => { if (event.target.open && !body.firstChild) load(); },
  }, h("summary", {}, `Description of ${card.name}: a picture and all parameters`), body);
}

function draw() {
  const { rows, dataset, condition, card, field } = shown;
  const shownColumns = columns();
  const ranged = rows.some((r) => r.low_deg > 0);
  const scale = scaleOf(rows);
  const bound = rows.find((r) => r.bound_deg > 0)?.bound_deg ?? card?.bounds?.[condition];
  const unknown = rows.find((r) => r.bound_unit_deg > 0);
  const url = address(`/v1/leaderboard/${encodeURIComponent(dataset)}`, { condition, field_deg: field || null, limit: 500 });
  byId("board-card").replaceChildren(h("div", { class: "dataset-card" },
    card && h("p", {}, coded(card.description)),
    card?.stands_for?.idealisation && h("p", {}, h("strong", {}, "Idealised sensor"), `: ${card.stands_for.idealisation}`),
    card?.setups?.[condition]?.description && h("p", {}, h("strong", {}, condition), ": ", coded(card.setups[condition].description)),
    h("p", { class: "bound-line" }, "Cramér–Rao bound: ", h("strong", {}, degrees(bound)), " RMS",
      unknown && [" · for a unit known only through its dark and flat frames ", h("strong", {}, degrees(unknown.bound_unit_deg))],
      card && [` · version ${card.version}`, card.follows?.length > 0 && [" · based on ", card.follows.map((k, i) => [i > 0 && ", ", h("a", { href: `/studies/${encodeURIComponent(k)}` }, k)])]]),
    h("div", { class: "links" }, h("a", { href: `/datasets/${encodeURIComponent(dataset)}?condition=${encodeURIComponent(condition)}` }, "Data set page"), h("a", { href: url }, "JSON"),
      h("button", { type: "button", onclick: () => saveCsv(url, `${dataset}-${condition}.csv`) }, "CSV"),
      card?.follows?.[0] && copyable(`sunatlas run ${card.follows[0]} --format json`, "the command that runs the study it is based on")),
    card && cardOf(card, condition)));
  byId("board-judged").replaceChildren(judged(shown));
  const body = byId("board-body");
  const listed = sorted(rows).slice(0, shown.all ? rows.length : FIRST);
  if (!rows.length) {
    body.replaceChildren(h("div", { class: "notice" }, h("p", {}, "No pipeline is scored on this data set under this condition yet. ",
      h("code", {}, "sunatlas leaderboard update"), " measures the missing scores.")));
    return;
  }
  body.replaceChildren(
    h("div", { class: "legend" },
      h("span", {}, h("i", { class: "key-dot" }), field === WHOLE ? "RMS error, on a logarithmic scale" : `RMS error within ${field}° of the boresight, on a logarithmic scale`),
      field === WHOLE && h("span", {}, h("i", { class: "key-limit" }), "Cramér–Rao bound"),
      field === WHOLE && ranged && h("span", {}, h("i", { class: "key-units" }), "range over sensor units; = marks a tie in a paired test over them"),
      field !== WHOLE && rows[0].half_fov_deg !== null && rows[0].half_fov_deg < Number(field) && h("span", {}, `The field of view of this sensor ends at ${degrees(rows[0].half_fov_deg)}`),
      field === WHOLE && !ranged && h("span", {}, "Ranks of this condition are from one sensor unit"),
      asListed() && h("span", {}, "The best pipeline of each extractor first, then the others"),
      shownColumns.includes(TIME) && h("span", {}, "Time: on the machine of the published times")),
    h("div", { class: "sort-narrow" }, choice("Sort by", "sort-narrow", shownColumns.map((c) => [c.field, c.name]), state.board_sort, (field) => show({ board_sort: field, board_order: "ascending" }))),
    h("table", { class: "stacks board", role: "table", "aria-labelledby": "leaderboard-title" },
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, shownColumns.map(heading),
        h("th", { scope: "col", role: "columnheader" }, SCALE, scale && h("span", { class: "scale-head", "aria-hidden": true },
          scale.labelled.map((t) => h("span", { css: { "--at": scale.at(t) } }, `${number(t, 1)}°`)))),
        h("th", { scope: "col", role: "columnheader" }, h("span", { class: "visually-hidden" }, "Score")))),
      h("tbody", { role: "rowgroup" }, listed.map((r, i) => tableRow(r, shownColumns, scale, i)))),
    listed.length < rows.length
      ? h("button", {
        type: "button", class: "more",
        onclick: () => {
          shown.all = true;
          draw();
          body.querySelectorAll(".expand")[FIRST]?.focus();
        },
      }, `Show all ${rows.length} pipelines`)
      : "");
}

/** Sort what is on screen, keeping the keyboard on the heading. */
export function resort() {
  if (!shown) return;
  const focused = document.activeElement?.dataset?.sort;
  draw();
  if (focused) byId("board-body").querySelector(`[data-sort="${focused}"]`)?.focus();
  const column = columns().find((c) => c.field === state.board_sort);
  byId("board-status").textContent = `Sorted by ${column?.name ?? state.board_sort}, ${state.board_order}.`;
}

let followed = { dataset: "", condition: "" };

/**
 * Let the board follow what is asked: unless one is chosen, that on which the first architecture
 * of the answer was measured, under the condition it was judged by.
 */
export function followAnswer(answer, datasets) {
  const measured = answer?.architectures.find((a) => a.best.measured)?.best.measured;
  const next = measured ? { dataset: measured.dataset, condition: measured.condition } : { dataset: "", condition: "" };
  const changed = next.dataset !== followed.dataset || next.condition !== followed.condition;
  followed = next;
  if (changed && datasets.length && shown && !state.dataset) showLeaderboard(datasets);
  else if (shown) byId("board-judged").replaceChildren(judged(shown));
}

export async function showLeaderboard(datasets) {
  const mine = ++turn;
  const body = byId("board-body");
  if (!datasets.length) {
    body.removeAttribute("aria-busy");
    body.replaceChildren(h("p", { class: "notice" }, "This server has no data sets."));
    return;
  }
  const card = datasets.find((d) => d.name === state.dataset) ?? datasets.find((d) => d.name === followed.dataset) ?? datasets[0];
  const condition = card.conditions.includes(state.board_condition) ? state.board_condition
    : card.name === followed.dataset && !state.dataset ? followed.condition
    : card.conditions.includes("nominal") ? "nominal" : card.conditions[0];
  const field = FIELDS.includes(Number(state.board_field)) ? state.board_field : WHOLE;
  byId("board-controls").replaceChildren(
    choice("Data set", "dataset", datasets.map((d) => [d.name, d.name]), card.name, (dataset) => show({ dataset })),
    choice("Condition", "board-condition", card.conditions.map((c) => [c, c]), condition, (c) => show({ board_condition: c })),
    choice("Field", "board-field", [[WHOLE, "whole"], ...FIELDS.map((f) => [String(f), `within ${f}°`])], field, (f) => show({ board_field: f })));
  body.setAttribute("aria-busy", "true");
  if (shown) body.classList.add("stale");
  else body.replaceChildren(h("p", { class: "loading" }, "Loading the leaderboard…"));
  try {
    const rows = await getAll(`/v1/leaderboard/${encodeURIComponent(card.name)}`, { condition, field_deg: field || null, limit: 500 });
    if (mine !== turn) return;
    const named = rows.map((row) => ({ dataset: card.name, condition, ...row }));
    shown = { rows: named.filter((row) => row.condition === condition), dataset: card.name, condition, card, field };
    draw();
    byId("board-status").textContent = `${plural(shown.rows.length, "pipeline")} on ${card.name}, ${condition}.`;
  } catch (problem) {
    if (mine !== turn) return;
    shown = null;
    byId("board-card").replaceChildren();
    body.replaceChildren(problemNotice(problem, () => showLeaderboard(datasets)));
  } finally {
    if (mine === turn) {
      body.removeAttribute("aria-busy");
      body.classList.remove("stale");
    }
  }
}
