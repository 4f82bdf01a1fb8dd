// The page of one body file: what was given up, what it costs, what the modes look like.
"use strict";
const NAMES = { displacement: "Displacement", stress: "Cauchy stress", von_mises: "Von Mises stress" };
const NONE = (v) => (v > 0 ? v : null);  // 0 has no place on a logarithmic axis

// ---- figures at the top ----------------------------------------------------------------------
{
  const u = DATA.fields.displacement, s = DATA.fields.stress, top = byId("figures");
  top.append(
    figure(scientific(u.pooled), "", "Displacement, all snapshots", `${scientific(u.worst)} at the worst snapshot, in its own norm`),
    figure(scientific(s.pooled), "", "Stress, all snapshots", `${scientific(s.worst)} at the worst snapshot, in its own norm`),
  );
  const held = DATA.held_out;
  top.append(held
    ? figure(scientific(held.displacement_pooled), "", "Displacement between levels", `against ${held.count} states solved afresh; ${scientific(held.displacement_worst)} at the worst`)
    : figure("not computed", "", "Error between levels", "bake with --held-out solves the levels between afresh"));
  top.append(DATA.between_sites == null
    ? figure("not computed", "", "Error between sites", "the field of the nearest site, for a touch between sites")
    : figure(percent(DATA.between_sites), "", "Error between sites", "median of the nearest site's field, against a solve there"));
  top.append(
    figure(decimal(DATA.timing.displacement_us), "µs", "Displacement of one touch", `median of ${DATA.timing.repeats} evaluations, measured ${DATA.timing.date}`),
    figure(decimal(DATA.timing.all_us), "µs", "Displacement, stress, von Mises", "likewise, one after the other on one core"),
    figure(...bytes(DATA.file.bytes).split(" "), "Body file", `modes: ${bytes(u.bytes)} displacement, ${bytes(s.bytes)} stress`),
    figure(`${u.modes_per_touch} + ${s.modes_per_touch}`, "", "Modes summed in one touch", `displacement + stress; ${u.modes} + ${s.modes} in the file`),
  );
}

// ---- error against modes (the paper's Figures 14 and 18) --------------------------------------
{
  const place = byId("courses");
  let log = false;
  const draw = () => {
    place.replaceChildren();
    for (const name of ["displacement", "stress", "von_mises"]) {
      const course = DATA.courses[name], card = make("figure", { class: "card" }, make("h3", {}, NAMES[name]));
      place.append(card);
      if (!course) {
        card.append(make("p", { class: "note" }, "Not recorded in this file: it was made by an earlier program, or of another program's modes. ‘palpable reduce’ records it."));
        continue;
      }
      const at = make("div", {});
      card.append(make("div", { class: "sub" }, course.what), at);
      const last = course.modes.length - 1;
      chart(at, {
        x: { label: course.axis, name: "modes", values: course.modes, log, integers: true, format: (v) => String(v) },
        y: { label: "relative L₂ error", log: true },
        series: [
          { label: "95 %", colour: "--c0", values: course.p95.map(NONE), width: 0, points: false, silent: true },
          { label: "5 %", colour: "--c0", values: course.p05.map(NONE), width: 0, points: false, silent: true },
          { label: "worst snapshot", colour: "--c2", values: course.worst.map(NONE) },
          { label: "median snapshot", colour: "--c1", values: course.median.map(NONE) },
          { label: "all together", colour: "--c0", values: course.pooled.map(NONE), dash: [6, 4] },
        ],
        bands: [{ series: [1, 2], fill: () => colour("--c0") + "22" }],
      });
      card.append(make("figcaption", {}, `With ${course.modes[last]}: ${scientific(course.pooled[last])} all together, ${scientific(course.median[last])} at the median, ${scientific(course.worst[last])} at the worst of ${course.count.toLocaleString("en")} snapshots.`));
    }
  };
  byId("courses-bar").append(choice("Modes", [[false, "linear"], [true, "logarithmic"]], false, (value) => { log = value; draw(); }));
  draw();
}

// ---- each snapshot: a map of site and level ----------------------------------------------------

