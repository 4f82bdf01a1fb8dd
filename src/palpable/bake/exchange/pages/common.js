// What all pages share: colours, numbers, charts. Data: the JSON in the element #data.
"use strict";
const DATA = JSON.parse(document.getElementById("data").textContent);
const root = document.documentElement;
const byId = (id) => document.getElementById(id);
const colour = (name) => getComputedStyle(root).getPropertyValue(name).trim();

function make(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key === "class") element.className = value;
    else if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else element.setAttribute(key, value);
  }
  for (const child of children) element.append(child);
  return element;
}

// ---- numbers ---------------------------------------------------------------------------------

const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const raised = (n) => (n < 0 ? "⁻" : "") + String(Math.abs(n)).replace(/\d/g, (d) => SUPERSCRIPT[d]);

// 0.00123 -> "1.2·10⁻³"; errors are read by their power of ten.
function scientific(value, digits = 2) {
  if (value == null || !isFinite(value)) return "–";
  if (value === 0) return "0";
  const [mantissa, power] = value.toExponential(digits - 1).split("e");
  if (power === "0" || power === "+0") return mantissa;
  return `${mantissa}·10${raised(Number(power))}`;
}
function decimal(value, digits = 3) {
  if (value == null || !isFinite(value)) return "–";
  return value === 0 ? "0" : Number(value.toPrecision(digits)).toLocaleString("en", { maximumSignificantDigits: digits });
}
function bytes(value) {
  if (value == null) return "–";
  const units = ["B", "kB", "MB", "GB"];
  let unit = 0;
  for (; value >= 1000 && unit < 3; ++unit) value /= 1000;
  return `${decimal(value)} ${units[unit]}`;
}
const percent = (value) => (value == null ? "–" : `${decimal(100 * value, 2)} %`);

// ---- light and dark --------------------------------------------------------------------------

const redraws = [];  // called once, and again when the colours change
function drawn(draw) {
  redraws.push(draw);
  draw();
}
function setTheme(theme) {
  root.dataset.theme = theme;
  byId("theme").textContent = theme === "dark" ? "Light" : "Dark";
  for (const draw of redraws) draw();
}
const darkSystem = matchMedia("(prefers-color-scheme: dark)");
darkSystem.addEventListener("change", (event) => setTheme(event.matches ? "dark" : "light"));
setTheme(darkSystem.matches ? "dark" : "light");
byId("theme").addEventListener("click", () => setTheme(root.dataset.theme === "dark" ? "light" : "dark"));

// ---- charts ----------------------------------------------------------------------------------

// On a logarithmic axis only powers of ten are labelled, or, where fewer than two are seen, what
// the library has put there.
function logLabels(chart, splits) {
  const powers = splits.filter((v) => v > 0 && Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9);
  const some = powers.length >= 2 ? new Set(powers) : null;
  return splits.map((v) => (v == null || (some && !some.has(v)) ? null : some ? `10${raised(Math.round(Math.log10(v)))}` : scientific(v, 2)));
}
// Lines of the grid likewise.
function logLines(chart, splits) {
  const labels = logLabels(chart, splits);
  return splits.map((v, i) => (labels[i] == null ? null : v));
}
// Of counts and bytes 1, 2, 5, 10, ...; of few decades all that there is room for.
const logCounts = (text) => (chart, splits) => {
  const round = splits.filter((v) => v != null && /^[125]0*$/.test(String(v)));
  const some = round.length >= 2 ? new Set(round) : null;
  return splits.map((v) => (v == null || (some && !some.has(v)) ? null : text(v)));
};

// A chart in `place` that fits its width and is drawn again when colours change.
//   x: {label, name, values, log, bytes, integers, format, range}, y: {label, log, format, range}
//   series: [{label, colour, values, width, dash, points, size, silent}]
// Drag: zoom; double click: all of it again.
function chart(place, { x, y, series, bands = [], height = 300 }) {
  let plot = null;
  const axis = (name, what, size) => ({
    label: what.label, labelSize: 20, labelFont: "12px system-ui, sans-serif", font: "12px system-ui, sans-serif", labelGap: 2,
    size, gap: 5, stroke: () => colour("--dim"),
    grid: { stroke: () => colour("--line"), width: 1, ...(what.log && name === "y" ? { filter: logLines } : {}) },
    ticks: { stroke: () => colour("--line"), width: 1, size: 5, ...(what.log && name === "y" ? { filter: logLines } : {}) },
    ...(what.log ? { values: name === "x" ? logCounts(what.bytes ? bytes : decimal) : logLabels } : {}),
    ...(what.integers ? { incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500] } : {}),
  });
  const build = () => {
    const before = plot && { x: { ...plot.scales.x }, y: { ...plot.scales.y }, zoomed: plot.zoomed };
    if (plot) plot.destroy();
    const format = y.format || ((v) => scientific(v, 3));
    const options = {
      width: Math.max(240, place.clientWidth), height,
      scales: {
        x: { time: false, distr: x.log ? 3 : 1, ...(x.range ? { range: x.range } : {}) },
        y: { distr: y.log ? 3 : 1, ...(y.range ? { range: y.range } : {}) },
      },
      axes: [axis("x", x, 28), axis("y", y, 52)],
      cursor: { drag: { x: true, y: true, uni: 40 }, points: { size: 7 } },
      legend: { live: true },
      bands,
      series: [
        { label: x.name || x.label, value: (c, v) => (v == null ? "–" : x.format ? x.format(v) : decimal(v)) },
        ...series.map((s) => ({
          label: s.label, width: s.width === undefined ? 2 : s.width, dash: s.dash, spanGaps: true,
          stroke: () => colour(s.colour), value: (c, v) => (v == null ? "–" : format(v)),
          points: { show: s.points === undefined ? s.values.length <= 40 : s.points, size: s.size || 5, ...(s.size ? { fill: () => colour(s.colour) } : {}) },
          ...(s.paths ? { paths: s.paths } : {}),
        })),
      ],
    };
    plot = new uPlot(options, [x.values, ...series.map((s) => s.values)], place);
    if (before && before.zoomed) {
      plot.setScale("x", before.x);
      plot.setScale("y", before.y);
    }
    series.forEach((s, i) => { if (s.silent) plot.root.querySelectorAll(".u-legend .u-series")[i + 1].style.display = "none"; });
    plot.over.addEventListener("mouseup", () => { plot.zoomed = true; });
    plot.over.addEventListener("dblclick", () => { plot.zoomed = false; });
  };
  drawn(build);
  new ResizeObserver(() => {
    const width = Math.max(240, place.clientWidth);
    if (plot && Math.abs(width - plot.width) > 1) plot.setSize({ width, height });
  }).observe(place);
}

function choice(label, options, chosen, change) {
  const group = make("span", { class: "group" }, label ? `${label} ` : "");
  for (const [value, text] of options) {
    const button = make("button", { type: "button", "aria-pressed": String(value === chosen) }, text);
    button.addEventListener("click", () => {
      for (const other of group.querySelectorAll("button")) other.setAttribute("aria-pressed", String(other === button));
      change(value);
    });
    group.append(button);
  }
  return group;
}

function facts(rows) {
  const table = make("table", { class: "facts" });
  for (const [name, value] of rows) table.append(make("tr", {}, make("td", {}, name), make("td", {}, value)));
  return make("div", { class: "scroll" }, table);
}

function figure(value, unit, name, what) {
  return make("div", {}, make("div", { class: "value" }, value, unit ? make("small", {}, unit) : ""),
    make("div", { class: "name" }, name), make("div", { class: "what" }, what));
}
