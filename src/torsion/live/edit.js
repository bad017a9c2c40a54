// The editor: the text of the file, its faults while it is typed, keys that fit, and what is written into the file.
const STILL = 200; // ms after a key until the text is read
const area = $("text"), lines = () => area.value.split("\n");
let of = "", clean = "", known = {}, faulty = [], timer = 0, reading = false, onDisk = null;
const note = (text) => { $("said").textContent = text; };
const marked = () => { note(onDisk ? "the file has changed on the disk meanwhile" : area.value === clean ? "" : "not saved"); };
const rows = () => {
  const bad = new Set(faulty.map((one) => one.line));
  $("rows").textContent = lines().map((_, k) => `${bad.has(k + 1) ? "✗ " : ""}${k + 1}`).join("\n");
  $("rows").scrollTop = area.scrollTop;
};
const at = ({ line, column }) => { // where a fault stands in the text
  const before = lines().slice(0, line - 1), there = [...(lines()[line - 1] || "")].slice(0, column - 1).join("");
  return before.reduce((sum, one) => sum + one.length + 1, 0) + there.length;
};
const found = (faults) => {
  faulty = faults;
  $("found").replaceChildren(...faults.map((one) => {
    const item = document.createElement("li"), button = document.createElement("button");
    button.type = "button";
    button.textContent = `${one.line}:${one.column} ${one.text}`;
    button.addEventListener("click", () => { area.focus(); area.setSelectionRange(at(one), at(one)); });
    item.append(button);
    return item;
  }));
  rows();
};
const read = async () => { // one text after the other, the last one always
  if (reading) { timer = setTimeout(read, STILL); return; }
  reading = true;
  const text = area.value;
  try {
    const answer = await ask("/check", { text });
    if (text === area.value) { found(answer.faults || []); if (answer.refused) note(answer.refused); }
  } catch (error) { note(error.message); } finally { reading = false; }
};
const taken = (answer) => {
  const [from, to] = [area.selectionStart, area.selectionEnd], top = area.scrollTop;
  of = answer.of; clean = answer.text; onDisk = null;
  $("reopen").hidden = true;
  area.readOnly = false; // nothing is typed before the text is there
  area.value = answer.text;
  area.setSelectionRange(from, to);
  area.scrollTop = top;
  found(answer.faults);
  marked();
};
const reopen = async () => {
  try {
    const answer = await ask("/open", {});
    if (answer.refused) { note(answer.refused); return; }
    if (answer.keys) known = answer.keys;
    if (answer.of === of) return;
    if (area.value === clean || area.value === answer.text) { taken(answer); return; }
    onDisk = answer;
    $("reopen").hidden = false;
    marked();
  } catch (error) { note(error.message); }
};
const written = async (path, body) => {
  try {
    const answer = await ask(path, { ...body, of });
    if (answer.refused) { note(answer.refused); return; }
    if ("text" in body) { of = answer.of; clean = body.text; }
    marked();
  } catch (error) { note(error.message); }
};
const enclosing = (text) => { // the key below which the end of a text stands
  let depth = 0;
  for (let k = text.length - 1; k >= 0; k--) {
    if ("}]".includes(text[k])) depth++;
    if ("{[".includes(text[k]) && depth-- === 0) {
      const key = /([\w-]+)\s*:\s*$/.exec(text.slice(0, k));
      if (key) return key[1];
      depth = 0;
    }
  }
  const [last, ...before] = text.split("\n").reverse(), [, indent, dash] = /^( *)((?:- +)*)/.exec(last);
  const most = dash ? indent.length : indent.length - 1;
  for (const line of before) {
    const [, left, dashes, key] = /^( *)((?:- +)*)([\w-]*)/.exec(line);
    if (key && left.length + dashes.length <= most) return key;
  }
  return "";
};
const fitting = () => {
  const text = area.value.slice(0, area.selectionStart), word = /(?:^|[{[,]|- )\s*([\w-]*)$/.exec(text.split("\n").pop());
  if (!word) return [];
  return (known[enclosing(text)] || []).filter((key) => key.startsWith(word[1]) && key !== word[1]).map((key) => [key, word[1]]);
};
const complete = ([key, word]) => {
  area.focus();
  area.setSelectionRange(area.selectionStart - word.length, area.selectionEnd);
  if (!document.execCommand("insertText", false, `${key}: `)) area.setRangeText(`${key}: `);
  $("keys").replaceChildren();
};
const offer = () => $("keys").replaceChildren(...fitting().map((one) => {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = one[0];
  button.addEventListener("click", () => complete(one));
  return button;
}));
area.addEventListener("input", () => { rows(); marked(); offer(); clearTimeout(timer); timer = setTimeout(read, STILL); });
area.addEventListener("scroll", () => { $("rows").scrollTop = area.scrollTop; });
area.addEventListener("keydown", (event) => {
  const first = $("keys").firstChild;
  if (event.key === "Escape") $("keys").replaceChildren();
  if (event.key === "Tab" && !event.shiftKey && first) { event.preventDefault(); first.click(); }
});
addEventListener("keydown", (event) => { if ((event.ctrlKey || event.metaKey) && event.key === "s") { event.preventDefault(); $("save").click(); } });
addEventListener("beforeunload", (event) => { if (area.value !== clean) event.preventDefault(); });
$("save").addEventListener("click", () => written("/save", { text: area.value }));
$("reopen").addEventListener("click", () => taken(onDisk));
const put = document.createElement("button");
Object.assign(put, { type: "button", id: "put", textContent: "write into the file" });
put.addEventListener("click", () => {
  if (!Object.keys(values).length) note("no figure is moved");
  else if (area.value !== clean) note("save the text first");
  else written("/put", { values });
});
$("reset").after(put);
document.addEventListener("news", ({ detail }) => { if (detail.file) reopen(); });