const MAP_RAMP = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
function rampColour(t) {
  const x = Math.max(0, Math.min(1, t)) * 4, k = Math.min(3, Math.floor(x)), f = x - k;
  return MAP_RAMP[k].map((v, i) => Math.round(v + f * (MAP_RAMP[k + 1][i] - v)));
}
// values: rows by site, columns by level.
function errorMap(place, { values, levels, what }) {
  const positive = values.flat().filter((v) => v > 0);
  if (!positive.length) { place.append(make("p", { class: "note" }, "All errors are zero.")); return; }
  const low = Math.floor(Math.log10(Math.min(...positive)) * 2) / 2, high = Math.ceil(Math.log10(Math.max(...positive)) * 2) / 2;
  const share = (v) => (Math.log10(Math.max(v, 1e-300)) - low) / Math.max(0.5, high - low);
  const S = values.length, L = values[0].length, canvas = make("canvas", { class: "map" });
  const reading = make("div", { class: "reading" }, "Point at a field to read it.");
  const draw = () => {
    const ratio = devicePixelRatio || 1, width = Math.max(200, place.clientWidth), left = 44, bottom = 38;
    const cell = Math.min(17, Math.max(5, 330 / S)), height = S * cell + bottom;
    canvas.style.height = `${height}px`;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    const wide = (width - left) / L;
    for (let s = 0; s < S; ++s) {
      for (let l = 0; l < L; ++l) {
        context.fillStyle = `rgb(${rampColour(share(values[s][l])).join(" ")})`;
        context.fillRect(left + l * wide, s * cell, wide + (wide > 8 ? -1 : 0.5), cell + (cell > 8 ? -1 : 0.5));
      }
    }
    context.fillStyle = colour("--dim");
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "right";
    context.textBaseline = "middle";
    const step = [1, 2, 5, 10, 20, 50, 100].find((n) => n * cell >= 14) || 200;
    for (let s = 0; s < S; s += step) context.fillText(String(s), left - 6, (s + 0.5) * cell);
    context.textAlign = "center";
    context.textBaseline = "top";
    const every = Math.max(1, Math.ceil((L * 42) / (width - left)));
    for (let l = 0; l < L; l += every) context.fillText(decimal(levels[l], 2), left + (l + 0.5) * wide, S * cell + 4);
    context.fillText("level (share of the full load)", left + (width - left) / 2, S * cell + 22);
    context.save();
    context.translate(8, (S * cell) / 2);
    context.rotate(-Math.PI / 2);
    context.textBaseline = "middle";
    context.fillText("site", 0, 0);
    context.restore();
    canvas.onmousemove = (event) => {
      const s = Math.floor(event.offsetY / cell), l = Math.floor((event.offsetX - left) / wide);
      if (s < 0 || s >= S || l < 0 || l >= L) return;
      reading.textContent = `site ${s}, level ${decimal(levels[l], 3)}: ${scientific(values[s][l], 3)} ${what}`;
    };
  };
  redraws.push(draw);
  new ResizeObserver(draw).observe(place);  // and once as it begins
  const bar = make("div", { class: "scale" }, scientific(10 ** low), make("i", { style: `background: linear-gradient(90deg, ${[0, 0.25, 0.5, 0.75, 1].map((t) => `rgb(${rampColour(t).join(" ")})`).join(", ")})` }), scientific(10 ** high));
  place.append(canvas, bar, reading);
}

// Errors of snapshots over the level: all sites as a band, their median and worst.
function overLevels(place, { values, levels, label }) {
  const quantile = (sorted, q) => sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))];
  const columns = levels.map((_, l) => values.map((row) => row[l]).sort((a, b) => a - b));
  chart(place, {
    x: { label: "level (share of the full load)", name: "level", values: levels, range: () => [0, 1] },
    y: { label, log: true },
    height: 260,
    series: [
      { label: "best site", colour: "--c0", values: columns.map((c) => NONE(c[0])), width: 1, points: false },
      { label: "median site", colour: "--c1", values: columns.map((c) => NONE(quantile(c, 0.5))) },
      { label: "worst site", colour: "--c2", values: columns.map((c) => NONE(c[c.length - 1])) },
    ],
    bands: [{ series: [3, 1], fill: () => colour("--c0") + "18" }],
  });
}

