/* Parts that the server draws for an answer: sensors, the first of the answer, the scatter. */

import { byId, h, segmented } from "./dom.js";
import { address } from "./service.js";
import { requirements, show, state } from "./state.js";

const ACROSS = [["field", "Field"], ["poses", "Calibration poses"]];
const sensors = new Map();

function keep(from) {
  for (const drawing of from.querySelectorAll("[data-design]")) sensors.set(drawing.dataset.design, drawing.firstElementChild);
}

/** A small drawing of a detector behind a mask; nothing where the server has drawn none yet. */
export function sensor(detector, mask) {
  const drawing = sensors.get(`${detector} + ${mask}`)?.cloneNode(true);
  drawing?.setAttribute("aria-hidden", "true"); // the name stands beside it
  return drawing;
}

/** Take the drawings that came with the page. */
export function keepDrawings() {
  keep(byId("drawings").content);
}

export function showScatterControls() {
  byId("scatter-controls").replaceChildren(segmented("Error against", "across", ACROSS, state.across, (across) => show({ across })));
}

/** Fetch what the server draws for what is asked now. */
export async function fetchDrawings(signal) {
  const response = await fetch(address("/scatter", { ...requirements(), sort: state.sort, across: state.across }), { signal });
  if (!response.ok) return;
  const page = new DOMParser().parseFromString(await response.text(), "text/html");
  keep(page.getElementById("drawings").content);
  for (const id of ["scatter-body", "best"]) byId(id).replaceChildren(...page.getElementById(id).childNodes);
}

/** Nothing to draw: the question was not answered. */
export function clearDrawings() {
  byId("best").replaceChildren();
  byId("scatter-body").replaceChildren(h("p", { class: "muted" }, "Nothing to show: the question was not answered."));
}
