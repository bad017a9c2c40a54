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
  const ticks = (low, high, most) => {
    const raw = (high - low) / most, decade = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 5, 10].find((k) => k * decade >= raw * (1 - 1e-9)) * decade, found = [];
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-6));
    for (let k = Math.ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; k++)
      found.push([k * step, (k * step).toFixed(digits).replace("-", "−")]);
    return found;
  };
  const strokes = (plot, zoomed) => { // as wide in px of the screen as before
    const scale = plot.svg.clientWidth / plot.svg.viewBox.baseVal.width / 10;
    for (const one of plot.inner.flatMap((inner) => [...inner.querySelectorAll("[stroke-width]")])) {
      one.style.vectorEffect = zoomed ? "non-scaling-stroke" : "";
      one.style.strokeWidth = zoomed ? one.getAttribute("stroke-width") * scale : "";
      const dashes = one.getAttribute("stroke-dasharray");
      if (dashes) one.style.strokeDasharray = zoomed ? dashes.split(" ").map((dash) => dash * scale).join(" ") : "";
    }
  };
  const moved = (path, a, b, wide) => (path.original ||= path.getAttribute("d"))
    .replace(/M(-?\d+) (-?\d+)([^M]*)/g, (_, x, y, rest) => {
      const at = (x / (10 * wide) - a) / (b - a);
      return at < -1e-3 || at > 1.001 ? "" : `M${Math.round(10 * wide * at)} ${y}${rest}`;
    });
  const view = (plot, ends) => {
    const [left, top, wide, high] = plot.box, zoomed = ends !== null;
    plot.x.ends = plot.full;
    const shares = (zoomed ? ends : plot.full).map((end) => share(plot.x, end)), a = Math.min(...shares), b = Math.max(...shares);
    plot.x.ends = zoomed ? ends : plot.full;
    for (const inner of plot.inner) {
      const [, , w, h] = inner.original ||= inner.getAttribute("viewBox").split(" ").map(Number);
      inner.setAttribute("viewBox", `${a * w} 0 ${(b - a) * w} ${h}`);
    }
    strokes(plot, zoomed);
    plot.front.querySelectorAll(".words").forEach((words) => { words.style.display = zoomed ? "none" : ""; });
    plot.front.querySelectorAll(":scope > :not(.words) path, :scope > path").forEach((path) =>
      path.setAttribute("d", moved(path, a, b, wide)));
    plot.scale.replaceChildren();
    plot.numbers.forEach((number) => { number.style.display = zoomed ? "none" : ""; });
    plot.grid_lines.style.display = zoomed ? "none" : "";
    if (!zoomed) return;
    const levels = plot.grid_lines.getAttribute("d").match(/M[^M]*h[^M]*/g) || [], lines = [];
    for (const [value, text] of ticks(ends[0], ends[1], 8)) {
      const x = left + share(plot.x, value) * wide;
      lines.push(`M${x} ${top}v${high}`);
      if (!plot.numbers.length) continue;
      const look = { x, y: top + high + 13, "text-anchor": "middle", "font-size": 10.5, fill: "#222222" };
      make("text", look, plot.scale).textContent = text;
    }
    make("path", { d: levels.concat(lines).join(""), stroke: "#dddddd", "stroke-width": 0.6, fill: "none" }, plot.scale);
  };
  const zoom = (source, low, high) => { // all plots over the same; without ends, back to the whole
    const [first, last] = source.full;
    const whole = low === undefined || (low <= first && high >= last);
    for (const plot of plots) if (plot.x.title === source.x.title) {
      const ends = [Math.max(low, plot.full[0]), Math.min(high, plot.full[1])];
      view(plot, whole || !(ends[1] > ends[0]) ? null : ends);
    }
    if (source.at !== null) move(source, source.at);
  };
  const nearer = (plot, factor) => {
    const [low, high] = plot.x.ends, middle = plot.at === null ? (low + high) / 2 : plot.at, half = (high - low) * factor / 2;
    zoom(plot, Math.max(middle - half, plot.full[0]), Math.min(middle + half, plot.full[1]));
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
    const grid = straight ? null : plot.lines.find((line) => XS[line.x].length > 2).x;
    Object.assign(plot, { figure, svg, grid, at: null, off: new Set(), full: plot.x.ends });
    plot.area = make("rect", { x: left, y: top, width: wide, height: high, fill: "transparent", class: "area", tabindex: 0,
      role: "slider", "aria-label": `cursor: ${plot.x.title}`, "aria-valuemin": plot.x.ends[0],
      "aria-valuemax": plot.x.ends[1], "aria-valuenow": plot.x.ends[0] }, svg, svg.querySelector(".paper").nextSibling);
    plot.cursor = make("path", { d: `M0 ${top}v${high}`, stroke: "#222222", class: "cursor", visibility: "hidden" }, svg);
    const stands = (one, x, y) => Math.abs(one.getAttribute("x") - x) < 0.1 && Math.abs(one.getAttribute("y") - y) < 0.1;
    plot.inner = [...svg.querySelectorAll("svg.plot")].filter((one) => stands(one, left, top));
    plot.front = [...svg.querySelectorAll(".front")].find((one) => {
      const { e, f } = one.transform.baseVal[0].matrix;
      return Math.abs(e - left) < 0.1 && Math.abs(f - top) < 0.1;
    });
    plot.numbers = [...svg.querySelectorAll("text.across")]
      .filter((one) => Math.abs(one.getAttribute("y") - top - high - 13) < 0.1);
    plot.grid_lines = [...svg.querySelectorAll(".grid")].find((one) => one.getAttribute("d").includes(`M${left} `)
      && Math.abs(one.getBBox().y - top) < high);
    plot.scale = make("g", { class: "scale" }, svg, plot.grid_lines.nextSibling);
    plot.area.addEventListener("keydown", (event) => {
      const wanted = { "+": 0.5, "-": 2 }[event.key];
      if (wanted) { nearer(plot, wanted); return; }
      if (event.key === "0") { zoom(plot); return; }
      if (event.key === "Escape") { plot.at === null ? zoom(plot) : move(plot, null); return; }
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
    figure.append(figure.out);
    let start = null;
    const chosen = make("rect", { class: "chosen", fill: "#0072B2", "fill-opacity": 0.15, visibility: "hidden" }, svg);
    const under = (event) => {
      const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      const plot = own.find(({ box: [left, top, wide, high] }) =>
        place.x >= left && place.x <= left + wide && place.y >= top && place.y <= top + high);
      return plot && { plot, x: place.x, value: inverse(plot.x, (place.x - plot.box[0]) / plot.box[2]) };
    };
    svg.addEventListener("pointermove", (event) => {
      const here = under(event);
      if (!here) return;
      move(here.plot, snapped(here.plot, here.value));
      if (!start || start.plot !== here.plot) return;
      const [, top, , high] = here.plot.box;
      const box = { x: Math.min(start.x, here.x), y: top, width: Math.abs(here.x - start.x), height: high };
      for (const key in box) chosen.setAttribute(key, box[key]);
      chosen.setAttribute("visibility", "visible");
    });
    svg.addEventListener("pointerdown", (event) => {
      start = event.button === 0 && event.pointerType === "mouse" ? under(event) || null : null;
      if (start) event.preventDefault();
    });
    svg.addEventListener("pointerup", (event) => {
      const here = under(event), from = start;
      start = null;
      chosen.setAttribute("visibility", "hidden");
      if (from && here && from.plot === here.plot && Math.abs(here.x - from.x) > 6)
        zoom(here.plot, Math.min(from.value, here.value), Math.max(from.value, here.value));
    });
    svg.addEventListener("dblclick", () => own.forEach((plot) => zoom(plot)));
    svg.addEventListener("pointerleave", () => move(own[0], null));
  }
  addEventListener("beforeprint", () => plots.forEach((plot) => view(plot, null)));
  document.documentElement.classList.add("live");
})();
