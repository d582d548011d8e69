"use strict";
// The explorer: choices on the left, charts, wall, muscles and verdicts on the right. All it shows
// is in one object, written by content.py; the choice is an object too, and stands in the address.

const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#2f93cf", "#8a6fd1", "#7f7f7f"];
const DASHES = [[], [9, 4], [2, 3], [9, 3, 2, 3], [14, 4], [5, 2]];
const MOST_CURVES = 60; // that are drawn at a time
const MOST_MUSCLES = 200; // that are listed at a time
const SHOWN = new Set(["converged", "unstable"]); // statuses of states that a line goes through
const MARKS = ["dot", "square", "diamond"]; // of measured points, by their source
const BETWEEN = "star"; // where a map has no point of its own
const OF_MAP = { pressure: 0, contraction: 1, force: 2, load: 2 }; // columns of measured points
const VIRIDIS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
const MOST_SHEETS = 8; // data sheets beside each other
const STEP_TIME = 500; // ms from one state of the wall to the next

const $ = (id) => document.getElementById(id);
const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const unique = (values) => [...new Set(values)];
const digits = (value, count = 6) =>
  value === null || value === undefined ? ""
    : value !== 0 && Math.abs(value) < 1e-4 ? Number(value.toPrecision(count)).toExponential() : String(Number(value.toPrecision(count)));

async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return JSON.parse(await new Response(stream).text());
}

// --- what is chosen -----------------------------------------------------------------------------

let DATA;
let choice; // path, x, y, held, models, variants, muscles (lists), beside, compare, bands, measured

function firstChoice() {
  const path = Object.keys(DATA.paths)[0];
  return {
    ...ofPath(path),
    compare: false, beside: DATA.muscles[Math.min(1, DATA.muscles.length - 1)].name,
    bands: true, measured: true,
  };
}

/** The choice of a path: one muscle, the one that is given or the one of most curves. */
function ofPath(path, muscle) {
  const curves = DATA.curves.filter((c) => c.path === path);
  const muscles = unique(curves.map((c) => c.muscle));
  const count = (name) => curves.filter((c) => c.muscle === name).length;
  const most = muscles.reduce((best, name) => (count(name) > count(best) ? name : best));
  const own = muscles.includes(muscle) ? muscle : most;
  const variants = unique(curves.filter((c) => c.muscle === own).map((c) => c.variant));
  return {
    path, x: DATA.paths[path].swept, y: DATA.paths[path].follows,
    held: unique(curves.filter((c) => c.muscle === own).map((c) => c.held)),
    models: unique(curves.map((c) => c.model)),
    variants: [variants.includes("default") ? "default" : variants[0]],
    muscles: [own],
  };
}

function fromAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  const found = firstChoice();
  if (DATA.paths[given.get("path")]) Object.assign(found, ofPath(given.get("path"), given.get("muscles")));
  for (const key of ["x", "y"]) if (DATA.quantities[given.get(key)]) found[key] = given.get(key);
  for (const key of ["models", "variants", "muscles"]) if (given.has(key)) found[key] = given.get(key).split(",").filter(Boolean);
  if (given.has("held")) found.held = given.get("held").split(",").filter(Boolean).map(Number);
  if (DATA.muscles.some((m) => m.name === given.get("beside"))) found.beside = given.get("beside");
  for (const key of ["compare", "bands", "measured"]) if (given.has(key)) found[key] = given.get(key) === "1";
  return found;
}

function address() {
  const values = Object.entries(choice).map(([key, value]) =>
    [key, Array.isArray(value) ? value.join(",") : typeof value === "boolean" ? Number(value) : value]);
  return "#" + new URLSearchParams(values);
}

// --- curves -------------------------------------------------------------------------------------

/** The curves of some muscles that are chosen, with their states as points. */
function curvesOf(muscles) {
  const chosen = DATA.curves
    .map((curve, number) => ({ ...curve, number }))
    .filter((c) => c.path === choice.path && shownMuscles().includes(c.muscle) && choice.models.includes(c.model)
      && choice.variants.includes(c.variant) && choice.held.includes(c.held));
  // beside each other, the same held value of two muscles has the same colour
  const single = choice.muscles.length === 1;
  const nameOf = (c) => `${single ? "" : c.muscle} ${c.held} ${c.period || ""}`;
  const names = unique(chosen.map(nameOf));
  return chosen.filter((c) => muscles.includes(c.muscle)).map((c) => ({
    ...c,
    colour: COLOURS[names.indexOf(nameOf(c)) % COLOURS.length],
    dash: DASHES[Object.keys(DATA.models).indexOf(c.model) % DASHES.length],
    width: c.variant === "default" ? 2 : 1.2,
    label: labelOf(c),
    points: pointsOf(c),
  }));
}

function labelOf(curve) {
  const held = DATA.paths[curve.path].held;
  const parts = [curve.muscle, DATA.models[curve.model], `${digits(curve.held)} ${unitOf(held)}`.trim()];
  if (curve.variant !== "default") parts.splice(2, 0, curve.variant);
  if (curve.period) parts.push(`period ${digits(curve.period)} s`);
  return parts.join(", ");
}

const unitOf = (name) => (DATA.quantities[name] && DATA.quantities[name].unit !== "1" ? DATA.quantities[name].unit : "");
const named = (name) => {
  const { unit } = DATA.quantities[name];
  return name.replaceAll("_", " ") + (unit && unit !== "1" ? ` [${unit}]` : "");
};

