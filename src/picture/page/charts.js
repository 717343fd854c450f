// ---- over time

let selected = [], charts = [], bandCanvas = null, chartsFrom = 0;
const chartsMost = 6, bandsMost = 24;
const charted = data.columns.map((_, c) => c).filter(c => data.columns[c].chart);
// distances of marks on an axis of whole numbers
const whole = [0, 1, 2, 3, 4, 5, 6, 7, 8].flatMap(power => [1, 2, 5].map(step => step*10**power));
const hasModes = data.modeNames.length > 1;
const lengthOf = list => Math.max(0, ...(list ?? []).map(text => text.length));
function select(agents) {
  selected = agents;
  $("shown").textContent = agents.map(agent => data.agents[agent]).join(", ");
  charts.forEach(chart => chart.destroy());
  charts = [];
  $("charts").textContent = "";
  const shown = charted.slice(chartsFrom, chartsFrom + chartsMost);
  for (const c of shown) addChart(c, agents, shown);
  bandCanvas = null;
  if (agents.length > 0 && (shown.length === 0 || (agents.length > 1 && hasModes))) {
    bandCanvas = document.createElement("canvas");
    bandCanvas.className = "bands";
    bandCanvas.setAttribute("role", "img");
    bandCanvas.setAttribute("aria-label", "Modes over time");
    $("charts").append(bandCanvas);
    drawBands();
  }
  drawPlane();
}
function addChart(c, agents, shown) {
  const holder = document.createElement("div");
  $("charts").append(holder);
  const stroke = css("--faint"), grid = { stroke: css("--line"), width: 1 };
  const axis = extra => ({ stroke, grid, ticks: grid, values: (_, list) => labels(list), ...extra });
  const rows = agents.map(agent => Array.from(times, (_, k) => {
    const at = place(agent, k), x = at < 0 ? NaN : value(c, at);
    return Number.isFinite(x) ? x : null;
  }));
  const [low, high] = rows.flat().reduce(([a, b], x) => x == null ? [a, b] : [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]);
  const [from, to] = low <= high ? widened(low, high) : [0, 1], pad = (to - from)*0.06;
  const digits = digitsOf(Math.max(Math.abs(from), Math.abs(to)), (to - from)/1e5);
  const series = agents.map((agent, n) => ({
    label: data.agents[agent], stroke: palette[n % palette.length], width: 1.6, points: { show: false },
    dash: [[], [6, 3], [2, 2], [8, 3, 2, 3]][Math.floor(n/palette.length) % 4], value: (_, x) => x == null ? "" : number(x, digits),
  }));
  charts.push(new uPlot({
    width: $("charts").clientWidth || 500, height: Math.max(120, Math.min(220, 640/shown.length)),
    legend: { show: agents.length <= 8 && (c === shown.at(-1) || agents.length === 1), live: true },
    cursor: { sync: { key: "time" }, drag: { x: true, y: false } },
    scales: { x: { time: false, range: (_, a, b) => widened(a ?? begin, b ?? end) }, y: { range: [from - pad, to + pad] } },
    axes: [axis({ size: 34 }), axis({
      label: data.columns[c].label, labelSize: 18, size: (_, list) => Math.max(46, 16 + 7*lengthOf(list)), ...data.columns[c].whole && { incrs: whole },
    })],
    series: [{ label: "s", value: (_, x) => x == null ? "" : x.toFixed(decimals) }, ...series],
    hooks: { draw: [chart => { bands(chart, agents); timeLine(chart); }], ready: [chart => chart.over.addEventListener("click", () => {
      if (chart.cursor.left >= 0 && chart.select.width < 3) setTime(chart.posToVal(chart.cursor.left, "x"));
    })] },
  }, [times, ...rows], holder));
}
// The stretches of time that an agent is in one mode: from, to, number of the mode.
function stretches(agent) {
  const list = [];
  for (let k = lives[2*agent], n = k + lives[2*agent + 1]; k < n; k++) {
    const mode = modeAt(agent, k), until = times[Math.min(k + 1, nTimes - 1)];
    if (list.length && list.at(-1)[2] === mode) list.at(-1)[1] = until; else list.push([times[k], until, mode]);
  }
  return list;
}
// The modes of one agent as bands, its events as ticks at the bottom.
function bands(chart, agents) {
  const { left, top, width, height } = chart.bbox, ctx = chart.ctx;
  ctx.save(); ctx.beginPath(); ctx.rect(left, top, width, height); ctx.clip();
  if (agents.length === 1) {
    // a pale ground, and below it a strip that can be seen
    const strip = 4*(devicePixelRatio || 1);
    for (const [from, to, mode] of stretches(agents[0])) {
      const x0 = chart.valToPos(from, "x", true), x1 = chart.valToPos(to, "x", true);
      ctx.fillStyle = colourOf(mode);
      ctx.globalAlpha = 0.16; ctx.fillRect(x0, top, x1 - x0, height);
      ctx.globalAlpha = 1; ctx.fillRect(x0, top + height - strip, x1 - x0, strip);
    }
  }
  ctx.globalAlpha = 0.8; ctx.strokeStyle = css("--ink"); ctx.lineWidth = 1;
  const who = new Set(agents);
  let last = -9;
  for (const event of events) {
    if (!who.has(event[2]) && !who.has(event[3])) continue;
    const x = chart.valToPos(event[0], "x", true);
    if (x - last < 2) continue;
    last = x;
    ctx.beginPath(); ctx.moveTo(x, top + height); ctx.lineTo(x, top + height - 9*(devicePixelRatio || 1)); ctx.stroke();
  }
  ctx.restore();
}
// A row of modes and events for each agent that is selected.
function drawBands() {
  const agents = selected.slice(0, bandsMost), ratio = devicePixelRatio || 1, row = 20, width = $("charts").clientWidth || 500;
  const height = row*agents.length + 18, left = 110, room = width - left - 10;
  bandCanvas.style.height = height + "px";
  bandCanvas.width = Math.round(width*ratio); bandCanvas.height = Math.round(height*ratio);
  const ctx = bandCanvas.getContext("2d"), X = t => left + (t - begin)/(end - begin || 1)*room;
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.font = "11px system-ui, sans-serif";
  const rowOf = new Map(agents.map((agent, n) => [agent, n]));
  agents.forEach((agent, n) => {
    ctx.fillStyle = css("--faint"); ctx.fillText(data.agents[agent], 2, n*row + 14, left - 8);
    for (const [from, to, mode] of stretches(agent)) {
      // a ground on which events can be seen, and a border that can be seen itself
      ctx.fillStyle = ctx.strokeStyle = colourOf(mode);
      ctx.globalAlpha = 0.4; ctx.fillRect(X(from), n*row + 4, X(to) - X(from), row - 8);
      ctx.globalAlpha = 1; ctx.strokeRect(X(from) + 0.5, n*row + 4.5, Math.max(X(to) - X(from) - 1, 0), row - 9);
    }
  });
  ctx.fillStyle = css("--ink");
  for (const event of events) for (const agent of [event[2], event[3]]) if (rowOf.has(agent)) ctx.fillRect(X(event[0]), rowOf.get(agent)*row + 1, 1, row - 2);
  ctx.fillStyle = css("--faint");
  const marks = ticks(begin, end, room/90), texts = labels(marks);
  ctx.textAlign = "center";
  marks.forEach((t, k) => ctx.fillText(texts[k], X(t), height - 4));
  ctx.fillStyle = css("--mark"); ctx.fillRect(X(now), 0, 1.5, row*agents.length);
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
  if (bandCanvas) drawBands();
}
