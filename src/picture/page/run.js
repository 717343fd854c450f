// ---- the run: its samples, its events, and the time at hand

const data = JSON.parse(document.getElementById("data").textContent);
const $ = id => document.getElementById(id);
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
const times = data.times, nTimes = times.length, nAgents = data.agents.length;
// An agent has samples from its first one on, as long as it lives: their number, and where they begin.
const lives = new Uint32Array(bytes(data.lives).buffer); // [2*agent]: its first sample, [2*agent + 1]: how many
const starts = new Uint32Array(nAgents);
for (let agent = 1; agent < nAgents; agent++) starts[agent] = starts[agent - 1] + lives[2*agent - 1];
// values[column][starts[agent] + k]; NaN where there is none
const values = data.columns.map(column => new Float32Array(bytes(column.values).buffer));
const modes = new Uint16Array(bytes(data.modes).buffer); // [starts[agent] + k]: a mode's number
const events = data.events; // [time, transition, agent, other or -1, from or -1, to or -1], in order of time
const begin = nTimes ? times[0] : 0, end = Math.max(begin, nTimes ? times[nTimes - 1] : 0, events.length ? events[events.length - 1][0] : 0);
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Where the sample k of an agent lies; -1 where it does not live.
function place(agent, k) {
  const since = k - lives[2*agent];
  return since >= 0 && since < lives[2*agent + 1] ? starts[agent] + since : -1;
}
const value = (column, at) => values[column][at] + data.columns[column].middle;
const modeAt = (agent, k) => { const at = place(agent, k); return at < 0 ? -1 : modes[at]; };
// The colours of marks in the theme at hand.
let palette = [], colourless = "";
function readColours() {
  palette = Array.from({ length: data.nColours }, (_, n) => css("--c" + n));
  colourless = css("--faint");
}
const colourOf = mode => data.modeNames[mode] === undefined ? colourless : palette[mode % palette.length];
const colour = (agent, k) => colourOf(modeAt(agent, k));

// A number in few digits; `digits` of them count.
function number(x, digits = 6) {
  if (!Number.isFinite(x)) return "";
  const plain = String(+x.toPrecision(digits)), short = String(+x.toPrecision(digits)).includes("e") ? plain : (+x.toPrecision(digits)).toExponential();
  return (plain.length > 8 && short.length < plain.length ? short : plain).replace("e+", "e");
}
// How many digits tell numbers of this size apart that differ by a step.
const digitsOf = (size, step) => Math.min(Math.max(Math.ceil(Math.log10(size/step)) + 1, 6), 15) || 6;
// The texts of marks on an axis.
function labels(list) {
  const size = Math.max(...list.map(Math.abs)), digits = list.length > 1 ? digitsOf(size, list[1] - list[0]) : 6;
  return list.map(x => number(x, digits));
}
// A range that is wide enough for its numbers to be told apart.
function widened(low, high) {
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (high - low > size*1e-9) return [low, high];
  const room = size*0.05 || 0.5;
  return [low - room, high + room];
}
// Times to a hundred-thousandth of the run, at least to a thousandth of a second.
const decimals = Math.min(Math.max(3, 5 - Math.floor(Math.log10(end - begin || 1))), 20);

let now = begin, playing = false, speed = 1, last = 0;
// The sample at or before a time.
function sampleAt(t) {
  let low = 0, high = nTimes - 1;
  while (low < high) { const middle = (low + high + 1) >> 1; if (times[middle] <= t) low = middle; else high = middle - 1; }
  return low;
}
function eventsBefore(t) {
  let low = 0, high = events.length;
  while (low < high) { const middle = (low + high) >> 1; if (events[middle][0] <= t) low = middle + 1; else high = middle; }
  return low;
}
function setTime(t) {
  now = Math.min(Math.max(t, begin), end);
  $("time").value = now;
  const told = now.toFixed(decimals) + " s";
  $("clock").textContent = told;
  $("time").setAttribute("aria-valuetext", told);
  drawPlane(); markCharts(); markEvent();
}
function setPlaying(on) {
  playing = on;
  $("play").textContent = on ? "Pause" : "Play";
  $("play").setAttribute("aria-pressed", on);
  if (on) { if (now >= end) setTime(begin); last = performance.now(); requestAnimationFrame(frame); }
}
function frame(stamp) {
  if (!playing) return;
  const t = now + Math.max(stamp - last, 0)/1000*speed;
  last = Math.max(stamp, last);
  setTime(t);
  if (t >= end) setPlaying(false); else requestAnimationFrame(frame);
}

// ---- between two samples

// The times of the first and the last event of an agent between a sample and the next one, by the place of the sample.
const jumps = new Map();
for (const [t, , ...who] of events) for (const agent of who.slice(0, 2)) if (agent >= 0) {
  let k = sampleAt(t);
  if (times[k] === t) k--;
  const at = place(agent, k), known = jumps.get(at);
  if (at >= 0) jumps.set(at, [known ? known[0] : t, t]);
}
// The value just before these events and just after them, as it moves before and after; none where that is not known.
function sides(column, agent, k, at, [from, to]) {
  if (column === TIME) return [from, to];
  if (column === NUMBER) return [agent, agent];
  const a = value(column, at), b = value(column, at + 1);
  const before = place(agent, k - 1) >= 0 && !jumps.has(at - 1), after = place(agent, k + 2) >= 0 && !jumps.has(at + 1);
  if (!before && !after) return null;
  return [
    before ? a + (a - value(column, at - 1))/(times[k] - times[k - 1])*(from - times[k]) : a,
    after ? b - (value(column, at + 2) - b)/(times[k + 2] - times[k + 1])*(times[k + 1] - to) : b,
  ];
}
const TIME = -1, NUMBER = -2;
// A column of an agent at a time from sample k on and before the next one; NaN where it does not live.
function valueAt(column, agent, k, t) {
  const at = place(agent, k);
  if (at < 0) return NaN;
  if (column === TIME) return t;
  if (column === NUMBER) return agent;
  const a = value(column, at);
  if (t <= times[k] || place(agent, k + 1) < 0) return a;
  const b = value(column, at + 1), span = times[k + 1] - times[k], jump = jumps.get(at);
  if (!Number.isFinite(b)) return a;
  if (!jump) return modes[at] === modes[at + 1] ? a + (t - times[k])/span*(b - a) : a;
  const found = sides(column, agent, k, at, jump);
  if (!found) return modes[at] === modes[at + 1] ? a + (t - times[k])/span*(b - a) : a;
  const [from, to] = jump, [before, after] = found;
  if (t < from) return a + (before - a)*(t - times[k])/(from - times[k]);
  return t < to || to >= times[k + 1] ? before : after + (b - after)*(t - to)/(times[k + 1] - to);
}