function pointsOf(curve) {
  const { columns, errors, point, status, flags, note } = DATA.states;
  const found = [];
  for (let row = curve.first; row < curve.first + curve.count; ++row) {
    found.push({
      row, x: columns[choice.x][row], y: columns[choice.y][row], time: inTime() ? columns.time[row] : null,
      error: errors[choice.y] ? errors[choice.y][row] : null,
      zero: point[row] !== "stop", status: status[row], flags: flags[row], note: note[row],
    });
  }
  return found;
}

/** Whether states are told apart by their time: along a loop there are several at an abscissa. */
const inTime = () => Boolean(DATA.paths[choice.path].inTime);

const overstrained = (p) => p.flags.split(" ").includes("overstrained");
const drawn = (p) => p.x !== null && p.y !== null;
const onLine = (p) => drawn(p) && !p.zero && SHOWN.has(p.status);

/** Measured points of some muscles at the held values that are chosen, in the colours of their curves. */
function measuredOf(muscles, curves) {
  const held = OF_MAP[DATA.paths[choice.path].held];
  const [x, y] = [OF_MAP[choice.x], OF_MAP[choice.y]];
  if (!choice.measured || x === undefined || y === undefined) return [];
  return DATA.measured.filter((m) => muscles.includes(m.muscle)).flatMap((m) =>
    choice.held.map((value) => {
      const at = (rows) => rows.filter((row) => Math.abs(row[held] - value) <= 1e-6 * Math.max(1, Math.abs(value)))
        .map((row) => ({ x: row[x], y: row[y], row }));
      const own = curves.find((c) => c.muscle === m.muscle && c.held === value);
      return {
        muscle: m.muscle, label: `${m.label}, ${digits(value)} ${unitOf(DATA.paths[choice.path].held)}`, source: m.label,
        colour: own ? own.colour : colour("--ink"), points: at(m.points), suspect: at(m.suspect), between: at(m.between[choice.path] ?? []),
      };
    }).filter((m) => m.points.length || m.suspect.length || m.between.length))
    .map((m, _, all) => ({ ...m, mark: MARKS[unique(all.map((each) => each.source)).indexOf(m.source) % MARKS.length] }));
}

// --- drawing: the same marks by a canvas and as SVG ------------------------------------------------

/** Draws curves and points of a panel; ``pen`` has line, area and mark in pixels. */
function draw(panel, toX, toY, pen) {
  const place = (p) => [toX(p.x), toY(p.y)];
  for (const c of panel.curves) {
    const line = c.points.filter(onLine);
    if (choice.bands && line.some((p) => p.error > 0)) {
      const edge = (sign) => line.map((p) => [toX(p.x), toY(p.y + sign * (p.error || 0))]);
      pen.area([...edge(1), ...edge(-1).reverse()], c.colour);
    }
    for (const part of parts(c.points)) pen.line(part.map(place), c.colour, c.width, c.dash);
    if (line.length === 1) pen.mark("dot", ...place(line[0]), c.colour);
    for (const p of c.points.filter(drawn)) {
      if (!SHOWN.has(p.status)) pen.mark("cross", ...place(p), c.colour);
      else if (p.zero) pen.mark("ring", ...place(p), c.colour);
      else if (overstrained(p)) pen.mark("triangle", ...place(p), c.colour);
    }
  }
  for (const m of panel.measured) {
    for (const p of m.points) pen.mark(m.mark, ...place(p), m.colour);
    for (const p of m.suspect) pen.mark("plus", ...place(p), m.colour);
    for (const p of m.between) pen.mark(BETWEEN, ...place(p), m.colour);
  }
}

/** A curve in its connected parts: a state without numbers is a gap. */
function parts(points) {
  const found = [[]];
  for (const p of points.filter((p) => !p.zero)) {
    if (onLine(p)) found.at(-1).push(p);
    else if (found.at(-1).length) found.push([]);
  }
  return found.filter((part) => part.length > 1);
}

const SHAPES = { // of marks, within -1 .. 1
  cross: [[[-1, -1], [1, 1]], [[-1, 1], [1, -1]]],
  triangle: [[[0, -1.2], [1.1, 0.8], [-1.1, 0.8], [0, -1.2]]],
  plus: [[[-1, 0], [1, 0]], [[0, -1], [0, 1]]],
  star: [[[-1, 0], [1, 0]], [[-0.5, -0.87], [0.5, 0.87]], [[-0.5, 0.87], [0.5, -0.87]]],
  diamond: [[[0, -1.1], [1.1, 0], [0, 1.1], [-1.1, 0], [0, -1.1]]],
  square: [[[-0.8, -0.8], [0.8, -0.8], [0.8, 0.8], [-0.8, 0.8], [-0.8, -0.8]]],
};

function canvasPen(context, ratio) {
  const path = (points) => {
    context.beginPath();
    points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  };
  return {
    line(points, stroke, width, dash) {
      path(points);
      context.setLineDash(dash.map((d) => d * ratio));
      Object.assign(context, { strokeStyle: stroke, lineWidth: width * ratio, lineJoin: "round" });
      context.stroke();
      context.setLineDash([]);
    },
    area(points, fill) {
      path(points);
      Object.assign(context, { fillStyle: fill, globalAlpha: 0.2 });
      context.fill();
      context.globalAlpha = 1;
    },
    mark(kind, x, y, stroke) {
      const size = 4 * ratio;
      Object.assign(context, { strokeStyle: stroke, fillStyle: stroke, lineWidth: 1.5 * ratio });
      if (SHAPES[kind]) {
        for (const shape of SHAPES[kind]) { path(shape.map(([a, b]) => [x + a * size, y + b * size])); context.stroke(); }
        return;
      }
      context.beginPath();
      context.arc(x, y, kind === "dot" ? 0.75 * size : size, 0, 2 * Math.PI);
      kind === "dot" ? context.fill() : context.stroke();
    },
  };
}

