// The page of a report in a frame: what it shows comes by message; cursors, zooms and switched lines stay.
let last = 0;
const kept = () => new Map([...document.querySelectorAll("figure")].filter((figure) => figure.own)
  .map((figure) => [figure.id, figure.own.map(({ view, at, off }) => ({ view, at, off: [...off] }))]));
const restored = (before) => {
  for (const figure of document.querySelectorAll("figure")) (before.get(figure.id) || []).forEach((was, k) => {
    const plot = figure.own && figure.own[k];
    if (!plot || !plot.isRead) return;
    for (const name of was.off) {
      const entry = [...figure.querySelectorAll("[role=checkbox]")].find((one) => one.dataset.name === name);
      if (entry && !plot.off.has(name)) entry.dispatchEvent(new Event("click"));
    }
    if (was.view[0] > 0 || was.view[1] < 1) show(plot, was.view);
    if (was.at !== null && share(plot.x, was.at) === clamp(share(plot.x, was.at), 0, 1)) move(plot, computed(plot, was.at));
  });
};
addEventListener("message", async ({ source, data }) => {
  if (source !== parent) return;
  const turn = ++last, store = JSON.parse(data.numbers), arrays = await unpacked(store);
  if (turn !== last) return;
  const before = kept();
  STORE = store;
  ARRAYS.splice(0, ARRAYS.length, ...arrays);
  PLOTS.length = 0;
  document.getElementById("all").innerHTML = data.main;
  answering();
  restored(before);
  requestAnimationFrame(() => setTimeout(() => parent.postMessage({ drawn: data.turn }, "*")));
});