{
  const place = byId("snapshots");
  for (const name of ["displacement", "stress", "von_mises"]) {
    const map = DATA.snapshots[name];
    if (!map) continue;
    const at = make("div", {});
    place.append(make("figure", { class: "card" }, make("h3", {}, NAMES[name]), make("div", { class: "sub" }, map.what), at));
    errorMap(at, { values: map.values, levels: DATA.levels, what: "of its own norm" });
  }
  if (!place.children.length) place.append(make("p", { class: "note" }, "Not recorded in this file; ‘palpable reduce’ records it."));
}

// ---- held out ---------------------------------------------------------------------------------
{
  const place = byId("held-out"), held = DATA.held_out;
  if (!held) {
    place.append(make("p", { class: "note" }, "Not computed. ‘palpable bake BODY.toml --held-out’ solves the levels half way between the baked ones afresh and keeps the comparison in the body file."));
  } else {
    for (const [name, label, what] of [
      ["displacement", "relative L₂ error", "On the skin, each state against its own norm"],
      ["von_mises", "error of the worst vertex", "The worst vertex, against the largest value of the same field"]]) {
      const at = make("div", {});
      const card = make("figure", { class: "card" }, make("h3", {}, NAMES[name]), make("div", { class: "sub" }, what), at);
      place.append(card);
      overLevels(at, { values: held[name], levels: held.levels, label });
      card.append(make("figcaption", {}, `${scientific(held[`${name}_median`])} at the median of ${held.count.toLocaleString("en")} states, ${scientific(held[`${name}_worst`])} at the worst` + (name === "displacement" ? `, ${scientific(held.displacement_pooled)} all together.` : ".")));
    }
  }
}

// Texts of the provenance as paragraphs.
function paragraphs(texts) {
  return texts.map((value) => make("p", { class: "note" }, `${value[0].toUpperCase()}${value.slice(1)}.`));
}
byId("held-out").after(...paragraphs(DATA.notes.held_out));
byId("between-sites").append(...(DATA.between_sites == null
  ? [make("p", { class: "note" }, "Not computed: this file does not say how wrong that is.")]
  : [make("p", {}, `Wrong by ${percent(DATA.between_sites)} at the median touch (relative L₂, on the skin).`), ...paragraphs(DATA.notes.between_sites)]));

// ---- touched anywhere -------------------------------------------------------------------------
{
  const { text, held_out: held } = DATA.touch, place = byId("touch");
  place.append(make("p", {}, `How this body is touched: ${text}.`));
  if (held.length) {
    const head = ["What presses", "Depth, mm", "Displacement, %", "Force, %", "Stress at the worst vertex, %"];
    const row = (kind, cells) => make("tr", {}, ...cells.map((cell) => make(kind, {}, cell)));
    place.append(make("table", {}, make("thead", {}, row("th", head)), make("tbody", {}, ...held.map((t) =>
      row("td", [t.obstacle, t.depth_mm.toFixed(1), ...[t.displacement, t.force, t.von_mises].map((e) => (100 * e).toPrecision(2))])))));
  }
}

// ---- modes ------------------------------------------------------------------------------------

function component(mode, name, field) {
  const scale = mode.scale, raw = mode.values, c = field === "displacement" ? 3 : 6, V = raw.length / c;
  const out = new Float32Array(V), indices = { x: 0, y: 1, z: 2, xx: 0, yy: 1, zz: 2, xy: 3, yz: 4, zx: 5 };
  for (let v = 0; v < V; ++v) {
    const at = (k) => scale * raw[c * v + k];
    if (name === "size") out[v] = Math.hypot(at(0), at(1), at(2));
    else if (name === "von_mises") out[v] = Math.sqrt(Math.max(0, 0.5 * ((at(0) - at(1)) ** 2 + (at(1) - at(2)) ** 2 + (at(2) - at(0)) ** 2) + 3 * (at(3) ** 2 + at(4) ** 2 + at(5) ** 2)));
    else out[v] = at(indices[name]);
  }
  return out;
}