function svgPen(parts) {
  const text = (points) => points.map(([x, y]) => `${x.toFixed(2)},${y.toFixed(2)}`).join(" ");
  return {
    line(points, stroke, width, dash) {
      parts.push(`<polyline points="${text(points)}" fill="none" stroke="${stroke}" stroke-width="${width}"${dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : ""}/>`);
    },
    area(points, fill) { parts.push(`<polygon points="${text(points)}" fill="${fill}" fill-opacity="0.2"/>`); },
    mark(kind, x, y, stroke) {
      for (const shape of SHAPES[kind] || []) this.line(shape.map(([a, b]) => [x + 4 * a, y + 4 * b]), stroke, 1.5, []);
      if (!SHAPES[kind]) parts.push(`<circle cx="${x.toFixed(2)}" cy="${y.toFixed(2)}" r="${kind === "dot" ? 3 : 4}" stroke="${stroke}" stroke-width="1.5" fill="${kind === "dot" ? stroke : "none"}"/>`);
    },
  };
}

// --- charts ---------------------------------------------------------------------------------------

let panels = [];

function showCharts() {
  const sides = choice.compare ? [choice.muscles, [choice.beside]] : [choice.muscles];
  let left = 0;
  const made = sides.map((muscles) => {
    const curves = curvesOf(muscles);
    left += Math.max(0, curves.length - MOST_CURVES);
    return { muscles, curves: curves.slice(0, MOST_CURVES), measured: measuredOf(muscles, curves) };
  });
  panels.forEach((p) => p.chart && p.chart.destroy());
  panels = made;
  const range = extent(panels);
  $("plots").replaceChildren(...panels.map((panel) => figureOf(panel, range)));
  panels.forEach((panel) => { panel.chart = chartOf(panel, range); });
  $("warning").textContent = !range ? "Nothing has been computed for this choice."
    : left ? `${MOST_CURVES} curves are drawn; ${left} more are chosen. Choose fewer muscles, models or held values.` : "";
}

function extent(all) {
  const points = all.flatMap((p) => [...p.curves.flatMap((c) => c.points.filter(drawn)),
    ...p.measured.flatMap((m) => [...m.points, ...m.suspect, ...m.between])]);
  if (!points.length) return null;
  return ["x", "y"].map((axis) => {
    const values = points.map((p) => p[axis]);
    const [low, high] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
    const room = axis === "y" ? 0.05 * (high - low) || 0.5 * Math.abs(high) || 1 : 0.02 * (high - low) || 0.5 * Math.abs(high) || 1;
    return [low - room, high + room];
  });
}

function figureOf(panel, range) {
  panel.box = element("div", { className: "chart", tabIndex: 0 });
  panel.box.setAttribute("role", "application");
  panel.box.setAttribute("aria-label", `${range ? named(choice.y) : ""} against ${range ? named(choice.x) : ""} of ${panel.muscles.join(", ")}; arrow keys read states`);
  panel.table = element("div", { className: "scroll" });
  panel.table.setAttribute("aria-live", "polite");
  return element("figure", {}, element("figcaption", { textContent: panel.muscles.join(", ") }), panel.box, marksOf(panel), panel.table);
}

/** What the marks of a panel mean: those that are in it. */
function marksOf(panel) {
  const points = panel.curves.flatMap((c) => c.points.filter(drawn));
  const found = [
    ...unique(panel.measured.filter((m) => m.points.length).map((m) => m.source))
      .map((source) => [panel.measured.find((m) => m.source === source).mark, `measured: ${source}`]),
    ...unique(panel.measured.filter((m) => m.between.length).map((m) => m.source)).map((source) => [BETWEEN, `between what was measured: ${source}`]),
    ["plus", "measured, not used", panel.measured.some((m) => m.suspect.length)],
    ["cross", "not valid", points.some((p) => !SHOWN.has(p.status))],
    ["ring", "zero force", points.some((p) => p.zero && SHOWN.has(p.status))],
    ["triangle", "beyond a limit of the material", points.some((p) => SHOWN.has(p.status) && !p.zero && overstrained(p))],
  ].filter(([, , there = true]) => there);
  const unknown = DATA.states.errors[choice.y] && panel.curves.some((c) => c.error_by === "not known");
  const band = [
    choice.bands && points.some((p) => p.error > 0) ? "band: error of the mesh" : "",
    unknown ? "error not known: no muscle whose meshes were compared is like it; errors: measured in the scene measures it" : "",
  ].filter(Boolean).map((textContent) => element("span", { textContent }));
  return element("p", { className: "marks" }, ...found.map(([mark, said]) => {
    const parts = [];
    svgPen(parts).mark(mark, 7, 7, colour("--ink"));
    const one = element("span", { innerHTML: `<svg width="14" height="14" aria-hidden="true">${parts.join("")}</svg> ` });
    one.append(said);
    return one;
  }), ...band);
}

