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
    .map(([name, y]) => `${name} ${shown(y)}${unit(plot.y)}`);
  const away = Array.from(plot.stops.x, (x) => Math.abs(x - plot.at)), least = Math.min(...away);
  return plot.stops.names.flatMap((name, k) => away[k] - least > 1e-9 ? [] : [`${name} ${shown(plot.stops.y[k])}`]);
};
const critical = (plot) => { // the nearest of those that the diagram of the figure, or the one above it, names
  const known = plot.figure.critical || [];
  const near = known.reduce((best, one) => best && Math.abs(best.x - plot.at) <= Math.abs(one.x - plot.at) ? best : one, null);
  if (!near) return "";
  const by = 100 * (plot.at / near.x - 1);
  const where = Math.abs(by) < 5e-4 ? "at it" : `${shown(Number(Math.abs(by).toPrecision(3)))} % ${by > 0 ? "above" : "below"} it`;
  return `nearest ${near.words}; the cursor is ${where}`;
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
const move = (source, value) => {
  for (const plot of linked(source)) {
    plot.at = value;
    const at = value === null ? -1 : place(plot, value), [left, , wide] = plot.box, isOn = at > -1e-9 && at < 1 + 1e-9;
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
const peaks = (plot) => { // abscissas of the peaks of the line that matters most, of the points of a diagram, or critical speeds
  const shownLines = plot.lines.filter((line) => !plot.off.has(line.name) && line.x.length > 2);
  const main = shownLines.find((line) => line.name.includes("synthesis")) || shownLines[0];
  const points = plot.ranges ? (plot.figure.critical || []).map((one) => one.x) : plot.marks.flatMap((marks) => [...marks.x]);
  if (!main) return points.filter((x) => x === clamp(x, ...plot.x.ends)).sort((one, other) => one - other);
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
