"use strict";
(() => {
const data = JSON.parse(document.getElementById("data").textContent);
const $ = id => document.getElementById(id);
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
const times = data.times, nTimes = times.length, nAgents = data.agents.length;
// values[column][agent*nTimes + k]; NaN where there is none
const values = data.columns.map(column => new Float32Array(bytes(column.values).buffer));
const modes = new Uint16Array(bytes(data.modes).buffer); // [agent*nTimes + k]: a mode's number
const events = data.events; // [time, transition, agent, other or -1, from or -1, to or -1], in order of time
const begin = nTimes ? times[0] : 0, end = nTimes ? times[nTimes - 1] : 0;
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const number = x => !Number.isFinite(x) ? "" : String(+x.toPrecision(6));

// ---- the time at hand

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
  $("clock").textContent = now.toFixed(3) + " s";
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

// ---- the plane

const canvas = $("plane"), pen = canvas.getContext("2d");
let across = data.across, up = data.up, trails = true, names = false;
let view = null; // centre and pixels a unit
const shapes = ["circle", "triangle", "square", "diamond", "cross", "star"];
function valueAt(column, agent, k, share) {
  if (column < 0) return times[k] + share*((times[k + 1] ?? times[k]) - times[k]);
  const at = agent*nTimes + k, a = values[column][at], b = values[column][at + 1];
  // between two samples of one mode on a line; a reset is a jump
  if (share === 0 || k + 1 >= nTimes || !Number.isFinite(b) || modes[at] !== modes[at + 1]) return a;
  return a + share*(b - a);
}
function bounds(column) {
  if (column < 0) return [begin, end];
  let low = Infinity, high = -Infinity;
  for (const x of values[column]) if (Number.isFinite(x)) { if (x < low) low = x; if (x > high) high = x; }
  if (low > high) return [0, 1];
  // walls that are not far away are part of the picture
  const size = high - low || 1;
  for (const [wall, at] of data.walls) if (wall === column && at > low - size && at < high + size) { low = Math.min(low, at); high = Math.max(high, at); }
  // whole numbers are lanes: there is room beside the outermost
  return data.columns[column].whole ? [low - 0.5, high + 0.5] : [low, high];
}
function fit() {
  const [x0, x1] = bounds(across), [y0, y1] = bounds(up);
  const { width, height } = canvas.getBoundingClientRect();
  let sx = (width - 70)/Math.max(x1 - x0, 1e-9), sy = (height - 56)/Math.max(y1 - y0, 1e-9);
  if (data.columns[across]?.length && data.columns[across]?.length === data.columns[up]?.length) sx = sy = Math.min(sx, sy);
  view = { x: (x0 + x1)/2, y: (y0 + y1)/2, sx, sy };
  drawPlane();
}
function zoom(factor, at) {
  const { width, height } = canvas.getBoundingClientRect();
  const [px, py] = at ?? [width/2, height/2];
  const x = view.x + (px - width/2)/view.sx, y = view.y - (py - height/2)/view.sy;
  view.sx *= factor; view.sy *= factor;
  view.x = x - (px - width/2)/view.sx; view.y = y + (py - height/2)/view.sy;
  drawPlane();
}
function ticks(low, high, n, least = 0) {
  const rough = (high - low)/n, power = 10**Math.floor(Math.log10(rough)), f = rough/power;
  const step = Math.max(power*(f < 1.5 ? 1 : f < 3.5 ? 2 : f < 7.5 ? 5 : 10), least), list = [];
  for (let x = Math.ceil(low/step)*step; x <= high; x += step) list.push(+x.toPrecision(12));
  return list;
}
function path(shape, x, y, r) {
  pen.beginPath();
  if (shape === "circle") pen.arc(x, y, r, 0, 7);
  else if (shape === "square") pen.rect(x - r*0.9, y - r*0.9, 1.8*r, 1.8*r);
  else if (shape === "cross") {
    const a = r*0.38;
    for (const [dx, dy] of [[-a,-r],[a,-r],[a,-a],[r,-a],[r,a],[a,a],[a,r],[-a,r],[-a,a],[-r,a],[-r,-a],[-a,-a]]) pen.lineTo(x + dx, y + dy);
  } else {
    const n = { triangle: 3, diamond: 4, star: 10 }[shape];
    for (let k = 0; k < n; k++) {
      const q = shape === "star" && k % 2 ? r*0.5 : r*1.2, a = -Math.PI/2 + 2*Math.PI*k/n;
      pen.lineTo(x + q*Math.cos(a), y + q*Math.sin(a));
    }
  }
  pen.closePath();
}
function drawPlane() {
  const box = canvas.getBoundingClientRect(), ratio = devicePixelRatio || 1;
  if (!box.width || !view) return;
  if (canvas.width !== Math.round(box.width*ratio)) { canvas.width = Math.round(box.width*ratio); canvas.height = Math.round(box.height*ratio); }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, box.width, box.height);
  const X = x => box.width/2 + (x - view.x)*view.sx, Y = y => box.height/2 - (y - view.y)*view.sy;
  const ink = css("--ink"), faint = css("--faint"), line = css("--line");
  pen.font = "11px system-ui, sans-serif"; pen.lineWidth = 1;
  const left = view.x - box.width/2/view.sx, right = view.x + box.width/2/view.sx;
  const low = view.y - box.height/2/view.sy, high = view.y + box.height/2/view.sy;
  pen.strokeStyle = line; pen.fillStyle = faint;
  for (const x of ticks(left, right, box.width/90, data.columns[across]?.whole ? 1 : 0)) {
    pen.beginPath(); pen.moveTo(X(x), 0); pen.lineTo(X(x), box.height); pen.stroke(); pen.fillText(number(x), X(x) + 3, box.height - 4);
  }
  for (const y of ticks(low, high, box.height/70, data.columns[up]?.whole ? 1 : 0)) {
    pen.beginPath(); pen.moveTo(0, Y(y)); pen.lineTo(box.width, Y(y)); pen.stroke(); pen.fillText(number(y), 3, Y(y) - 3);
  }
  pen.strokeStyle = ink; pen.lineWidth = 1.2; pen.globalAlpha = 0.55; pen.setLineDash([6, 4]);
  for (const [column, at] of data.walls) {
    if (column === across) { pen.beginPath(); pen.moveTo(X(at), 0); pen.lineTo(X(at), box.height); pen.stroke(); }
    if (column === up) { pen.beginPath(); pen.moveTo(0, Y(at)); pen.lineTo(box.width, Y(at)); pen.stroke(); }
  }
  pen.setLineDash([]); pen.globalAlpha = 1;
  if (!nTimes) return;
  const k = sampleAt(now), share = k + 1 < nTimes ? (now - times[k])/(times[k + 1] - times[k]) : 0;
  const size = nAgents <= 60 ? 6 : nAgents <= 400 ? 4.5 : 3;
  if (trails) {
    // so many points of each trail as can be drawn in time
    const length = Math.min(k, Math.floor(60000/nAgents), 150);
    pen.lineWidth = 1.2; pen.globalAlpha = 0.45;
    for (let agent = 0; agent < nAgents; agent++) {
      pen.strokeStyle = colour(agent, k); pen.beginPath();
      let drawn = false;
      for (let j = k - length; j <= k; j++) {
        const x = valueAt(across, agent, j, 0), y = valueAt(up, agent, j, 0);
        if (!Number.isFinite(x) || !Number.isFinite(y)) { drawn = false; continue; }
        if (drawn) pen.lineTo(X(x), Y(y)); else pen.moveTo(X(x), Y(y));
        drawn = true;
      }
      if (drawn) pen.lineTo(X(valueAt(across, agent, k, share)), Y(valueAt(up, agent, k, share)));
      pen.stroke();
    }
    pen.globalAlpha = 1;
  }
  const placed = agent => [X(valueAt(across, agent, k, share)), Y(valueAt(up, agent, k, share))];
  // two that may meet touch with these
  const reach = data.ranges.filter(([pair]) => pair.includes(across) && pair.includes(up)).map(([, within]) => within/2*view.sx);
  pen.strokeStyle = faint; pen.lineWidth = 1;
  for (let agent = 0; agent < nAgents; agent++) for (const radius of reach) {
    const [x, y] = placed(agent);
    if (!(radius > size) || !(x > -radius && x < box.width + radius && y > -radius && y < box.height + radius)) continue;
    pen.beginPath(); pen.arc(x, y, radius, 0, 7); pen.stroke();
  }
  for (let agent = 0; agent < nAgents; agent++) {
    const [x, y] = placed(agent);
    if (!(x > -20 && x < box.width + 20 && y > -20 && y < box.height + 20)) continue;
    const mode = modes[agent*nTimes + k];
    path(shapes[mode % shapes.length], x, y, size);
    pen.fillStyle = colour(agent, k); pen.fill();
    if (selected.includes(agent)) { pen.lineWidth = 2; pen.strokeStyle = ink; pen.stroke(); }
    if (names || (selected.includes(agent) && selected.length < nAgents && nAgents > 1)) { pen.fillStyle = ink; pen.fillText(data.agents[agent], x + size + 3, y - size); }
  }
  // a ring around who has just had an event: it grows and fades
  const glow = Math.max((end - begin)/60, 1e-9);
  pen.lineWidth = 2;
  for (let e = eventsBefore(now) - 1; e >= 0 && now - events[e][0] <= glow; e--) {
    const age = (now - events[e][0])/glow;
    pen.globalAlpha = 1 - age; pen.strokeStyle = ink;
    for (const agent of [events[e][2], events[e][3]]) if (agent >= 0) {
      const [x, y] = placed(agent);
      pen.beginPath(); pen.arc(x, y, size + 3 + 12*age, 0, 7); pen.stroke();
    }
  }
  pen.globalAlpha = 1;
}
function colour(agent, k) { return data.modeColours[modes[agent*nTimes + k]] ?? "#888"; }

// ---- over time

let selected = [], charts = [];
// distances of marks on an axis of whole numbers
const whole = [0, 1, 2, 3, 4, 5, 6, 7, 8].flatMap(power => [1, 2, 5].map(step => step*10**power));
const palette = data.palette;
function select(agents) {
  selected = agents;
  $("shown").textContent = agents.map(agent => data.agents[agent]).join(", ");
  charts.forEach(chart => chart.destroy());
  charts = [];
  $("charts").textContent = "";
  const shown = data.columns.map((column, c) => c).filter(c => data.columns[c].chart).slice(0, 6);
  const width = $("charts").clientWidth || 500;
  for (const c of shown) {
    const holder = document.createElement("div");
    $("charts").append(holder);
    const stroke = css("--faint"), grid = { stroke: css("--line"), width: 1 };
    const axis = extra => ({ stroke, grid, ticks: grid, size: 46, ...extra });
    const series = agents.map((agent, n) => ({
      label: data.agents[agent], stroke: palette[n % palette.length], width: 1.6, points: { show: false },
      dash: [[], [6, 3], [2, 2], [8, 3, 2, 3]][Math.floor(n/palette.length) % 4], value: (_, x) => x == null ? "" : number(x),
    }));
    const rows = agents.map(agent => Array.from(values[c].subarray(agent*nTimes, (agent + 1)*nTimes), x => Number.isFinite(x) ? x : null));
    const [low, high] = agents.length ? rows.flat().reduce(([a, b], x) => x == null ? [a, b] : [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]) : [0, 1];
    const pad = (high - low)*0.06 || 0.5;
    charts.push(new uPlot({
      width, height: Math.max(120, Math.min(220, 640/shown.length)), legend: { show: agents.length <= 8 && (c === shown.at(-1) || agents.length === 1), live: true },
      cursor: { sync: { key: "time" }, drag: { x: true, y: false } },
      scales: { x: { time: false }, y: { range: [low - pad, high + pad] } },
      axes: [axis({ size: 34, values: (_, list) => list.map(number) }), axis({ label: data.columns[c].label, labelSize: 18, values: (_, list) => list.map(number), ...data.columns[c].whole && { incrs: whole } })],
      series: [{ label: "s", value: (_, x) => x == null ? "" : number(x) }, ...series],
      hooks: { draw: [chart => { bands(chart, agents); timeLine(chart); }], ready: [chart => chart.over.addEventListener("click", () => {
        if (chart.cursor.left >= 0 && chart.select.width < 3) setTime(chart.posToVal(chart.cursor.left, "x"));
      })] },
    }, [times, ...rows], holder));
  }
  drawPlane();
}
// The modes of one agent as bands, its events as ticks at the bottom.
function bands(chart, agents) {
  const { left, top, width, height } = chart.bbox, ctx = chart.ctx;
  ctx.save(); ctx.beginPath(); ctx.rect(left, top, width, height); ctx.clip();
  if (agents.length === 1) {
    ctx.globalAlpha = 0.16;
    for (let k = 0, from = 0, at = agents[0]*nTimes; k < nTimes; k++) {
      if (k + 1 < nTimes && modes[at + k + 1] === modes[at + from]) continue;
      const x0 = chart.valToPos(times[from], "x", true), x1 = chart.valToPos(times[Math.min(k + 1, nTimes - 1)], "x", true);
      ctx.fillStyle = data.modeColours[modes[at + from]] ?? "#888";
      ctx.fillRect(x0, top, x1 - x0, height);
      from = k + 1;
    }
  }
  ctx.globalAlpha = 0.8; ctx.strokeStyle = css("--ink"); ctx.lineWidth = 1;
  let last = -9;
  for (const event of events) {
    if (!agents.includes(event[2]) && !agents.includes(event[3])) continue;
    const x = chart.valToPos(event[0], "x", true);
    if (x - last < 2) continue;
    last = x;
    ctx.beginPath(); ctx.moveTo(x, top + height); ctx.lineTo(x, top + height - 7*(devicePixelRatio || 1)); ctx.stroke();
  }
  ctx.restore();
}
function timeLine(chart) {
  const x = chart.valToPos(now, "x", true), { left, top, width, height } = chart.bbox, ctx = chart.ctx;
  if (x < left || x > left + width) return;
  ctx.save(); ctx.strokeStyle = css("--mark"); ctx.lineWidth = 1.5;
  ctx.beginPath(); ctx.moveTo(x, top); ctx.lineTo(x, top + height); ctx.stroke(); ctx.restore();
}
let marked = 0;
function markCharts() {
  // redrawing all charts is dear: not at every frame
  const stamp = performance.now();
  if (playing && stamp - marked < 120) return;
  marked = stamp;
  charts.forEach(chart => chart.redraw(false, false));
}

// ---- events

let listed = [];
const most = 400;
function list() {
  const wanted = $("transition").value, text = $("find").value.trim().toLowerCase();
  listed = [];
  events.forEach((event, e) => {
    if (wanted !== "" && event[1] !== +wanted) return;
    const who = event[3] >= 0 ? data.agents[event[2]] + " " + data.agents[event[3]] : data.agents[event[2]];
    if (text && !who.toLowerCase().includes(text)) return;
    listed.push(e);
  });
  const of = data.nEvents > events.length ? `the first ${events.length} of ${data.nEvents}` : data.nEvents;
  // one event has a row for each mode that it changes
  $("count").textContent = `(${listed.length === events.length ? of : listed.length + " of " + of} rows)`;
  show(0);
}
let first = 0, chosen = -1;
function show(from) {
  first = Math.max(0, Math.min(from, listed.length - most));
  const body = document.createElement("tbody");
  for (const e of listed.slice(first, first + most)) {
    const [t, transition, agent, other, before, after] = events[e], row = body.insertRow();
    row.dataset.event = e;
    const cells = [t.toFixed(6), data.transitions[transition], data.agents[agent], other >= 0 ? data.agents[other] : "",
      before >= 0 ? data.modePaths[before] + " \u2192 " + data.modePaths[after] : ""];
    for (const cell of cells) row.insertCell().textContent = cell;
    if (data.places[transition]) { row.cells[1].className = "place"; row.cells[1].title = "Show it in the model"; }
  }
  $("events").tBodies[0].replaceWith(body);
}
function markEvent() {
  const place = eventsBefore(now) - 1;
  let low = 0, high = listed.length;
  while (low < high) { const middle = (low + high) >> 1; if (listed[middle] <= place) low = middle + 1; else high = middle; }
  // of several events at one instant the one that was jumped to
  const asked = events[chosen]?.[0] === now ? listed.indexOf(chosen) : -1;
  const at = asked >= 0 ? asked : low - 1;
  document.querySelector("#events tr.now")?.classList.remove("now");
  if (at < 0) return;
  if (at < first || at >= first + most) show(at - most/2);
  const row = document.querySelector(`#events tr[data-event="${listed[at]}"]`);
  row?.classList.add("now");
  if (row && !playing) { const box = row.closest(".scroll"); box.scrollTop = row.offsetTop - box.clientHeight/2; }
}
function jump(e) {
  setPlaying(false);
  const event = events[e];
  chosen = e;
  if (!selected.includes(event[2])) { $("agent").value = event[2]; select([event[2]].concat(event[3] >= 0 ? [event[3]] : [])); }
  setTime(event[0]);
}
function neighbour(step) {
  // from the event that was jumped to, else from the time
  const at = events[chosen]?.[0] === now ? listed.indexOf(chosen) : -1;
  const e = at >= 0 ? listed[at + step] : step > 0 ? listed.find(e => events[e][0] > now) : listed.findLast(e => events[e][0] < now);
  if (e !== undefined) jump(e);
}

// ---- the text of the model

function openText(file) {
  document.querySelectorAll(".text").forEach((text, k) => { text.hidden = k !== file; });
  document.querySelectorAll("#tabs button").forEach((tab, k) => tab.setAttribute("aria-selected", k === file));
}
// Shows where a transition stands.
function showPlace([file, from, to]) {
  openText(file);
  const text = $("text" + file), pre = text.querySelector("pre");
  const height = parseFloat(getComputedStyle(pre).lineHeight);
  document.querySelector(".text .lines")?.remove();
  const lines = document.createElement("div");
  lines.className = "lines"; lines.dataset.lines = from + "-" + to;
  lines.style.top = (from - 1)*height + "px"; lines.style.height = (to - from + 1)*height + "px";
  text.append(lines);
  lines.scrollIntoView({ block: "center" });
}

// ---- the page

function option(select, value, text) { const o = document.createElement("option"); o.value = value; o.textContent = text; select.append(o); }
$("ending").textContent = data.ending;
$("summary").textContent = data.summary;
for (const id of ["across", "up"]) {
  option($(id), -1, "time, s");
  data.columns.forEach((column, c) => option($(id), c, column.label));
}
$("across").value = across; $("up").value = up;
const natural = (end - begin)/20 || 1;
for (const [factor, text] of [[0.25, "\u00bc"], [0.5, "\u00bd"], [1, "1"], [2, "2"], [4, "4"]]) option($("speed"), factor*natural, text + " (" + number(factor*natural) + " s a second)");
$("speed").value = natural; speed = natural;
$("time").min = begin; $("time").max = end;
data.modeNames.forEach((name, m) => {
  const item = document.createElement("span");
  const shape = shapes[m % shapes.length], fill = data.modeColours[m];
  const drawn = { circle: "<circle cx='7' cy='7' r='5'/>", triangle: "<path d='M7 1L13 12H1z'/>", square: "<rect x='2' y='2' width='10' height='10'/>",
    diamond: "<path d='M7 1L13 7L7 13L1 7z'/>", cross: "<path d='M5 1h4v4h4v4h-4v4h-4v-4h-4v-4h4z'/>", star: "<path d='M7 0L9 5L14 5L10 8L12 14L7 10L2 14L4 8L0 5L5 5z'/>" }[shape];
  item.innerHTML = `<svg width="14" height="14" fill="${fill}">${drawn}</svg>`;
  item.append(name);
  $("legend").append(item);
});
const all = data.agents.map((_, agent) => agent), few = all.slice(0, 6);
option($("agent"), "few", nAgents <= 6 ? "all" : "the first six");
all.slice(0, 5000).forEach(agent => option($("agent"), agent, data.agents[agent]));
option($("transition"), "", "all transitions");
data.transitions.forEach((name, t) => option($("transition"), t, name));

$("play").onclick = () => setPlaying(!playing);
$("time").oninput = () => { setPlaying(false); setTime(+$("time").value); };
$("across").onchange = () => { across = +$("across").value; fit(); };
$("up").onchange = () => { up = +$("up").value; fit(); };
$("speed").onchange = () => { speed = +$("speed").value; };
$("fit").onclick = fit;
const toggle = (id, get, set) => { $(id).onclick = () => { set(!get()); $(id).setAttribute("aria-pressed", get()); drawPlane(); }; };
toggle("trails", () => trails, on => { trails = on; });
toggle("names", () => names, on => { names = on; });
$("agent").onchange = () => select($("agent").value === "few" ? few : [+$("agent").value]);
$("transition").onchange = list; $("find").oninput = list;
$("next").onclick = () => neighbour(1); $("previous").onclick = () => neighbour(-1);
$("events").onclick = event => {
  const row = event.target.closest("tr[data-event]");
  if (!row) return;
  jump(+row.dataset.event);
  if (event.target.matches(".place")) showPlace(data.places[events[+row.dataset.event][1]]);
};
document.querySelectorAll("#tabs button").forEach((tab, k) => { tab.onclick = () => openText(k); });
$("help").onclick = () => $("keys").showModal();
$("theme").onclick = () => {
  const dark = getComputedStyle(document.documentElement).colorScheme === "dark";
  document.documentElement.dataset.theme = dark ? "light" : "dark";
  select(selected);
};
canvas.addEventListener("wheel", event => { event.preventDefault(); zoom(Math.exp(-event.deltaY*0.0015), [event.offsetX, event.offsetY]); }, { passive: false });
let held = null;
canvas.onpointerdown = event => { held = [event.offsetX, event.offsetY, view.x, view.y]; canvas.setPointerCapture(event.pointerId); };
canvas.onpointermove = event => { if (held) { view.x = held[2] - (event.offsetX - held[0])/view.sx; view.y = held[3] + (event.offsetY - held[1])/view.sy; drawPlane(); } };
canvas.onpointerup = event => {
  if (held && Math.hypot(event.offsetX - held[0], event.offsetY - held[1]) < 4) pick(event.offsetX, event.offsetY);
  held = null;
};
// The agent next to a point of the canvas.
function pick(px, py) {
  const box = canvas.getBoundingClientRect(), k = sampleAt(now);
  let best = [16, -1];
  for (let agent = 0; agent < nAgents; agent++) {
    const x = box.width/2 + (valueAt(across, agent, k, 0) - view.x)*view.sx, y = box.height/2 - (valueAt(up, agent, k, 0) - view.y)*view.sy;
    const d = Math.hypot(x - px, y - py);
    if (d < best[0]) best = [d, agent];
  }
  if (best[1] >= 0) { $("agent").value = best[1]; select([best[1]]); }
}
document.addEventListener("keydown", event => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const at = event.target instanceof Element ? event.target : document.body;
  if (at.matches("input[type=search], select, dialog *")) return;
  const k = sampleAt(now), step = event.shiftKey ? 10 : 1;
  const actions = {
    " ": () => setPlaying(!playing), ArrowRight: () => setTime(times[Math.min(k + step, nTimes - 1)]),
    ArrowLeft: () => setTime(now > times[k] ? times[k] : times[Math.max(k - step, 0)]), Home: () => setTime(begin), End: () => setTime(end),
    n: () => neighbour(1), p: () => neighbour(-1), "+": () => zoom(1.25), "-": () => zoom(0.8), 0: fit, t: () => $("trails").click(), l: () => $("names").click(),
    f: () => $("find").focus(), d: () => $("theme").click(), "?": () => $("keys").showModal(),
  };
  const action = actions[event.key];
  if (!action || (event.key === " " && at.matches("button"))) return;
  event.preventDefault();
  if (event.key.startsWith("Arrow")) setPlaying(false);
  action();
});
addEventListener("resize", () => { drawPlane(); select(selected); });
// `report.html#30` opens at 30 s
const asked = Number(location.hash.slice(1));
list(); select(few); fit(); setTime(location.hash && Number.isFinite(asked) ? asked : begin);
})();
