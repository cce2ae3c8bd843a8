/* Live figures: near the window, Plotly takes the place of a figure's first picture.

   Nothing here knows what a figure shows. A mark's customdata has its `text`; `href`, where a click leads;
   of flows also `studies`, its studies, and `narrow`, attribute -> values that a click asks for. */

import { h } from "./dom.js";

// Nothing is sent anywhere: Plotly's button that uploads a chart is left out.
const CONFIG = {
  displaylogo: false, responsive: true, plotlyServerURL: "",
  modeBarButtonsToRemove: ["sendChartToCloud", "select2d", "lasso2d", "autoScale2d"],
};
const configOf = (data) => ({ ...CONFIG, displayModeBar: data[0].x ? "hover" : false });
const COLOUR = /"(#[0-9a-f]{6}|rgba\([^)"]*\))"/g;
const DIM = 0.12; // opacity of what has no study in common with the mark that is pointed at

let library; // a promise of Plotly, once a figure needs it

function plotly(source) {
  library ??= new Promise((resolve, reject) => {
    document.head.append(h("script", { src: source, onload: () => resolve(window.Plotly), onerror: reject }));
  });
  return library;
}

/** The specification in the colours of the page's scheme. */
function coloured(text) {
  const { dark } = JSON.parse(text).layout.meta;
  const isDark = document.documentElement.dataset.theme === "dark";
  const made = JSON.parse(isDark ? text.replace(COLOUR, (all, one) => `"${dark[one] ?? one}"`) : text);
  made.layout.font.family = getComputedStyle(document.body).fontFamily;
  if (matchMedia("(pointer: coarse)").matches) made.layout.dragmode = false; // a finger scrolls the page
  return made;
}

/** Every mark, once: { mark, kind, curve, at }; kind is node or link in a flow. */
function marksOf(data) {
  const listed = (list, kind, curve) => (list ?? []).flatMap((mark, at) => (Array.isArray(mark)
    ? mark.map((one, column) => ({ mark: one, kind, curve, at: [at, column] })) : [{ mark, kind, curve, at }]));
  const all = data.flatMap((trace, curve) => [
    ...listed(trace.customdata, "point", curve), ...listed(trace.node?.customdata, "node", curve),
    ...listed(trace.link?.customdata, "link", curve)]);
  const distinct = new Map(all.filter(({ mark }) => mark?.text).map((one) => [`${one.mark.text}\n${one.mark.href}`, one]));
  return [...distinct.values()];
}

/** The page's address with the values of a mark asked for, no longer where they are, or with all others of its attribute. */
function narrowed({ mark, kind }, marks, exclude) {
  const url = new URL(location.href);
  url.hash = "";
  url.searchParams.delete("cursor");
  for (const [attribute, values] of Object.entries(mark.narrow)) {
    const now = url.searchParams.getAll(attribute).filter(Boolean);
    const isAsked = now.length && now.every((one) => values.includes(one));
    const every = marks.filter((one) => one.kind === "node").flatMap((one) => one.mark.narrow?.[attribute] ?? []);
    const others = (now.length ? now : [...new Set(every)]).filter((one) => !values.includes(one));
    url.searchParams.delete(attribute);
    const kept = values.filter((one) => !now.length || now.includes(one));
    if (isAsked && kind === "node" && !exclude) continue; // taken back
    for (const one of exclude && kind === "node" ? others : kept) url.searchParams.append(attribute, one);
  }
  return url;
}

/** Go where a mark leads. Who listens to `figurenarrow` can keep the page. */
function follow(place, one, marks, event) {
  const sorted = (url) => [...url.searchParams].map((pair) => pair.join("=")).sort().join("&");
  if (one.mark.narrow) {
    const url = narrowed(one, marks, event.shiftKey);
    if (sorted(url) !== sorted(new URL(location.href))) {
      const asked = new CustomEvent("figurenarrow", { bubbles: true, cancelable: true, detail: url });
      if (place.dispatchEvent(asked)) location.assign(url);
      return;
    }
  }
  if (one.mark.href && (event.ctrlKey || event.metaKey)) window.open(one.mark.href, "_blank", "noopener");
  else if (one.mark.href) location.assign(one.mark.href);
}