const pictures = new ModePictures(DATA.mesh);
function modesOf(field) {
  const place = byId(`modes-${field}`), bar = byId(`modes-${field}-bar`), list = DATA.modes[field];
  if (!list.length) { place.append(make("p", { class: "note" }, "None: the snapshots have no stress.")); return; }
  const unit = field === "displacement" ? { name: "mm", factor: 1e3 } : { name: "kPa", factor: 1e-3 };
  const entries = [];
  let shown = field === "displacement" ? "size" : "von_mises";
  const exaggeration = (mode, on) => (on ? (0.12 * pictures.height) / mode.largest : 0);
  let deformed = field === "displacement";
  const refresh = () => {
    for (const { mode, entry, scale } of entries) {
      entry.shade = component(mode, shown, field);
      entry.signed = shown !== "size" && shown !== "von_mises";
      let top = 0;
      for (const v of entry.shade) top = Math.max(top, Math.abs(v));
      entry.top = top;
      entry.exaggerate = exaggeration(mode, deformed);
      scale.replaceChildren(
        `${entry.signed ? `−${decimal(top * unit.factor)}` : "0"} ${unit.name}`,
        make("i", { style: `background: ${css(entry.signed ? DIVERGING : SEQUENTIAL)}` }),
        `${decimal(top * unit.factor)} ${unit.name}`);
      if (pictures.gl) pictures.prepare(entry);
    }
    pictures.draw();
  };
  for (const mode of list) {
    mode.values = numbers(mode.data, Int16Array);
    mode.largest = 0;
    if (field === "displacement") for (const v of component(mode, "size", field)) mode.largest = Math.max(mode.largest, v);
    const canvas = make("canvas", {}), scale = make("div", { class: "scale" });
    place.append(make("figure", { class: "card" }, make("h3", {}, mode.title), make("div", { class: "sub" }, mode.what), canvas, scale));
    const moved = field === "displacement" ? Float32Array.from(mode.values, (v) => v * mode.scale) : null;
    entries.push({ mode, scale, entry: pictures.add(canvas, { moved, facing: mode.site !== undefined, exaggerate: exaggeration(mode, deformed), shade: component(mode, shown, field), top: 1, signed: false }) });
  }
  if (!pictures.gl) bar.append("This browser has no WebGL: the pictures stay empty.");
  const select = make("select", { "aria-label": "painted component" });
  for (const [value, text] of field === "displacement"
    ? [["size", "size |F|"], ["x", "x"], ["y", "y"], ["z", "z"]]
    : [["von_mises", "von Mises"], ["xx", "σxx"], ["yy", "σyy"], ["zz", "σzz"], ["xy", "σxy"], ["yz", "σyz"], ["zx", "σzx"]]) {
    select.append(make("option", { value }, text));
  }
  select.addEventListener("change", () => { shown = select.value; refresh(); });
  bar.append(make("span", { class: "group" }, "Painted ", select));
  if (field === "displacement") bar.append(choice("Body", [[true, "moved by the mode"], [false, "at rest"]], true, (value) => { deformed = value; refresh(); }));
  bar.append(make("span", {}, "Drag to turn, Shift + wheel to come nearer, double click for the first view."));
  refresh();
}
modesOf("displacement");
modesOf("stress");
addEventListener("resize", () => pictures.draw());

// Functions of the parameters, the largest value of each made one.
for (const field of ["displacement", "stress"]) {
  const place = byId(`functions-${field}`);
  for (const axis of DATA.functions[field] || []) {
    const at = make("div", {});
    place.append(make("figure", { class: "card" }, make("h3", {}, axis.title), make("div", { class: "sub" }, axis.what), at));
    const dots = axis.choice ? { width: 0, points: true, size: 6, paths: () => null } : {};
    chart(at, {
      x: { label: axis.label, name: axis.name, values: axis.x, integers: axis.choice, format: axis.choice ? (v) => String(v) : undefined },
      y: { label: "G / max |G|", format: (v) => decimal(v, 3), range: () => [-1.08, 1.08] },
      height: 260,
      series: axis.curves.map((c, i) => ({ label: c.label, colour: `--c${i % 8}`, values: c.values, points: false, ...dots })),
    });
  }
}

// ---- figures and provenance --------------------------------------------------------------------
byId("costs").append(facts(DATA.costs));
byId("provenance").append(facts(DATA.provenance));
