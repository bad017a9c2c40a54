"use strict";
// The numbers of the page: arrays of doubles, scales of axes, texts of values, tables as CSV.
let STORE = JSON.parse(document.getElementById("numbers").textContent);
const ARRAYS = [];
const unpacked = async (store) => { // its arrays; first bytes of all doubles, second bytes and so on, shortened by zlib
  const short = Uint8Array.from(atob(store.doubles), (sign) => sign.charCodeAt(0));
  const stream = new Blob([short]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer()), count = bytes.length / 8;
  const doubles = new Uint8Array(bytes.length);
  for (let place = 0; place < 8; place++) for (let at = 0; at < count; at++) doubles[8 * at + place] = bytes[place * count + at];
  let from = 0;
  return store.lengths.map((length) => new Float64Array(doubles.buffer, 8 * ((from += length) - length), length));
};
const numbers = (at) => ARRAYS[at];
const minus = (text) => text.replace("-", "−");
const shown = (value) => minus(String(Number(value.toPrecision(5))));
const share = (axis, value) => { // 0 at the left end of the whole axis, 1 at the right one
  const [low, high] = axis.ends;
  const at = axis.log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  return axis.reversed ? 1 - at : at;
};
const inverse = (axis, at) => {
  const [low, high] = axis.ends, s = axis.reversed ? 1 - at : at;
  return axis.log ? low * Math.pow(high / low, s) : low + s * (high - low);
};
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const below = (x, value) => { // the last place of an ascending list that is not above the value
  let low = 0, high = x.length - 1;
  while (low < high) { const middle = (low + high + 1) >> 1; if (x[middle] <= value) low = middle; else high = middle - 1; }
  return low;
};
const nearest = (x, value) => { // the place of an ascending list
  const k = below(x, value);
  return k + 1 < x.length && x[k + 1] - value < value - x[k] ? k + 1 : k;
};
const same = (one, other) => Math.abs(one - other) <= 1e-9 * Math.abs(other);
const isStraight = ({ x }) => x.length === 2;
const valueAt = (line, value) => { // NaN where the line has none, null where none of its points is there
  const { x, y } = line, last = x.length - 1, k = isStraight(line) ? below(x, value) : nearest(x, value);
  if ((value < x[0] || value > x[last]) && !same(x[k], value)) return NaN;
  if (!isStraight(line)) return same(x[k], value) ? y[k] : null;
  return x[k] === value || k === last ? y[k] : y[k] + (y[k + 1] - y[k]) * (value - x[k]) / (x[k + 1] - x[k]);
};
const ticks = (low, high, most) => {
  const raw = (high - low) / most, decade = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].find((k) => k * decade >= raw * (1 - 1e-9)) * decade, found = [];
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-6));
  for (let k = Math.ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; k++)
    found.push([k * step, minus((k * step).toFixed(digits))]);
  return found;
};
const written = (value) => { // with every digit, as the files of --csv
  if (Number.isNaN(value)) return "";
  if (!Number.isFinite(value)) return value < 0 ? "-inf" : "inf";
  const [digits, power] = value.toExponential().split("e").map((part, k) => k ? Number(part) : part);
  if (value !== 0 && (power < -4 || power >= 16))
    return `${digits}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
  const text = (Object.is(value, -0) ? "-" : "") + String(value);
  return text.includes(".") ? text : `${text}.0`;
};
const columns = (lists) => Array.from(lists[0], (_, row) => `${lists.map((list) => written(list[row])).join(",")}\n`).join("");
const cells = (piece) => {
  const [x, y, values] = [piece.x, piece.y, piece.cells].map(numbers), rows = [];
  y.forEach((up, j) => x.forEach((across, i) => rows.push(`${[across, up, values[j * x.length + i]].map(written).join(",")}\n`)));
  return rows.join("");
};
const figureCsv = (data) => data.csv.map((piece) => typeof piece === "string" ? piece
  : Array.isArray(piece) ? columns(piece.map(numbers)) : cells(piece)).join("");
const FORMULA = /(^|[,;\t])(\s*)(?=[=+\-@])(?![+-]?(?:\d[\d.]*(?:e[+-]?\d+)?|inf)\s*(?:[,;\t]|$))/g;
const inert = (text) => text.replace(FORMULA, "$1$2'"); // no spreadsheet runs it
const oneLine = (text) => text.trim().split(/\s+/).join(" ");
const source = (node, left = "_{", right = "}") => { // the text of an element, with its subscripts as they were given
  const copy = node.cloneNode(true);
  copy.querySelectorAll("button, b").forEach((one) => one.remove());
  copy.querySelectorAll("sub").forEach((one) => one.replaceWith(`${left}${one.textContent}${right}`));
  return copy.textContent;
};
const quoted = (text) => /[",\n\r]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
const title = (head) => {
  const unit = head.querySelector(".unit"), copy = head.cloneNode(true);
  copy.querySelectorAll(".unit").forEach((one) => one.remove());
  return source(copy, "_", "") + (unit ? ` [${source(unit)}]` : "");
};
const tableCsv = (table) => {
  const number = table.querySelector("caption b").textContent, caption = oneLine(source(table.caption));
  const rows = [...table.tBodies[0].rows].filter((row) => !row.querySelector("[colspan]"));
  const lines = [[...table.tHead.rows[0].cells].map(title), ...rows.map((row) => [...row.cells].map((cell) => cell.dataset.value ?? oneLine(cell.textContent)))];
  return `# ${number}: ${inert(caption)}\n${lines.map((line) => `${line.map(inert).map(quoted).join(",")}\n`).join("")}`;
};