/** Leave bright what shares a study with a mark of a flow; all of it without one. */
function light(plot, data, mark) {
  const keys = mark?.studies && new Set(mark.studies);
  for (const kind of ["node", "link"]) {
    const of = data[0][kind]?.customdata ?? [];
    for (const drawn of plot.querySelectorAll(`.sankey-${kind}`)) {
      const at = drawn.__data__?.[kind]?.pointNumber; // as Plotly's layout numbers it
      drawn.style.opacity = !keys || of[at]?.studies?.some((key) => keys.has(key)) ? "" : DIM;
    }
  }
}

/** All marks as links that the arrow keys go through; each shows what it says while it has the focus. */
function listOf(place, plot, data, marks, Plotly) {
  const isFlow = data[0]?.type === "sankey";
  const links = marks.map((one, at) => h("a", {
    href: one.mark.narrow ? narrowed(one, marks, false).href : one.mark.href ?? "#",
    tabindex: at ? -1 : 0,
    onclick: (event) => { event.preventDefault(); follow(place, one, marks, event); },
    onfocus: () => {
      if (isFlow) light(plot, data, one.mark);
      else if (data[one.curve].x) Plotly.Fx.hover(plot, [{ curveNumber: one.curve, pointNumber: one.at }]);
    },
    onblur: () => { if (isFlow) light(plot, data, null); },
  }, one.mark.text));
  const move = (event) => {
    const at = links.indexOf(document.activeElement);
    const to = { ArrowDown: at + 1, ArrowRight: at + 1, ArrowUp: at - 1, ArrowLeft: at - 1, Home: 0, End: links.length - 1 }[event.key];
    if (to === undefined || !links[to]) return;
    event.preventDefault();
    links[at].tabIndex = -1;
    links[to].tabIndex = 0;
    links[to].focus({ preventScroll: true });
  };
  return h("ul", { class: "figure-marks", "aria-label": "Marks of the figure; arrow keys go through them", onkeydown: move },
    links.map((link) => h("li", {}, link)));
}

async function draw(place) {
  const [Plotly, text] = await Promise.all([plotly(place.dataset.plotly), fetch(place.dataset.spec).then((answer) => {
    if (!answer.ok) throw new Error(`${place.dataset.spec}: ${answer.status}`);
    return answer.text();
  })]);
  const { data, layout } = coloured(text);
  if (!data.length || !place.isConnected) return;
  const plot = h("div", { class: "figure-plot" });
  const frame = place.querySelector(".figure-frame");
  frame.style.minWidth = `${layout.meta.narrowest}px`;
  frame.style.minHeight = `${frame.offsetHeight}px`; // the page does not jump meanwhile
  frame.prepend(plot);
  for (const image of frame.querySelectorAll("img")) image.hidden = true;
  await Plotly.newPlot(plot, data, layout, configOf(data));
  frame.style.minHeight = "";
  const marks = marksOf(data);
  const of = (event) => {
    const [point] = event.points ?? [];
    const mark = Array.isArray(point?.customdata) ? null : point?.customdata;
    return mark && marks.find((one) => one.mark.text === mark.text && one.mark.href === mark.href);
  };
  let pressed = {}; // the last press, with its modifiers
  plot.addEventListener("pointerdown", (event) => { pressed = event; }, true);
  const clicked = (event) => {
    const one = of(event);
    if (one) follow(place, one, marks, pressed);
    return false; // a sector is a link, and does not unfold
  };
  plot.on("plotly_click", clicked);
  plot.on("plotly_sunburstclick", clicked);
  if (data[0].type === "sankey") {
    plot.on("plotly_hover", (event) => light(plot, data, of(event)?.mark));
    plot.on("plotly_unhover", () => light(plot, data, null));
  }
  if (marks.some(({ mark }) => mark.href || mark.narrow)) place.append(listOf(place, plot, data, marks, Plotly));
  document.addEventListener("themechange", () => {
    const again = coloured(text);
    if (plot.isConnected) Plotly.react(plot, again.data, again.layout, configOf(data));
  });
  place.dataset.live = "true";
}

const seen = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue;
    seen.unobserve(target);
    draw(target).catch((cause) => { // the picture stays
      target.querySelector(".figure-plot")?.remove();
      for (const image of target.querySelectorAll("img")) image.hidden = false;
      console.error(cause);
    });
  }
}, { rootMargin: "300px" });

/** Make the figures in a part of the page live when they come near the window. */
export function watch(part) {
  for (const place of part.querySelectorAll(".live-figure:not([data-live])")) seen.observe(place);
}

watch(document);