function chartOf(panel, range) {
  if (!range) return null;
  const [ink, line] = [colour("--soft"), colour("--line")];
  const axis = (name) => ({ label: named(name), stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1 }, labelSize: 22 });
  const chart = new uPlot({
    width: panel.box.clientWidth || 600, height: 380,
    scales: { x: { time: false, range: (u, low, high) => [low, high] }, y: { range: (u, low, high) => [low, high] } },
    axes: [axis(choice.x), { ...axis(choice.y), size: 62 }],
    series: [{}, { paths: () => null, points: { show: false } }],
    cursor: { drag: { x: true, y: true, uni: 20 }, points: { show: false } },
    legend: { show: false },
    hooks: {
      draw: [(u) => {
        u.ctx.save();
        u.ctx.beginPath();
        u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
        u.ctx.clip();
        draw(panel, (x) => u.valToPos(x, "x", true), (y) => u.valToPos(y, "y", true), canvasPen(u.ctx, devicePixelRatio));
        u.ctx.restore();
      }],
      setCursor: [(u) => { if (u.cursor.left >= 0 && !panel.byKey) read(panel, pointed(panel, u)); }],
    },
  }, [range[0], range[1]], panel.box);
  const places = inTime() ? panel.curves.flatMap((c) => c.points.filter(drawn).map((p) => p.time))
    : [...panel.curves.flatMap((c) => c.points.filter(drawn).map((p) => p.x)), ...panel.measured.flatMap((m) => [...m.points, ...m.between].map((p) => p.x))];
  panel.xs = unique(places).sort((a, b) => a - b);
  panel.range = range;
  panel.box.onkeydown = (event) => stepByKey(panel, chart, event);
  const own = panel.curves.flatMap((c) => c.points.filter(drawn).map((p) => (inTime() ? p.time : p.x)));
  read(panel, own.length ? own.reduce((a, b) => Math.min(a, b)) : panel.xs[0]);
  return chart;
}

/** What the mouse points at: an abscissa; where curves are in time, the time of the nearest state. */
function pointed(panel, chart) {
  if (!inTime()) return chart.posToVal(chart.cursor.left, "x");
  let [least, found] = [Infinity, panel.xs[0]];
  for (const p of panel.curves.flatMap((c) => c.points.filter(drawn))) {
    const far = Math.hypot(chart.valToPos(p.x, "x") - chart.cursor.left, chart.valToPos(p.y, "y") - chart.cursor.top);
    if (far < least) [least, found] = [far, p.time];
  }
  return found;
}

function stepByKey(panel, chart, event) {
  const step = { ArrowRight: 1, ArrowLeft: -1, Home: -panel.xs.length, End: panel.xs.length }[event.key];
  if (!step) return;
  event.preventDefault();
  const at = Math.min(panel.xs.length - 1, Math.max(0, panel.xs.indexOf(panel.at) + step));
  panel.byKey = true;
  chart.setCursor({ left: chart.valToPos(abscissa(panel, panel.xs[at]), "x"), top: chart.bbox.height / devicePixelRatio / 2 });
  panel.byKey = false;
  read(panel, panel.xs[at]);
}

/** Where on the axis a panel is read: there, or where its first curve is at that time. */
function abscissa(panel, at) {
  if (!inTime()) return at;
  const found = panel.curves.map((c) => valueAt(c, at)).find(Boolean);
  return found ? found.x : at;
}

/** Numbers of every curve at the state that is nearest to x (or to a time), in the table below. */
function read(panel, x) {
  panel.at = panel.xs.reduce((best, value) => (Math.abs(value - x) < Math.abs(best - x) ? value : best), panel.xs[0]);
  const notes = new Map(); // what is said of states, with the curves of which it is
  const rows = panel.curves.map((c) => {
    const found = valueAt(c, panel.at);
    const error = found && found.error ? `± ${digits(found.error, 2)}` : found ? noError(c) : "";
    if (found && found.note) notes.set(found.note, [...(notes.get(found.note) ?? []), c]);
    const doubt = c.case_status === "unbalanced" ? c.case_reason : ""; // all its states are equilibria, yet it is not valid
    const said = found ? [doubt, found.status !== "converged" ? found.status : "", found.flags].filter(Boolean).join("; ") : c.case_reason;
    return row([key(c), c.label], found ? (found.between ? "≈ " : "") + digits(found.y) : "", error, said);
  });
  for (const m of inTime() ? [] : panel.measured) {
    for (const p of m.points.filter((p) => Math.abs(p.x - panel.at) < 1e-9)) rows.push(row(["", `measured: ${m.label}`], digits(p.y), "", ""));
    for (const p of m.between.filter((p) => Math.abs(p.x - panel.at) < 1e-9)) rows.push(row(["", `between what was measured: ${m.label}`], `≈ ${digits(p.y)}`, "", ""));
  }
  const head = row([`${named(inTime() ? "time" : choice.x)} = ${digits(panel.at)}`], named(choice.y), "error of the mesh", "", "th");
  const said = [...notes].map(([note, of]) => element("p", { className: "said", textContent: `${whose(of, panel.curves)}${note}` }));
  panel.table.replaceChildren(element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows)), ...said);
}

/** Why a curve has no error of its mesh; nothing where the page shows no errors of what is up. */
function noError(curve) {
  if (!DATA.states.errors[choice.y]) return "";
  return ["no mesh", "not known"].includes(curve.error_by) ? curve.error_by : "";
}

/** Of which curves, or muscles, something is said; nothing where it is said of all. */
function whose(some, all) {
  if (some.length === all.length) return "";
  const muscles = unique(some.map((c) => c.muscle));
  const whole = all.filter((c) => muscles.includes(c.muscle)).length === some.length;
  const names = whole ? muscles : some.map((c) => c.label);
  return `${names.slice(0, 3).join("; ")}${names.length > 3 ? ` and ${names.length - 3} more` : ""}: `;
}

function row(label, value, error, said, cell = "td") {
  const name = element(cell, { className: "name" }, ...label);
  if (said) name.append(element("span", { className: "said", textContent: said }));
  return element("tr", {}, name, element(cell, { className: "number", textContent: value }), element(cell, { className: "number", textContent: error }));
}

