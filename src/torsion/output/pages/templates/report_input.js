// Keys, pointer, touch and wheel over the plots.
const pressed = (plot, event) => {
  const { key } = event, wide = plot.view[1] - plot.view[0];
  const about = plot.at === null ? 0.5 : clamp(place(plot, plot.at), 0, 1);
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (key === "+" || key === "=") nearer(plot, 0.5, about);
  else if (key === "-") nearer(plot, 2, about);
  else if (key === "0") zoom(plot);
  else if (key === "[" || key === "]") pan(plot, (key === "]" ? 0.25 : -0.25) * wide);
  else if (key === "Escape") reset(plot);
  else if (key === " " && plot.figure.play) plot.figure.play();
  else {
    const value = key.toLowerCase() === "p" ? peak(plot, event.shiftKey ? -1 : 1) : stepped(plot, key);
    if (value === undefined) return;
    seen(plot, value);
  }
  event.preventDefault();
};
const keyed = (figure, svg) => { // names in the key switch their lines off and on
  for (const entry of svg.querySelectorAll(".key > g[data-name]")) {
    const name = entry.getAttribute("data-name");
    const drawn = [...svg.querySelectorAll("[data-name]")]
      .filter((one) => one !== entry && one.getAttribute("data-name") === name);
    if (!drawn.length) continue;
    const toggle = () => {
      const off = entry.getAttribute("aria-checked") === "true";
      entry.setAttribute("aria-checked", String(!off));
      for (const one of [entry, ...drawn]) one.classList.toggle("off", off);
      for (const plot of figure.own) off ? plot.off.add(name) : plot.off.delete(name);
      if (figure.own.some((plot) => plot.isRead)) read(figure);
    };
    for (const [key, value] of [["role", "checkbox"], ["aria-checked", "true"], ["aria-label", name], ["tabindex", "0"]])
      entry.setAttribute(key, value);
    entry.addEventListener("click", toggle);
    entry.addEventListener("keydown", (event) => {
      if (event.key === " " || event.key === "Enter") { event.preventDefault(); toggle(); }
    });
  }
};
const pointed = (figure, svg) => { // marks with words: one stop of the tab key, arrows from one to the next
  const marks = [...svg.querySelectorAll(".front > g > g")].filter((one) => one.querySelector("title"));
  const words = (mark) => mark.querySelector("title").textContent;
  const left = (mark) => mark.querySelector("path").getBBox().x;
  const say = (mark) => { figure.point = mark ? words(mark) : ""; read(figure); };
  marks.sort((one, other) => left(one) - left(other));
  marks.forEach((mark, k) => {
    const look = { role: "img", "aria-label": words(mark), tabindex: k ? -1 : 0, class: "point" };
    for (const key in look) mark.setAttribute(key, look[key]);
    mark.addEventListener("focus", () => say(mark));
    mark.addEventListener("blur", () => say(null));
    mark.addEventListener("keydown", (event) => {
      const to = { ArrowRight: k + 1, ArrowLeft: k - 1, Home: 0, End: marks.length - 1 }[event.key];
      if (event.key === "Escape") mark.blur();
      if (to === undefined || !marks[to]) return;
      event.preventDefault();
      marks.forEach((one, j) => one.setAttribute("tabindex", j === to ? 0 : -1));
      marks[to].focus();
    });
  });
  return (event) => { // the mark under the pointer, or near it
    const away = marks.map((mark) => {
      const box = mark.querySelector("path").getBoundingClientRect();
      return box.width ? Math.hypot(box.x + box.width / 2 - event.clientX, box.y + box.height / 2 - event.clientY) : Infinity;
    });
    const k = away.indexOf(Math.min(...away));
    return k >= 0 && away[k] < 9 ? words(marks[k]) : "";
  };
};
const touched = (figure, svg, near) => {
  const own = figure.own.filter((plot) => plot.isRead), fingers = new Map();
  const chosen = make("rect", { class: "chosen", fill: "#0072B2", "fill-opacity": 0.15, visibility: "hidden" }, svg);
  let start = null;
  const spot = (event) => new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  const on = (plot, { x }) => clamp((x - plot.box[0]) / plot.box[2], 0, 1);
  const under = (event) => {
    const { x, y } = spot(event);
    return own.find(({ box: [left, top, wide, high] }) => x >= left && x <= left + wide && y >= top && y <= top + high);
  };
  const hover = (plot, event) => {
    figure.point = near(event);
    move(plot, snapped(plot, valueOf(plot, on(plot, spot(event)))));
  };
  const choose = (first, event) => {
    const [left, top, wide, high] = first.plot.box, here = on(first.plot, spot(event)), from = Math.min(first.at, here);
    const box = { x: left + from * wide, y: top, width: Math.abs(here - first.at) * wide, height: high };
    for (const key in box) chosen.setAttribute(key, box[key]);
    chosen.setAttribute("visibility", "visible");
    return [from, Math.max(first.at, here)];
  };
  const pinch = (plot) => { // the values under the fingers stay under them
    const [one, other] = [...fingers.values()], now = [on(plot, one), on(plot, other)].sort((a, b) => a - b);
    const was = start.held, wide = (was[1] - was[0]) / Math.max(now[1] - now[0], 0.02);
    const low = (was[0] + was[1]) / 2 - wide * (now[0] + now[1]) / 2;
    if (wide < 1 && wide >= LEAST) { const a = clamp(low, 0, 1 - wide); zoom(plot, a, a + wide); } else if (wide >= 1) zoom(plot);
  };
  svg.addEventListener("pointerdown", (event) => {
    const plot = under(event);
    if (!plot || event.button) return;
    if (event.pointerType === "mouse") {
      start = plot.x.places || event.target.closest(".point") ? null : { plot, at: on(plot, spot(event)) };
      plot.area.focus({ preventScroll: true });
      event.preventDefault();
    } else {
      fingers.set(event.pointerId, spot(event));
      start = { plot, at: on(plot, spot(event)), view: plot.view };
      if (fingers.size === 2)
        start.held = [...fingers.values()].map((one) => plot.view[0] + on(plot, one) * (plot.view[1] - plot.view[0])).sort((a, b) => a - b);
      else hover(plot, event);
    }
    if (start) svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    if (event.pointerType === "mouse") {
      const plot = under(event);
      if (plot) hover(plot, event);
      if (start) choose(start, event);
      return;
    }
    if (!start || !fingers.has(event.pointerId)) return;
    fingers.set(event.pointerId, spot(event));
    const { plot } = start;
    if (fingers.size === 2) pinch(plot);
    else if (start.held) return;
    else if (isZoomed(plot)) {
      const [a, b] = start.view, by = (start.at - on(plot, spot(event))) * (b - a);
      pan(plot, a + by - plot.view[0]);
    } else hover(plot, event);
  });
  const end = (event) => {
    const from = start;
    fingers.delete(event.pointerId);
    if (!fingers.size) start = null;
    if (!from || event.pointerType !== "mouse") return;
    const [low, high] = choose(from, event);
    chosen.setAttribute("visibility", "hidden");
    if (event.type === "pointerup" && (high - low) * from.plot.box[2] > 6) {
      const [a, b] = from.plot.view;
      zoom(from.plot, a + low * (b - a), a + high * (b - a));
    }
  };
  svg.addEventListener("pointerup", end);
  svg.addEventListener("pointercancel", end);
  svg.addEventListener("dblclick", () => own.forEach((plot) => zoom(plot)));
  svg.addEventListener("pointerleave", (event) => {
    figure.point = "";
    if (event.pointerType === "mouse") own.forEach((plot) => move(plot, null));
  });
  svg.addEventListener("wheel", (event) => { // with Ctrl, or in a plot with the focus; else the page scrolls
    const plot = under(event);
    if (!plot || !(event.ctrlKey || plot.area === document.activeElement)) return;
    event.preventDefault();
    nearer(plot, Math.pow(1.0015, clamp(event.deltaY, -400, 400)), on(plot, spot(event)));
  }, { passive: false });
};
