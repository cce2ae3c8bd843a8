/* The form of a calibration: columns are shown and can be corrected, the report stands below the form. */

import { byId, h, ROOT } from "./dom.js";

const form = byId("calibrate");
const choices = JSON.parse(byId("choices").textContent);
const config = form.elements.config;
let asking = null;

/** A value as TOML: strings and lists of them as JSON has them. */
const toml = (value) => JSON.stringify(value);

/** Set or unset (null) a value of a section of the settings; the lines there have their names already. */
function set(section, name, value) {
  const lines = config.value.split("\n");
  let start = lines.indexOf(`[${section}]`);
  if (start < 0) start = lines.push("", `[${section}]`) - 1;
  let end = lines.findIndex((line, at) => at > start && line.startsWith("["));
  if (end < 0) end = lines.length;
  const at = lines.findIndex((line, n) => n > start && n < end && new RegExp(`^(# )?${name} =`).test(line));
  const line = value === null ? `# ${name} = ` : `${name} = ${toml(value)}`;
  if (at < 0) lines.splice(start + 1, 0, line);
  else lines[at] = line;
  config.value = lines.join("\n");
}

const select = (label, options, current, change) => h("select", { "aria-label": label, onchange: change },
  options.map(([value, text]) => h("option", { value, selected: value === current }, text)));

/** What a column is, as the form says it: reading-1, direction-2, run, time, temperature or nothing. */
function roleOf(words) {
  const found = /^(reading|direction) (\d+)/.exec(words ?? "");
  if (found) return `${found[1]}-${found[2]}`;
  return ["run", "time", "temperature"].includes(words) ? words : "";
}

/** Write what the selects say into the settings. */
function write(columns) {
  const roles = [...columns.querySelectorAll("[data-role]")].map((cell) => ({
    name: cell.dataset.role, role: cell.querySelector("select").value,
  }));
  const ordered = (kind) => roles.filter(({ role }) => role.startsWith(`${kind}-`))
    .sort((one, other) => one.role.split("-")[1] - other.role.split("-")[1]).map(({ name }) => name);
  const named = (role) => roles.find((one) => one.role === role)?.name ?? null;
  const chosen = (id) => columns.querySelector(`#${id}`)?.value;
  set("readings", "kind", chosen("kind"));
  set("readings", "columns", ordered("reading"));
  set("direction", "columns", ordered("direction"));
  set("direction", "form", chosen("form"));
  set("direction", "unit", chosen("angle-unit"));
  set("rows", "run", named("run"));
  set("rows", "time_s", named("time"));
  set("rows", "time_unit", chosen("time-unit"));
  set("rows", "temperature_K", named("temperature"));
  set("rows", "temperature_unit", chosen("temperature-unit"));
}

const stated = (section, name) => {
  const part = config.value.split(`\n[${section}]\n`)[1]?.split("\n[")[0] ?? "";
  return new RegExp(`^${name} = "?([^"\\n]*)"?$`, "m").exec(part)?.[1];
};

/** The form of a file's columns: role of each, units, and its first rows. */
function mapping(found) {
  const columns = byId("columns");
  const change = () => write(columns);
  const most = Math.max(4, found.columns.filter(({ role }) => /^reading/.test(role ?? "")).length);
  const turns = Math.max(3, found.columns.filter(({ role }) => /^direction/.test(role ?? "")).length);
  const roles = [["", "not used"],
    ...Array.from({ length: most }, (_, n) => [`reading-${n + 1}`, `reading ${n + 1}`]),
    ...Array.from({ length: turns }, (_, n) => [`direction-${n + 1}`, `direction ${n + 1}`]),
    ["run", "run"], ["time", "time"], ["temperature", "temperature"]];
  const one = (id, label, values, current) => h("label", { for: id }, `${label} `,
    h("select", { id, onchange: change }, values.map(([value, text]) =>
      h("option", { value, selected: value === current }, text))));
  columns.replaceChildren(
    h("h3", {}, `Columns of ${found.source}: ${found.rows} rows`),
    found.refused && h("p", { class: "notice" }, `Not recognised: ${found.refused}. Say what the columns are.`),
    h("div", { class: "table-scroll", tabindex: 0, role: "region", "aria-label": "First rows" }, h("table", {},
      h("thead", {}, h("tr", {}, found.columns.map(({ name, unit }) =>
        h("th", { scope: "col" }, name, unit && !name.toLowerCase().endsWith(unit.toLowerCase()) && h("span", { class: "muted" }, ` ${unit}`))))),
      h("tbody", {},
        h("tr", {}, found.columns.map(({ name, role }) => h("td", { "data-role": name },
          select(`Role of ${name}`, roles, roleOf(role), change)))),
        Array.from({ length: found.columns[0].first.length }, (_, n) => h("tr", {},
          found.columns.map(({ first }) => h("td", {}, first[n] ?? ""))))))),
    h("p", { class: "mapping" },
      one("kind", "Readings are", choices.kinds, stated("readings", "kind")),
      one("form", "Directions are", choices.forms, stated("direction", "form")),
      one("angle-unit", "Unit of angles", choices.angle_units, stated("direction", "unit")),
      one("time-unit", "of time", choices.time_units, stated("rows", "time_unit")),
      one("temperature-unit", "of temperature", choices.temperature_units, stated("rows", "temperature_unit"))),
    found.notes.length > 0 && h("ul", { class: "muted" }, found.notes.map((note) => h("li", {}, note))),
  );
  columns.hidden = false;
}

