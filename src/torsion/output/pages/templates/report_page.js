// The page as a whole: its buttons, dark screen, list of keys, print, and the start.
const KEYS = [
  ["← → ↑ ↓", "cursor to the next value that was computed, or the next station"], ["Page ↑, Page ↓", "ten values on"],
  ["Home, End", "first, last value"], ["P, Shift P", "next peak, peak before; in a diagram of frequencies or over ranges of speed the next critical speed"],
  ["+ −", "zoom about the cursor"], ["[ ]", "left, right by a quarter"], ["0", "the whole axis"],
  ["Esc", "reset: the whole axis, no cursor, every line"], ["Space", "in the plots of a mode: move, stop; in the key: line off, on"],
  ["Tab", "to the next plot, name in the key or point; arrows go from point to point"],
  ["mouse", "drag across a plot zooms, double click shows the whole; the wheel zooms with Ctrl or in a plot with the focus"],
  ["touch", "tap sets the cursor, two fingers zoom, one drags what is zoomed"], ["?", "this list"],
];
const save = (name, text) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
const help = () => {
  const dialog = element("dialog", { "aria-label": "keys" }, "", document.body), table = element("table", { class: "facts" }, "", dialog);
  for (const [key, words] of KEYS) {
    const row = element("tr", {}, "", element("tbody", {}, "", table));
    element("th", { scope: "row" }, key, row);
    element("td", {}, words, row);
  }
  button("close", dialog, () => dialog.close());
  addEventListener("keydown", (event) => {
    if (event.key === "?" && !dialog.open && !(event.ctrlKey || event.metaKey || event.altKey)) dialog.showModal();
  });
  return dialog;
};
const dark = (tools) => {
  const root = document.documentElement, wanted = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.screen || (wanted.matches ? "dark" : "light")) === "dark";
  const name = () => { control.textContent = isDark() ? "light screen" : "dark screen"; };
  const control = button("dark screen", tools, () => { root.dataset.screen = isDark() ? "light" : "dark"; name(); });
  wanted.addEventListener("change", name);
  name();
};
const listed = (found) => { // critical speeds of a figure
  if (!found) return null;
  const arrays = ["x", "frequency", "mode", "order"].map((key) => [key, numbers(found[key])]);
  return { ...found, ...Object.fromEntries(arrays), orders: STORE.names[found.orders] };
};
const began = (script) => { // one figure
  const figure = script.parentElement, svg = figure.querySelector("svg"), data = JSON.parse(script.textContent);
  const tools = element("p", { class: "tools" }, "", figure), label = figure.querySelector("figcaption b").textContent;
  figure.own = [];
  figure.criticals = listed(data.criticals);
  moving(figure, data.moving, tools);
  if (data.csv) button("CSV", tools, () => save(data.file, figureCsv(data)), { "aria-label": `CSV of ${label}` });
  if (data.said) element("span", { class: "said" }, data.said, tools);
  if (!data.plots.length) { if (!tools.children.length) tools.remove(); return; }
  svg.setAttribute("role", "group");
  figure.own = data.plots.map((plot) => opened(figure, svg, plot));
  keyed(figure, svg);
  if (!figure.own.some((plot) => plot.isRead)) return;
  element("span", { class: "hint" }, "← → P + − 0 Esc; ? lists all keys", tools);
  const out = element("p", { class: "values" }, "", figure);
  figure.values = element("span", {}, "", out);
  figure.near = element("span", { class: "near" }, "", out);
  figure.own.filter((plot) => plot.isRead).forEach((plot) => plot.area.addEventListener("keydown", (event) => pressed(plot, event)));
  touched(figure, svg, pointed(figure, svg));
};
const answering = () => { // every figure and table that is there
  document.querySelectorAll("figure > script[type='application/json']").forEach(began);
  for (const table of document.querySelectorAll(".table > table")) {
    const number = table.querySelector("caption b")?.textContent;
    if (number) button("CSV", table.caption, () => save(`${number.toLowerCase().replace(" ", "-")}.csv`, tableCsv(table)),
      { "aria-label": `CSV of ${number}` });
    const box = table.parentElement;
    if (box.scrollWidth > box.clientWidth) for (const [key, value] of [["tabindex", 0], ["role", "region"], ["aria-label", number || "table"]])
      box.setAttribute(key, value);
  }
};
const start = () => {
  const tools = document.createElement("p"), dialog = help();
  tools.className = "tools page";
  document.body.prepend(tools);
  dark(tools);
  button("keys ?", tools, () => dialog.showModal());
  answering();
  let views = [];
  addEventListener("beforeprint", () => {
    views = PLOTS.map((plot) => plot.view);
    PLOTS.forEach((plot) => show(plot, [0, 1]));
    document.querySelectorAll("figure").forEach((figure) => figure.rest && figure.rest());
  });
  addEventListener("afterprint", () => PLOTS.forEach((plot, k) => show(plot, views[k] || [0, 1])));
  document.documentElement.classList.add("live");
};
unpacked(STORE).then((arrays) => { ARRAYS.push(...arrays); start(); }); // without what unpacks them the figures stay as they are
