// The plots of the page: what their data are, which part of them is shown.
const SVG = "http://www.w3.org/2000/svg", PLOTS = [];
const make = (name, attributes, parent, before) => {
  const made = document.createElementNS(SVG, name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  parent.insertBefore(made, before || null);
  return made;
};
const element = (name, attributes, text, parent) => {
  const made = document.createElement(name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  made.textContent = text;
  parent.append(made);
  return made;
};
const button = (text, parent, act, more) => {
  const made = element("button", { type: "button", ...more }, text, parent);
  made.addEventListener("click", act);
  return made;
};
const linked = (plot) => PLOTS.filter((other) => other.link === plot.link); // those over the same
const place = (plot, value) => (share(plot.x, value) - plot.view[0]) / (plot.view[1] - plot.view[0]);
const valueOf = (plot, at) => inverse(plot.x, plot.view[0] + at * (plot.view[1] - plot.view[0]));
const isZoomed = (plot) => plot.view[0] > 0 || plot.view[1] < 1;

const strokes = (plot, zoomed) => { // as wide in px of the screen as before
  const scale = plot.svg.clientWidth / plot.svg.viewBox.baseVal.width / 10;
  for (const one of plot.inner.flatMap((inner) => [...inner.querySelectorAll("[stroke-width]")])) {
    one.style.vectorEffect = zoomed ? "non-scaling-stroke" : "";
    one.style.strokeWidth = zoomed ? one.getAttribute("stroke-width") * scale : "";
    const dashes = one.getAttribute("stroke-dasharray");
    if (dashes) one.style.strokeDasharray = zoomed ? dashes.split(" ").map((dash) => dash * scale).join(" ") : "";
    if (!zoomed) one.removeAttribute("style");
  }
};
const moved = (path, [a, b], wide) => (path.original ||= path.getAttribute("d"))
  .replace(/M(-?\d+) (-?\d+)([^M]*)/g, (_, x, y, rest) => {
    const at = (x / (10 * wide) - a) / (b - a);
    return at < -1e-3 || at > 1.001 ? "" : `M${Math.round(10 * wide * at)} ${y}${rest}`;
  });
const scaled = (plot) => { // grid and numbers of the part that is shown
  const [left, top, wide, high] = plot.box;
  const levels = plot.grid.getAttribute("d").match(/M[^M]*h[^M]*/g) || [], lines = [];
  const ends = [valueOf(plot, 0), valueOf(plot, 1)].sort((one, other) => one - other);
  for (const [value, text] of ticks(...ends, 8)) {
    const x = left + place(plot, value) * wide;
    lines.push(`M${x} ${top}v${high}`);
    const look = { x, y: top + high + 13, "text-anchor": "middle", "font-size": 10.5, fill: "#222222" };
    if (plot.numbers.length) make("text", look, plot.scale).textContent = text;
  }
  make("path", { d: levels.concat(lines).join(""), stroke: "#dddddd", "stroke-width": 0.6, fill: "none" }, plot.scale);
};
const show = (plot, view) => { // a part of a plot, from a share of its width to another
  plot.view = view;
  const zoomed = isZoomed(plot), [a, b] = view, wide = plot.box[2];
  for (const inner of plot.inner) {
    const [, , w, h] = inner.original ||= inner.getAttribute("viewBox").split(" ").map(Number);
    inner.setAttribute("viewBox", `${a * w} 0 ${(b - a) * w} ${h}`);
  }
  strokes(plot, zoomed);
  plot.front.querySelectorAll(".words").forEach((words) => { words.style.display = zoomed ? "none" : ""; });
  plot.front.querySelectorAll(":scope > :not(.words) path, :scope > path").forEach((path) =>
    path.setAttribute("d", moved(path, view, wide)));
  plot.scale.replaceChildren();
  for (const one of [...plot.numbers, plot.grid]) one.style.display = zoomed ? "none" : "";
  if (zoomed) scaled(plot);
};
const LEAST = 1e-4; // of an axis: what is shown of it at least
const zoom = (source, a, b) => { // all plots over the same; without a part, back to the whole
  if (source.x.places) return;
  const ends = a === undefined ? null : [a, b].map((at) => inverse(source.x, at));
  for (const plot of linked(source)) {
    const [low, high] = ends ? ends.map((end) => clamp(share(plot.x, end), 0, 1)) : [0, 1];
    if (high - low >= LEAST) show(plot, [low, high]); else if (!ends || high === low) show(plot, [0, 1]);
  }
  if (source.at !== null) move(source, source.at);
};
const nearer = (plot, factor, about) => { // about: share of what is shown that stays where it is
  const [a, b] = plot.view, wide = Math.min((b - a) * factor, 1), low = clamp(a + (b - a - wide) * about, 0, 1 - wide);
  if (wide >= LEAST) zoom(plot, low, low + wide);
};
const pan = (plot, by) => { // by a share of the axis
  const [a, b] = plot.view, low = clamp(a + by, 0, 1 - (b - a));
  zoom(plot, low, low + b - a);
};

const ascending = (values) => // each once
  [...values].sort((one, other) => one - other).filter((x, k, all) => !k || !same(x, all[k - 1]));
const opened = (figure, svg, plot) => { // a plot of the data with what of the drawing belongs to it
  const [left, top, wide, high] = plot.box;
  for (const line of plot.lines) {
    const [x, y] = [numbers(line.x), numbers(line.y)], kept = [...x.keys()].filter((k) => Number.isFinite(x[k]));
    const whole = kept.length === x.length;
    Object.assign(line, { key: line.x, x: whole ? x : kept.map((k) => x[k]), y: whole ? y : kept.map((k) => y[k]) });
  }
  for (const marks of plot.marks) marks.x = numbers(marks.x);
  const stops = plot.stops && { x: numbers(plot.stops.x), y: numbers(plot.stops.y), names: STORE.names[plot.stops.names] };
  const solved = new Map(plot.lines.filter((line) => !isStraight(line)).map((line) => [line.key, line.x])), at = (one) => Number(one.getAttribute("y"));
  const stands = (one) => Math.abs(one.getAttribute("x") - left) < 0.1 && Math.abs(at(one) - top) < 0.1;
  Object.assign(plot, {
    figure, svg, stops, at: null, view: [0, 1], off: new Set(), isRead: plot.lines.length > 0 || Boolean(stops || plot.ranges),
    link: plot.x.title || JSON.stringify(plot.x.ends),
    steps: stops || solved.size ? ascending(stops ? stops.x : [...solved.values()].flatMap((x) => [...x])) : null,
    inner: [...svg.querySelectorAll("svg.plot")].filter(stands),
    front: [...svg.querySelectorAll(".front")].find((one) => {
      const { e, f } = one.transform.baseVal[0].matrix;
      return Math.abs(e - left) < 0.1 && Math.abs(f - top) < 0.1;
    }),
    numbers: [...svg.querySelectorAll("text.across")].filter((one) => Math.abs(at(one) - top - high - 13) < 0.1),
    grid: [...svg.querySelectorAll(".grid")].find((one) => one.getAttribute("d").includes(`M${left} `)
      && Math.abs(one.getBBox().y - top) < high) || svg.querySelector(".grid"),
  });
  if (!plot.isRead) return plot;
  plot.area = make("rect", { x: left, y: top, width: wide, height: high, fill: "transparent", class: "area", tabindex: 0,
    role: "slider", "aria-label": `cursor: ${[plot.x.title || "along the train", plot.y.title].filter(Boolean).join("; ")}`, "aria-valuemin": plot.x.ends[0],
    "aria-valuemax": plot.x.ends[1], "aria-valuenow": plot.x.ends[0], "aria-valuetext": "not on the plot yet" },
    svg, [...svg.querySelectorAll(".paper, .area")].at(-1).nextSibling);
  plot.cursor = make("path", { d: `M0 ${top}v${high}`, stroke: "#222222", class: "cursor", visibility: "hidden" }, svg);
  plot.scale = make("g", { class: "scale" }, svg, plot.grid.nextSibling);
  PLOTS.push(plot);
  return plot;
};