function key(curve) {
  const parts = [];
  svgPen(parts).line([[0, 6], [34, 6]], curve.colour, 2 * curve.width / 2, curve.dash);
  const made = element("span", { className: "key" });
  made.innerHTML = `<svg width="34" height="12" aria-hidden="true">${parts.join("")}</svg>`;
  return made;
}

/** The state of a curve at x, or a value between two of its states, or nothing. */
function valueAt(curve, x) {
  const along = inTime() ? "time" : "x";
  const exact = curve.points.find((p) => drawn(p) && Math.abs(p[along] - x) <= 1e-9 * Math.max(1, Math.abs(x)));
  if (exact) return exact;
  const line = curve.points.filter((p) => !p.zero);
  for (let k = 1; k < line.length; ++k) {
    const [a, b] = [line[k - 1], line[k]];
    if (onLine(a) && onLine(b) && (a[along] - x) * (b[along] - x) < 0) {
      const share = (x - a[along]) / (b[along] - a[along]);
      return { x: a.x + share * (b.x - a.x), y: a.y + share * (b.y - a.y), error: Math.max(a.error, b.error), between: true, status: "converged", flags: "", note: "" };
    }
  }
  return null;
}

// --- what can be taken away -------------------------------------------------------------------------

/** The states of what is drawn, and below them the measured points, whose model says so and whose variant is their source. */
function csv() {
  const quoted = (value) => (/[",\n]/.test(String(value)) ? `"${String(value).replaceAll('"', '""')}"` : String(value ?? ""));
  const { columns, errors, point, status, flags, note } = DATA.states;
  const head = ["muscle", "model", "variant", "path", "period [s]", "case", "point",
    ...Object.keys(columns).map((name) => `${name} [${DATA.quantities[name].unit}]`),
    ...Object.keys(errors).map((name) => `${name}_error [${DATA.quantities[name].unit}]`), "status", "flags", "note"];
  const rows = panels.flatMap((panel) => panel.curves).flatMap((c) => c.points.map(({ row }) =>
    [c.muscle, c.model, c.variant, c.path, c.period, c.case, point[row], ...Object.values(columns).map((v) => v[row]),
      ...Object.values(errors).map((v) => v[row]), status[row], flags[row], note[row]]));
  const told = { points: "measured", suspect: "measured, not used", between: "between what was measured" };
  const measured = panels.flatMap((panel) => panel.measured).flatMap((m) => Object.entries(told).flatMap(([kind, model]) =>
    m[kind].map(({ row }) => [m.muscle, model, m.source, choice.path, "", "", "",
      ...Object.keys(columns).map((name) => (name === "load" ? "" : row[OF_MAP[name]])),
      ...Object.keys(errors).map(() => ""), "", "", ""])));
  return [head, ...rows, ...measured].map((cells) => cells.map(quoted).join(",")).join("\r\n") + "\r\n";
}

/** Round numbers between two ends, about ``count`` of them. */
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((k) => k * power >= rough) * power;
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; ++k) found.push(Number((k * step).toPrecision(12)));
  return found;
}

/** All panels as one SVG, with axes and a legend. */
function svg() {
  const [width, height, left, top, gap] = [520, 360, 70, 30, 20];
  const escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;");
  const legend = Math.max(...panels.map((p) => p.curves.length + p.measured.length));
  const all = { width: panels.length * (width + left + gap), height: top + height + 60 + 16 * legend };
  const out = [`<svg xmlns="http://www.w3.org/2000/svg" width="${all.width}" height="${all.height}" font-family="sans-serif" font-size="12" fill="${colour("--ink")}">`,
    `<rect width="100%" height="100%" fill="${colour("--ground")}"/>`];
  panels.forEach((panel, number) => {
    if (!panel.range) return;
    const [x0, y0] = [number * (width + left + gap) + left, top];
    const { min: xl, max: xh } = panel.chart.scales.x;
    const { min: yl, max: yh } = panel.chart.scales.y;
    const toX = (x) => x0 + (width * (x - xl)) / (xh - xl);
    const toY = (y) => y0 + height - (height * (y - yl)) / (yh - yl);
    out.push(`<clipPath id="c${number}"><rect x="${x0}" y="${y0}" width="${width}" height="${height}"/></clipPath>`);
    for (const x of ticks(xl, xh, 7)) out.push(`<line x1="${toX(x)}" x2="${toX(x)}" y1="${y0}" y2="${y0 + height}" stroke="${colour("--line")}"/><text x="${toX(x)}" y="${y0 + height + 16}" text-anchor="middle">${x}</text>`);
    for (const y of ticks(yl, yh, 7)) out.push(`<line x1="${x0}" x2="${x0 + width}" y1="${toY(y)}" y2="${toY(y)}" stroke="${colour("--line")}"/><text x="${x0 - 6}" y="${toY(y) + 4}" text-anchor="end">${y}</text>`);
    out.push(`<text x="${x0}" y="18" font-weight="bold">${escaped(panel.muscles.join(", "))}</text>`,
      `<text x="${x0 + width / 2}" y="${y0 + height + 36}" text-anchor="middle">${escaped(named(choice.x))}</text>`,
      `<text transform="translate(${x0 - 54} ${y0 + height / 2}) rotate(-90)" text-anchor="middle">${escaped(named(choice.y))}</text>`,
      `<g clip-path="url(#c${number})">`);
    draw(panel, toX, toY, svgPen(out));
    out.push("</g>");
    panel.curves.forEach((c, k) => {
      svgPen(out).line([[x0, y0 + height + 54 + 16 * k], [x0 + 34, y0 + height + 54 + 16 * k]], c.colour, c.width, c.dash);
      out.push(`<text x="${x0 + 42}" y="${y0 + height + 58 + 16 * k}">${escaped(c.label)}</text>`);
    });
    panel.measured.forEach((m, k) => {
      const y = y0 + height + 54 + 16 * (panel.curves.length + k);
      const own = m.points.length || m.suspect.length;
      svgPen(out).mark(m.points.length ? m.mark : own ? "plus" : BETWEEN, x0 + 17, y, m.colour);
      out.push(`<text x="${x0 + 42}" y="${y + 4}">${escaped(`${own ? "measured" : "between what was measured"}: ${m.label}`)}</text>`);
    });
  });
  return [...out, "</svg>"].join("\n");
}

