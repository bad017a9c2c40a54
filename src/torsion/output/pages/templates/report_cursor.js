// One cursor over all plots that share their axis: what it reads off, and the nearest critical speed.
const unit = (axis) => axis.unit ? ` ${axis.unit}` : "";
const texts = (plot) => {
  if (plot.ranges) {
    const inside = plot.ranges.filter(([, low, high]) => low <= plot.at && plot.at <= high).map(([words]) => words);
    return inside.length ? inside : ["in none of the ranges"];
  }
  if (!plot.stops) return plot.lines
    .filter((line) => !plot.off.has(line.name))
    .map((line) => [line.name, valueAt(line, plot.at)])
    .filter(([, y]) => !Number.isNaN(y))
    .map(([name, y]) => `${name} ${y === null ? "–" : `${shown(y)}${unit(plot.y)}`}`);
  const away = Array.from(plot.stops.x, (x) => Math.abs(x - plot.at)), least = Math.min(...away);
  return plot.stops.names.flatMap((name, k) => away[k] - least > 1e-9 ? [] : [`${name} ${shown(plot.stops.y[k])}`]);
};
const isOff = (plot, order) => { // all lines of an order of the figure are off: "order 2", or "order 2, exact"
  const own = plot.figure.own.flatMap((one) => one.lines.map(({ name }) => name));
  const lines = own.filter((name) => name === order || name.startsWith(`${order},`));
  return plot.off.has("orders") || (lines.length > 0 && lines.every((name) => plot.off.has(name)));
};
const criticals = (plot) => { // the places of those whose order is not off
  const known = plot.figure.criticals;
  const off = known && known.orders.map((order) => isOff(plot, order));
  return known ? [...known.x.keys()].filter((k) => !off[known.order[k]]) : [];
};
const critical = (plot) => { // the nearest of all that belong to the figure
  const known = plot.figure.criticals, away = (k) => Math.abs(known.x[k] - plot.at);
  const near = criticals(plot).reduce((best, k) => best !== null && away(best) <= away(k) ? best : k, null);
  if (near === null) return "";
  const x = known.x[near], by = 100 * (plot.at / x - 1), short = (value) => shown(Number(value.toPrecision(3)));
  const margin = known.rated ? `, ${short(100 * (x / known.rated - 1))} % from rated` : "";
  const where = Math.abs(by) < 5e-4 ? "at it" : `${short(Math.abs(by))} % ${by > 0 ? "above" : "below"} it`;
  return `nearest ${known.of} ${shown(x)} rpm: ${known.orders[known.order[near]]} excites mode ${known.mode[near]} `
    + `at ${shown(known.frequency[near])} Hz${margin}; the cursor is ${where}`;
};
const read = (figure) => { // what stands below a figure
  const own = figure.own.filter((plot) => plot.isRead), [first] = own;
  if (first.at === null) { figure.values.textContent = ""; figure.near.textContent = figure.point || ""; return; }
  const head = first.stops ? "" : `${shown(first.at)}${unit(first.x)}: `;
  const titled = (plot) => `${first.stops ? `${plot.y.title}: ` : ""}${texts(plot).join(", ")}`;
  figure.values.textContent = head + own.map(titled).join("; ");
  figure.near.textContent = figure.point || critical(first);
  for (const plot of own) {
    plot.area.setAttribute("aria-valuenow", plot.at);
    plot.area.setAttribute("aria-valuetext", [figure.values, figure.near].map((one) => one.textContent).filter(Boolean).join("; "));
  }
};
const computed = (plot, value) => { // where a plot has values: each stands at a point of its own
  const { steps } = plot.figure.own.find((own) => own.steps && own.link === plot.link) || plot;
  return !steps || plot.stops || value < steps[0] || value > steps.at(-1) ? value : steps[nearest(steps, value)];
};
const move = (source, value) => {
  for (const plot of linked(source)) {
    plot.at = value === null || plot.figure === source.figure ? value : computed(plot, value);
    const at = value === null ? -1 : place(plot, plot.at), [left, , wide] = plot.box, isOn = at > -1e-9 && at < 1 + 1e-9;
    plot.cursor.setAttribute("visibility", isOn ? "visible" : "hidden");
    if (isOn) plot.cursor.setAttribute("transform", `translate(${left + at * wide} 0)`);
  }
  new Set(linked(source).map((plot) => plot.figure)).forEach(read);
};
const seen = (plot, value) => { // the cursor, and what is shown goes with it
  move(plot, value);
  const at = share(plot.x, value), [a, b] = plot.view;
  if (at < a - 1e-9 || at > b + 1e-9) pan(plot, at - (a + b) / 2);
};
const snapped = (plot, value) => // to what was solved, where the lines are more than straight
  plot.steps ? plot.steps[nearest(plot.steps, value)] : clamp(value, ...plot.x.ends);
const stepped = (plot, key) => {
  const { steps } = plot, [low, high] = plot.x.ends, now = plot.at === null ? low : plot.at;
  const jump = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[key];
  if (key === "Home" || key === "End") return snapped(plot, key === "Home" ? low : high);
  if (jump === undefined) return undefined;
  if (!steps) return snapped(plot, now + jump * (high - low) / 200);
  return steps[clamp(nearest(steps, now) + (plot.at === null ? 0 : jump), 0, steps.length - 1)];
};
const peaks = (plot) => { // abscissas of the critical speeds that are marked, or of the peaks of the line that matters most
  if (plot.ranges || plot.marks.length) {
    const known = new Set(criticals(plot).map((k) => plot.figure.criticals.x[k]));
    const marked = plot.marks.filter((marks) => !plot.off.has(marks.name)).flatMap((marks) => [...marks.x]);
    const points = plot.ranges ? [...known] : marked.filter((x) => known.has(x));
    return points.filter((x) => x === clamp(x, ...plot.x.ends)).sort((one, other) => one - other);
  }
  const shownLines = plot.lines.filter((line) => !plot.off.has(line.name) && line.x.length > 2);
  const main = shownLines.find((line) => line.name.startsWith("total ")) || shownLines[0];
  if (!main) return [];
  const { x, y } = main;
  return [...x].filter((_, k) => k > 0 && k < x.length - 1 && y[k] > y[k - 1] && y[k] >= y[k + 1]);
};
const peak = (plot, way) => { // the next one to the right (way 1) or to the left (-1), and round again
  const found = peaks(plot), now = plot.at === null ? -Infinity * way : plot.at;
  const ahead = found.filter((x) => (x - now) * way > 1e-9 * Math.abs(now || 1));
  return way > 0 ? ahead[0] ?? found[0] : ahead.at(-1) ?? found.at(-1);
};
const reset = (plot) => { // no cursor, the whole, every line
  move(plot, null);
  zoom(plot);
  plot.figure.querySelectorAll("[role=checkbox][aria-checked=false]").forEach((entry) => entry.dispatchEvent(new Event("click")));
};
