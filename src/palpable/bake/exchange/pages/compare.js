// The page that compares methods and bodies: error against modes or bytes.
"use strict";
const WHAT = { pooled: "all snapshots together", median: "median snapshot", worst: "worst snapshot" };
const NAMES = { displacement: "Displacement", stress: "Cauchy stress" };
let abscissa = "bytes", ordinate = "pooled";

const colourOf = new Map();
for (const field of Object.values(DATA.fields)) for (const line of field) if (!colourOf.has(line.name)) colourOf.set(line.name, `--c${colourOf.size % 8}`);

const place = byId("charts");
function draw() {
  place.replaceChildren();
  for (const [name, lines] of Object.entries(DATA.fields)) {
    const at = make("div", {});
    place.append(make("figure", { class: "card" }, make("h3", {}, NAMES[name]), make("div", { class: "sub" }, `Error of ${WHAT[ordinate]} against ${abscissa === "bytes" ? "the bytes of the modes" : "the number of modes"}`), at));
    const tables = lines.map((line) => {
      const order = line[abscissa].map((_, i) => i).sort((a, b) => line[abscissa][a] - line[abscissa][b]);
      return [order.map((i) => line[abscissa][i]), order.map((i) => (line[ordinate][i] > 0 ? line[ordinate][i] : null))];
    });
    const joined = uPlot.join(tables);
    chart(at, {
      x: abscissa === "bytes"
        ? { label: "bytes of modes and their functions (boundary, single precision)", name: "bytes", values: joined[0], log: true, bytes: true, format: bytes }
        : { label: "modes (per-site: of each site; hosvd: functions of space)", name: "modes", values: joined[0], log: true, format: (v) => String(v) },
      y: { label: "relative L₂ error", log: true },
      height: 400,
      series: lines.map((line, i) => ({ label: line.name, colour: colourOf.get(line.name), values: joined[i + 1], points: line.modes.length <= 14, dash: line.source === "body" ? [6, 4] : undefined })),
    });
  }
}
byId("bar").append(
  choice("Against", [["bytes", "bytes"], ["modes", "modes"]], abscissa, (value) => { abscissa = value; draw(); }),
  choice("Error of", [["pooled", "all together"], ["median", "the median snapshot"], ["worst", "the worst snapshot"]], ordinate, (value) => { ordinate = value; draw(); }));
draw();

for (const [name, lines] of Object.entries(DATA.fields)) {
  const table = make("table", {});
  const head = ["method", "modes", "in all", "bytes", "all together", "median", "worst", "time"];
  table.append(make("thead", {}, make("tr", {}, ...head.map((text) => make("th", {}, text)))));
  const body = make("tbody", {});
  for (const line of lines) {
    const last = line.modes.length - 1;
    const first = make("td", {}, make("span", { class: "swatch", style: `background: var(${colourOf.get(line.name)})` }), line.name);
    body.append(make("tr", {}, first, ...[
      line.ranks ? line.ranks.join(" × ") : line.modes[last], line.columns[last], bytes(line.bytes[last]),
      scientific(line.pooled[last]), scientific(line.median[last]), scientific(line.worst[last]),
      line.seconds == null ? "–" : `${decimal(line.seconds, 2)} s`].map((v) => make("td", {}, String(v)))));
  }
  table.append(body);
  byId("tables").append(make("h3", {}, NAMES[name]), make("div", { class: "scroll" }, table));
}
byId("provenance").append(facts(DATA.provenance));