async function png() {
  const image = new Image();
  image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(svg());
  await image.decode();
  const canvas = element("canvas", { width: 2 * image.width, height: 2 * image.height });
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}

function save(blob, ending) {
  const link = element("a", { href: URL.createObjectURL(blob), download: `${choice.muscles[0]}_${choice.path}_${choice.y}.${ending}` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// --- the wall ---------------------------------------------------------------------------------------

let wall = { group: 0, quantity: 0, at: 0, timer: 0 };
let groups = [];

/** Walls of one muscle, model, variant and path belong together: what goes on is held value and state. */
function wallGroups() {
  const found = new Map();
  for (const state of DATA.walls.states) {
    const c = DATA.curves[state.curve];
    if (!shownMuscles().includes(c.muscle)) continue;
    const name = [c.muscle, DATA.models[c.model], c.variant, c.path, ...(c.period ? [`period ${digits(c.period)} s`] : [])].join(", ");
    if (!found.has(name)) found.set(name, { name, states: [] });
    found.get(name).states.push(state);
  }
  return [...found.values()];
}

function showWall() {
  groups = wallGroups();
  const any = groups.length > 0;
  $("wall-shown").hidden = !any;
  $("wall-none").textContent = any ? "" : "No fields have been recorded for what is shown. A scene with quantities: [stress] and models: [solid] records them.";
  if (any && DATA.walls.leftOut) $("wall-none").textContent = `${DATA.walls.leftOut} states of this study are left out here; the records have them all.`;
  if (!any) return stop();
  if (wall.group >= groups.length) wall.group = 0;
  $("wall-curve").replaceChildren(...groups.map((g, k) => new Option(g.name, k, false, k === wall.group)));
  $("wall-quantity").replaceChildren(...Object.values(DATA.walls.quantities).map(([unit, label], k) =>
    new Option(unit === "1" ? label : `${label} [${unit}]`, k, false, k === wall.quantity)));
  const states = groups[wall.group].states;
  wall.at = Math.min(wall.at, states.length - 1);
  Object.assign($("wall-at"), { max: states.length - 1, value: wall.at });
  drawWall();
}

function drawWall() {
  const { states } = groups[wall.group];
  const state = states[wall.at];
  const curve = DATA.curves[state.curve];
  const { held, swept, inTime: timed } = DATA.paths[curve.path];
  const along = unique([swept, ...(timed ? ["time"] : [])]).map((name) => [name, DATA.states.columns[name][state.row]]);
  const said = [[held, curve.held], ...along]
    .map(([name, value]) => `${name} ${digits(value)} ${unitOf(name)}`.trim()).join(", ");
  $("wall-state").textContent = `${said} (${wall.at + 1} of ${states.length})`;
  const bounds = (list) => list.reduce(([a, b], values) => values.reduce(([c, d], v) => [Math.min(c, v), Math.max(d, v)], [a, b]), [Infinity, -Infinity]);
  const [low, high] = bounds(states.map((s) => s.values[wall.quantity]));
  const [z0, z1] = bounds(states.map((s) => s.z));
  const r1 = bounds(states.map((s) => s.r))[1];
  const canvas = $("wall-canvas");
  const ratio = devicePixelRatio;
  const width = canvas.clientWidth || 600;
  const scale = width / (1.02 * (z1 - z0));
  const height = 2.1 * r1 * scale;
  Object.assign(canvas, { width: width * ratio, height: height * ratio });
  canvas.style.height = `${height}px`;
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  const colours = state.values[wall.quantity].map((v) => shade((v - low) / (high - low || 1)));
  for (const side of [1, -1]) {
    colours.forEach((fill, k) => {
      context.beginPath();
      for (let corner = 3 * k; corner < 3 * k + 3; ++corner) {
        context.lineTo((state.z[corner] - z0) * scale, height / 2 - side * state.r[corner] * scale);
      }
      context.closePath();
      Object.assign(context, { fillStyle: fill, strokeStyle: fill, lineWidth: 0.5 });
      context.fill();
      context.stroke();
    });
  }
  context.setLineDash([6, 4]);
  Object.assign(context, { strokeStyle: colour("--soft"), lineWidth: 1 });
  context.strokeRect(-5, height / 2, width + 10, 0);
  const [unit, label] = Object.values(DATA.walls.quantities)[wall.quantity];
  const bar = [0, 0.25, 0.5, 0.75, 1].map(shade).join(", ");
  $("wall-scale").replaceChildren(`${digits(low, 3)} `, element("span", { style: `display:inline-block;width:12rem;height:.8rem;vertical-align:middle;background:linear-gradient(to right, ${bar})` }),
    ` ${digits(high, 3)} ${unit === "1" ? "" : unit} ${label}; section along the axis, mid-length on the left, fitting on the right`);
  canvas.setAttribute("aria-label", `Wall of ${groups[wall.group].name}: ${label} at ${said}, ${digits(low, 3)} to ${digits(high, 3)} ${unit} in all its states`);
}

function shade(share) {
  const place = Math.min(1, Math.max(0, share)) * (VIRIDIS.length - 1);
  const k = Math.min(VIRIDIS.length - 2, Math.floor(place));
  return `rgb(${VIRIDIS[k].map((c, i) => Math.round(c + (place - k) * (VIRIDIS[k + 1][i] - c))).join(",")})`;
}

function stop() {
  clearInterval(wall.timer);
  wall.timer = 0;
  $("play").textContent = "Play";
  $("play").setAttribute("aria-pressed", "false");
}

function play() {
  if (wall.timer) return stop();
  $("play").textContent = "Pause";
  $("play").setAttribute("aria-pressed", "true");
  wall.timer = setInterval(() => {
    wall.at = (wall.at + 1) % groups[wall.group].states.length;
    $("wall-at").value = wall.at;
    drawWall();
  }, STEP_TIME);
}

// --- muscles and verdicts ---------------------------------------------------------------------------

function table(head, rows, name = "") {
  const cells = (values, name) => values.map((value) => element(name, { textContent: typeof value === "number" ? digits(value) : value ?? "", className: typeof value === "number" ? "number" : "" }));
  return element("div", { className: "scroll" }, element("table", { className: name }, element("thead", {}, element("tr", {}, ...cells(head, "th"))),
    element("tbody", {}, ...rows.map((values) => element("tr", {}, ...cells(values, "td"))))));
}

const shownMuscles = () => unique([...choice.muscles, ...(choice.compare ? [choice.beside] : [])]);

function showMuscles() {
  const names = shownMuscles().slice(0, MOST_CURVES);
  const chosen = DATA.muscles.filter((m) => names.includes(m.name));
  const rows = Object.entries(DATA.muscleLabels).map(([name, [unit, label]]) =>
    [unit && unit !== "1" ? `${label} [${unit}]` : label, ...chosen.map((m) => m[name])]);
  $("sheet").replaceChildren(table(["", ...chosen.map((m) => m.name)], rows), ...designSheets());
}

/** The data sheets of the curves that are shown, one column each. */
function designSheets() {
  const { columns, notes, most } = DATA.sheets;
  const shown = panels.flatMap((p) => p.curves).filter((c) => columns[c.number]);
  const few = shown.slice(0, MOST_SHEETS);
  if (!few.length) return [];
  const names = unique(few.flatMap((c) => Object.keys(columns[c.number]))).filter((name) => few.some((c) => columns[c.number][name] !== null && columns[c.number][name] !== undefined));
  const how = (name) => {
    const said = unique(few.map((c) => notes[c.number][name] ?? ""));
    return said.length === 1 ? said[0] : "";
  };
  const rows = names.map((name) => [name.replace(" [1]", ""), ...few.map((c) => rounded(columns[c.number][name])), how(name)]);
  const said = [shown.length > few.length ? `${few.length} of ${shown.length} are shown.` : "", Object.keys(columns).length >= most ? `The first ${most} curves have one.` : ""].filter(Boolean).join(" ");
  return [element("h3", { textContent: "Data sheets of what is shown" }),
    element("p", { className: "hint", textContent: `From these curves at constant pressure; air in normal litres. ${said}` }),
    table(["", ...few.map((c) => c.label), "how"], rows, "sheet")];
}

const rounded = (value) => (typeof value === "number" ? Number(value.toPrecision(4)) : value);

function showVerdicts() {
  const parts = [];
  const muscles = shownMuscles();
  const deviations = DATA.deviations.filter((d) => muscles.includes(d.muscle) && choice.models.includes(d.model) && choice.variants.includes(d.variant)
    && (choice.path === "isobaric" && choice.held.length === 1 ? Number(d.pressure) === choice.held[0] : d.pressure === "all"));
  const claims = DATA.claims.filter((c) => !c.muscles || c.muscles.some((name) => muscles.includes(name)));
  const percent = (share) => (share === null ? "" : `${(100 * share).toFixed(1)} %`);
  if (deviations.length) {
    parts.push(element("p", { textContent: "Difference from measured maps, in % of the largest measured force at that pressure:" }),
      table(["muscle", "model", "variant", "map", "pressure [MPa]", "mean", "largest"],
        deviations.map((d) => [d.muscle, DATA.models[d.model] || d.model, d.variant, d.reference, d.pressure, percent(d.mean), percent(d.largest)])));
  }
  if (DATA.claims.length) {
    parts.push(element("p", { textContent: claims.length ? "Claims of the paper about what is shown:" : "No claim of the paper is about what is shown." }));
    if (claims.length) parts.push(table(["claim", "figure", "paper", "ours", "verdict", "why"],
      claims.map((c) => [`${c.id}: ${c.claim}`, c.figure ?? "", c.paper ?? "", c.ours === null ? "" : `${digits(c.ours, 3)} ${c.unit === "1" ? "" : c.unit}`, c.verdict, c.why ?? ""])));
  } else if (DATA.hasClaims) {
    parts.push(element("p", { className: "hint", textContent: "The claims of the paper have not been judged in this folder: .venv/bin/snakemake --cores 2 claims does it." }));
  }
  $("compared").hidden = !parts.length;
  $("claims").replaceChildren(...parts);
}

// --- choices ----------------------------------------------------------------------------------------

function showChoices() {
  const curves = DATA.curves.filter((c) => c.path === choice.path);
  const fill = (id, values, chosen) => $(id).replaceChildren(...values.map(([value, label]) => new Option(label, value, false, value === chosen)));
  fill("path", Object.keys(DATA.paths).map((p) => [p, p]), choice.path);
  for (const axis of ["x", "y"]) {
    fill(axis, Object.keys(DATA.quantities).map((name) => [name, named(name)]), choice[axis]);
    $(axis).title = DATA.quantities[choice[axis]].label;
  }
  $("held-legend").textContent = named(DATA.paths[choice.path].held);
  boxes("held", unique(curves.map((c) => c.held)).sort((a, b) => a - b), String);
  boxes("models", Object.keys(DATA.models).filter((m) => curves.some((c) => c.model === m)), (m) => DATA.models[m]);
  boxes("variants", unique(curves.map((c) => c.variant)), String);
  const muscles = unique(curves.map((c) => c.muscle));
  const sought = listed();
  const found = sought.length === muscles.length ? muscles : unique([...sought, ...muscles.filter((m) => choice.muscles.includes(m))]);
  boxes("muscles", found.slice(0, MOST_MUSCLES), String);
  if (found.length > MOST_MUSCLES) $("muscles").append(element("span", { textContent: `${MOST_MUSCLES} of ${found.length}: Find narrows the list.` }));
  fill("beside", muscles.map((m) => [m, m]), choice.beside);
  $("beside-box").hidden = !choice.compare;
  for (const name of ["bands", "measured", "compare"]) $(name).checked = choice[name];
}

/** Muscles of the path whose names have what is sought. */
function listed() {
  const wanted = $("find").value.toLowerCase();
  return unique(DATA.curves.filter((c) => c.path === choice.path).map((c) => c.muscle)).filter((m) => m.toLowerCase().includes(wanted));
}

function boxes(key, values, label) {
  $(key).replaceChildren(...values.map((value) => {
    const box = element("input", { type: "checkbox", checked: choice[key].includes(value), value });
    box.onchange = () => {
      choice[key] = box.checked ? [...choice[key], value] : choice[key].filter((v) => v !== value);
      show();
    };
    return element("label", {}, box, ` ${label(value)}`);
  }));
}

function show() {
  const focus = document.activeElement && [document.activeElement.id, document.activeElement.value, document.activeElement.closest && document.activeElement.closest(".options")];
  showChoices();
  showCharts();
  showWall();
  showMuscles();
  showVerdicts();
  history.replaceState(null, "", address());
  if (focus && focus[2] && focus[2].id) [...focus[2].querySelectorAll("input")].find((box) => box.value === focus[1])?.focus();
}

function listen() {
  const said = (text) => { $("done").textContent = text; };
  $("choice").onsubmit = (event) => event.preventDefault();
  $("path").onchange = () => { Object.assign(choice, ofPath($("path").value, choice.muscles[0])); show(); };
  for (const key of ["x", "y", "beside"]) $(key).onchange = () => { choice[key] = $(key).value; show(); };
  for (const key of ["bands", "measured", "compare"]) $(key).onchange = () => { choice[key] = $(key).checked; show(); };
  $("find").oninput = showChoices;
  $("all").onclick = () => { choice.muscles = unique([...choice.muscles, ...listed().slice(0, MOST_MUSCLES)]); show(); };
  $("none").onclick = () => { choice.muscles = choice.muscles.slice(0, 1); show(); };
  $("csv").onclick = () => save(new Blob([csv()], { type: "text/csv" }), "csv");
  $("svg").onclick = () => save(new Blob([svg()], { type: "image/svg+xml" }), "svg");
  $("png").onclick = async () => save(await png(), "png");
  $("link").onclick = async () => {
    try { await navigator.clipboard.writeText(location.href); said("The link is copied."); } catch { said("Copy it from the address bar: the choice stands in it."); }
  };
  $("whole").onclick = showCharts;
  $("wall-curve").onchange = () => { wall.group = Number($("wall-curve").value); wall.at = 0; showWall(); };
  $("wall-quantity").onchange = () => { wall.quantity = Number($("wall-quantity").value); drawWall(); };
  $("wall-at").oninput = () => { wall.at = Number($("wall-at").value); drawWall(); };
  $("play").onclick = play;
  addEventListener("hashchange", () => { choice = fromAddress(); show(); });
  let waiting = 0;
  addEventListener("resize", () => { clearTimeout(waiting); waiting = setTimeout(() => { showCharts(); if (groups.length) drawWall(); }, 150); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
}

async function start() {
  if (typeof DecompressionStream === "undefined") {
    $("summary").textContent = "This browser is too old to unpack the numbers of this page; one of 2023 or later does.";
    return;
  }
  DATA = await unpacked($("content").textContent);
  const count = DATA.states.status.length;
  const counted = (number, name) => `${number} ${name}${number === 1 ? "" : "s"}`;
  $("summary").textContent = `${counted(DATA.muscles.length, "muscle")}, ${counted(DATA.curves.length, "curve")}, ${counted(count, "state")}.`
    + (DATA.leftOut.length ? ` With so many states the solver's own numbers (${DATA.leftOut.join(", ")}) stand in the dataset only.` : "")
    + (DATA.thinned ? ` ${counted(DATA.thinned, "curve")} in time ${DATA.thinned === 1 ? "is" : "are"} thinned; the dataset has every step.` : "");
  if (!DATA.curves.length) { $("warning").textContent = "Nothing has been computed yet."; return; }
  choice = fromAddress();
  listen();
  show();
}

start();