/** Show why there is no answer beside the form; nothing takes it away. */
function complain(...words) {
  byId("problem").replaceChildren(...words.length ? [h("div", { class: "notice error", role: "alert" }, h("p", {}, ...words))] : []);
}

async function preview() {
  const [file] = form.elements.file.files;
  byId("columns").hidden = true;
  complain();
  if (!file) return;
  asking?.abort();
  asking = new AbortController();
  byId("progress").textContent = "Reading the columns …";
  const sent = new FormData();
  sent.append("file", file);
  try {
    const answer = await fetch(`${ROOT}/v1/calibrations/preview`, { method: "POST", body: sent, signal: asking.signal });
    const found = await answer.json();
    if (answer.ok) {
      config.value = found.config;
      mapping(found);
    } else complain(found.detail);
  } catch (cause) {
    if (cause.name === "AbortError") return;
    complain("The server does not answer.");
  }
  byId("progress").textContent = "";
}

async function calibrate(event) {
  if (form.elements.answer.value !== "report") return;
  event.preventDefault();
  const sent = new FormData(form, event.submitter);
  const buttons = form.querySelectorAll("button");
  const started = Date.now();
  const digits = [...crypto.getRandomValues(new Uint8Array(16))].map((n) => n.toString(16).padStart(2, "0"));
  const ticket = digits.join("");
  sent.set("ticket", ticket);
  let said = "";
  const tick = () => { byId("progress").textContent = `Calibrating, ${Math.round((Date.now() - started) / 1000)} s …${said}`; };
  /** Ask how many calibrations come before this one, which waits for its turn. */
  const ask = async () => {
    const place = await (await fetch(`${ROOT}/v1/calibrations/waiting/${ticket}`)).json();
    said = place.before > 0 ? ` ${place.before} in front, about ${place.wait_s} s` : "";
  };
  for (const button of buttons) button.disabled = true;
  complain();
  byId("result").replaceChildren();
  tick();
  const clock = setInterval(tick, 1000);
  const asked = setInterval(() => ask().catch(() => {}), 3000);
  try {
    const answer = await fetch(`${ROOT}/calibrate`, { method: "POST", body: sent, headers: { Accept: "text/html" } });
    const page = new DOMParser().parseFromString(await answer.text(), "text/html");
    byId("problem").replaceChildren(...page.getElementById("problem").childNodes);
    if (answer.ok) show(page.getElementById("result"));
  } catch {
    complain("The server does not answer.");
  }
  clearInterval(clock);
  clearInterval(asked);
  byId("progress").textContent = "";
  for (const button of buttons) button.disabled = false;
}

function show(result) {
  for (const template of result.querySelectorAll("template[shadowrootmode]")) {
    template.parentElement.attachShadow({ mode: "open" }).append(template.content);
    template.remove();
  }
  byId("result").replaceChildren(...result.childNodes);
  byId("result").focus();
  byId("result").scrollIntoView();
}

form.elements.file.addEventListener("change", preview);
form.addEventListener("submit", calibrate);
