"use strict";
// The page that follows a file: what is new comes as the answer to a request that waits, sliders request other figures.
const PAUSE = 150, AGAIN = 1000; // ms for which a picture under way is waited for; after which a lost connection is tried
const $ = (id) => document.getElementById(id), token = location.hash.slice(1);
const ask = async (path, body) => {
  const answer = await fetch(path, { method: "POST", headers: { "Content-Type": "application/json", "X-Torsion-Token": token }, body: JSON.stringify(body) });
  if (answer.status === 403) throw new Error("no valid token: open the address that torsion printed");
  if (!answer.ok) throw new Error(`torsion answers ${answer.status}`);
  return answer.json();
};
const say = (text, isLost = false) => { $("state").textContent = text; $("state").classList.toggle("lost", isLost); };
const opened = (id) => new Promise((resolve) => {
  const frame = $(id);
  frame.addEventListener("load", () => resolve(frame.contentWindow), { once: true });
  frame.srcdoc = FRAME;
});
const drawn = { modes: 0, report: 0 }; // the turn whose picture each frame shows
const TIMES = { turns: [], input: 0 }; // what benchmarks read: when pictures were on the screen
let wanted = null, sent = { turn: 0, at: 0 }, values = {};
const send = async () => { // the next figures, once the picture of those before is there, or late
  if (wanted === null) return;
  const isLate = performance.now() > sent.at + PAUSE;
  if (drawn.report < sent.turn && !(drawn.modes >= sent.turn && isLate) && performance.now() < sent.at + 10 * PAUSE) return;
  const body = { values: wanted };
  wanted = null;
  sent = { turn: Infinity, at: performance.now() };
  try { sent.turn = (await ask("/set", body)).turn; } catch (error) { sent.turn = 0; say(error.message, true); }
};
setInterval(send, 15);
const moved = () => {
  const names = Object.keys(values);
  $("moved").textContent = names.length ? `Not the file: ${names.length === 1 ? `${names[0]} is` : `${names.length} figures are`} moved.` : "The figures of the file.";
  for (const label of $("each").children) label.classList.toggle("moved", label.dataset.name in values);
};
const request = () => { wanted = { ...values }; TIMES.input = performance.now(); moved(); send(); };
const made = (one) => { // a slider
  const label = document.createElement("label"), input = document.createElement("input"), output = document.createElement("span");
  label.dataset.name = one.name;
  Object.assign(input, { type: "range", min: one.low, max: one.high, step: one.step, ariaLabel: one.name });
  input.addEventListener("input", () => {
    if (one.nominal !== null && Number(input.value) === one.nominal) delete values[one.name]; else values[one.name] = Number(input.value);
    request();
  });
  input.addEventListener("dblclick", () => { delete values[one.name]; request(); });
  label.append(one.name, output, input);
  return label;
};
let kinds = "";
const slid = (sliders, turn) => {
  const now = JSON.stringify(sliders.map(({ text, now, moved: _, ...rest }) => rest));
  if (now !== kinds) $("each").replaceChildren(...sliders.map(made));
  kinds = now;
  $("sliders").hidden = !sliders.length;
  const isLatest = wanted === null && turn >= sent.turn;
  if (isLatest) values = Object.fromEntries(sliders.filter((one) => one.moved).map((one) => [one.name, one.now]));
  sliders.forEach((one, k) => {
    const [output, input] = $("each").children[k].querySelectorAll("span, input");
    output.textContent = one.text;
    if (isLatest) input.value = one.now;
    input.setAttribute("aria-valuetext", one.text);
  });
  moved();
};
$("reset").addEventListener("click", () => { values = {}; request(); });
addEventListener("message", ({ source, data }) => {
  const which = ["modes", "report"].find((id) => $(id).contentWindow === source);
  if (!which || typeof data.drawn !== "number") return;
  drawn[which] = data.drawn;
  TIMES.turns.push({ which, turn: data.drawn, at: performance.now() });
  TIMES.turns.splice(0, TIMES.turns.length - 200);
});
const follow = async () => {
  const frames = { modes: await opened("modes"), report: await opened("report") };
  for (let seen = 0; ;) {
    let news;
    try { news = await ask("/next", { seen }); } catch (error) {
      say(error instanceof TypeError ? "torsion has ended, or cannot be reached" : error.message, true);
      $("state").dataset.lost = "yes";
      seen = 0;
      await new Promise((resolve) => { setTimeout(resolve, AGAIN); });
      continue;
    }
    seen = news.seen;
    if (news.name) { $("name").textContent = news.name; document.title = `${news.name} – torsion live`; }
    for (const which of ["modes", "report"]) if (news[which]) frames[which].postMessage(news[which], "*");
    if (news.sliders) slid(news.sliders.each, news.sliders.turn);
    if (news.notes) $("notes").textContent = news.notes.text;
    if (news.faults) {
      $("faults").textContent = news.faults.text;
      $("faults").hidden = !news.faults.text;
      document.querySelector("main").classList.toggle("old", Boolean(news.faults.text));
    }
    if (news.state) say(news.state.text);
    document.dispatchEvent(new CustomEvent("news", { detail: news }));
  }
};
follow();
