// A mode moves over the sketch of the train: a line along it, straight at rest, deflected by the angles as plotted.
const HIGH = 28, STEPS = 8, SECONDS = 2; // px of the largest angle; positions of a step through a cycle; of a cycle
const moving = (figure, data, tools) => {
  const plant = document.querySelector("#plant .sketch[data-across], #utilisation .sketch[data-across]");
  if (!plant || !data) return;
  const [across, left, row] = ["across", "left", "row"].map((key) => Number(plant.dataset[key]));
  const [x, rows, angle, ends, marked] = ["x", "row", "angle", "ends", "marked"].map((key) => numbers(data[key]));
  const px = Array.from(x, (at) => (at - left) * across), py = Array.from(rows, (at) => at * row);
  const top = Math.min(...py) - 46, high = Math.max(...py) + 46 - top, wide = figure.querySelector("svg").viewBox.baseVal.width;
  const svg = make("svg", { viewBox: `0 ${top} ${wide} ${high}`, class: "train", role: "img",
    "aria-label": `the train of ${figure.querySelector("figcaption b").textContent} at its largest deflection` }, figure, figure.firstChild);
  svg.append(...[...plant.children].filter((one) => !one.querySelector("text")).map((one) => one.cloneNode(true)));
  const line = make("path", { fill: "none", stroke: "#D55E00", "stroke-width": 2.4, "stroke-linejoin": "round", class: "deflected" }, svg);
  const dots = make("path", { fill: "#D55E00", stroke: "none" }, svg);
  let phase = 0, started = null;
  const draw = () => {
    const size = HIGH * Math.cos(2 * Math.PI * phase), y = Array.from(angle, (one, k) => py[k] - size * one);
    const at = (k) => `${px[k].toFixed(1)} ${y[k].toFixed(1)}`, pieces = [];
    for (let k = 0; k < ends.length; k += 2) pieces.push(`${ends[k] === ends[k - 1] ? "" : `M${at(ends[k])}`}L${at(ends[k + 1])}`);
    line.setAttribute("d", pieces.join(""));
    dots.setAttribute("d", Array.from(marked, (k) => `M${at(k)}m-3.2 0a3.2 3.2 0 1 0 6.4 0a3.2 3.2 0 1 0-6.4 0z`).join(""));
    svg.dataset.phase = phase.toFixed(4);
  };
  const isStill = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
  const name = () => {
    control.textContent = started !== null ? "❚❚ stop" : isStill() ? "step" : "▶ move";
    control.setAttribute("aria-pressed", String(started !== null));
  };
  const frame = (now) => {
    if (started === null) return;
    phase = ((now - started) / 1000 / SECONDS) % 1;
    draw();
    requestAnimationFrame(frame);
  };
  figure.play = () => {
    if (started !== null) started = null;
    else if (isStill()) { phase = (Math.round(phase * STEPS) + 1) % STEPS / STEPS; draw(); }
    else { started = performance.now() - phase * SECONDS * 1000; requestAnimationFrame(frame); }
    name();
  };
  figure.rest = () => { started = null; phase = 0; draw(); name(); };
  const control = button("▶ move", tools, figure.play);
  matchMedia("(prefers-reduced-motion: reduce)").addEventListener("change", figure.rest);
  figure.rest();
};
