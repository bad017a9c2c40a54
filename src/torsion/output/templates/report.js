"use strict";
// A cursor over all plots that share their x axis, values with units, lines switched on and off by their key.
(() => {
  const SVG = "http://www.w3.org/2000/svg", XS = JSON.parse(document.getElementById("coordinates").textContent);
  const plots = [];
  const make = (name, attributes, parent, before) => {
    const made = document.createElementNS(SVG, name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    parent.insertBefore(made, before || null);
    return made;
  };
  const shown = (value) => value === null ? "no value" : String(Number(value.toPrecision(5))).replace("-", "−");
  const share = (axis, value) => {
    const [low, high] = axis.ends;
    const at = axis.log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    return axis.reversed ? 1 - at : at;
  };
  const inverse = (axis, at) => {
    const [low, high] = axis.ends, s = axis.reversed ? 1 - at : at;
    return axis.log ? low * Math.pow(high / low, s) : low + s * (high - low);
  };
  const below = (x, value) => { // the last place of an ascending list that is not above the value
    let low = 0, high = x.length - 1;
    while (low < high) { const middle = (low + high + 1) >> 1; if (x[middle] <= value) low = middle; else high = middle - 1; }
    return low;
  };
  const valueAt = (line, value) => {
    const x = XS[line.x], k = below(x, value), last = x.length - 1;
    if (value < x[0] || value > x[last]) return null;
    const a = line.y[k], b = line.y[Math.min(k + 1, last)];
    if (x[k] === value || k === last) return a;
    return a === null || b === null ? null : a + (b - a) * (value - x[k]) / (x[k + 1] - x[k]);
  };
  const snapped = (plot, value) => { // to a speed that was solved, where the lines are more than straight
    if (plot.grid === null) return Math.min(Math.max(value, plot.x.ends[0]), plot.x.ends[1]);
    const x = XS[plot.grid], k = below(x, value);
    return k + 1 < x.length && x[k + 1] - value < value - x[k] ? x[k + 1] : x[k];
  };
  const texts = (plot, value) => plot.lines
    .filter((line) => !plot.off.has(line.name))
    .map((line) => [line.name, valueAt(line, value)])
    .filter(([, y]) => y !== null)
    .map(([name, y]) => `${name} ${shown(y)}${plot.y.unit ? " " + plot.y.unit : ""}`);
  const write = (figure) => {
    const own = plots.filter((plot) => plot.figure === figure);
    if (own[0].at === null) { figure.out.textContent = ""; return; }
    const head = `${shown(own[0].at)} ${own[0].x.unit}`.trim();
    figure.out.textContent = `${head}: ${own.map((plot) => texts(plot, plot.at).join(", ")).join("; ")}`;
    for (const plot of own) {
      plot.area.setAttribute("aria-valuenow", plot.at);
      plot.area.setAttribute("aria-valuetext", figure.out.textContent);
    }
  };
  const move = (source, value) => {
    const touched = new Set();
    for (const plot of plots) {
      if (plot.x.title !== source.x.title) continue;
      plot.at = value;
      const s = value === null ? -1 : share(plot.x, value), [left, , wide] = plot.box;
      plot.cursor.setAttribute("visibility", s < 0 || s > 1 ? "hidden" : "visible");
      if (s >= 0 && s <= 1) plot.cursor.setAttribute("transform", `translate(${left + s * wide} 0)`);
      touched.add(plot.figure);
    }
    touched.forEach(write);
  };
  const step = (plot, key) => {
    const x = plot.grid === null ? null : XS[plot.grid], [low, high] = plot.x.ends;
    const jump = { ArrowRight: 1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[key];
    const now = plot.at === null ? low : plot.at;
    if (key === "Home") return snapped(plot, low);
    if (key === "End") return snapped(plot, high);
    if (jump === undefined) return undefined;
    if (x === null) return snapped(plot, now + jump * (high - low) / 200);
    return x[Math.min(Math.max(below(x, now) + (plot.at === null ? 0 : jump), 0), x.length - 1)];
  };
  const keys = (figure, svg) => {
    for (const entry of svg.querySelectorAll(".key > g[data-name]")) {
      const name = entry.getAttribute("data-name");
      const drawn = [...svg.querySelectorAll("[data-name]")]
        .filter((one) => one !== entry && one.getAttribute("data-name") === name);
      if (!drawn.length) continue;
      const toggle = () => {
        const off = entry.getAttribute("aria-checked") === "true";
        entry.setAttribute("aria-checked", String(!off));
        for (const one of [entry, ...drawn]) one.classList.toggle("off", off);
        for (const plot of plots) if (plot.figure === figure) off ? plot.off.add(name) : plot.off.delete(name);
        if (figure.out) write(figure);
      };
      for (const [key, value] of [["role", "checkbox"], ["aria-checked", "true"], ["aria-label", name], ["tabindex", "0"]])
        entry.setAttribute(key, value);
      entry.addEventListener("click", toggle);
      entry.addEventListener("keydown", (event) => {
        if (event.key === " " || event.key === "Enter") { event.preventDefault(); toggle(); }
      });
    }
  };
  const live = (figure, svg, plot) => {
    const [left, top, wide, high] = plot.box;
    const straight = plot.lines.every((line) => XS[line.x].length < 3);
    Object.assign(plot, { figure, at: null, off: new Set(), grid: straight ? null : plot.lines.find((line) => XS[line.x].length > 2).x });
    plot.area = make("rect", { x: left, y: top, width: wide, height: high, fill: "transparent", class: "area", tabindex: 0,
      role: "slider", "aria-label": `cursor: ${plot.x.title}`, "aria-valuemin": plot.x.ends[0],
      "aria-valuemax": plot.x.ends[1], "aria-valuenow": plot.x.ends[0] }, svg, svg.querySelector(".paper").nextSibling);
    plot.cursor = make("path", { d: `M0 ${top}v${high}`, stroke: "#222222", class: "cursor", visibility: "hidden" }, svg);
    plot.area.addEventListener("keydown", (event) => {
      if (event.key === "Escape") { move(plot, null); return; }
      const value = step(plot, event.key);
      if (value !== undefined) { event.preventDefault(); move(plot, value); }
    });
    plots.push(plot);
    return plot;
  };
  for (const script of document.querySelectorAll("figure > script[type='application/json']")) {
    const figure = script.parentElement, svg = figure.querySelector("svg"), data = JSON.parse(script.textContent);
    svg.setAttribute("role", "group");
    keys(figure, svg);
    const own = data.map((plot) => live(figure, svg, plot));
    if (!own.length) continue;
    figure.out = document.createElement("p");
    figure.out.className = "values";
    figure.insertBefore(figure.out, script);
    svg.addEventListener("pointermove", (event) => {
      const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      const plot = own.find(({ box: [left, top, wide, high] }) =>
        place.x >= left && place.x <= left + wide && place.y >= top && place.y <= top + high);
      if (plot) move(plot, snapped(plot, inverse(plot.x, (place.x - plot.box[0]) / plot.box[2])));
    });
    svg.addEventListener("pointerleave", () => move(own[0], null));
  }
  document.documentElement.classList.add("live");
})();
