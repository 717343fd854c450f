// ---- the plane

const canvas = $("plane"), pen = canvas.getContext("2d");
let across = data.across, up = data.up, trails = true, names = false;
let view = null; // centre and pixels a unit
const rimsMost = 2000;
const shapes = ["circle", "triangle", "square", "diamond", "cross", "star"];
const labelOf = column => column === TIME ? "time, s" : column === NUMBER ? "number of the agent" : data.columns[column].label;
const isWhole = column => column === NUMBER || Boolean(data.columns[column]?.whole);
function bounds(column) {
  if (column === TIME) return [begin, end];
  if (column === NUMBER) return [-0.5, nAgents - 0.5];
  let low = Infinity, high = -Infinity;
  for (const x of values[column]) if (Number.isFinite(x)) { if (x < low) low = x; if (x > high) high = x; }
  if (low > high) return [0, 1];
  low += data.columns[column].middle; high += data.columns[column].middle;
  // walls that are not far away are part of the picture
  const size = high - low || 1;
  for (const [wall, at] of data.walls) if (wall === column && at > low - size && at < high + size) { low = Math.min(low, at); high = Math.max(high, at); }
  // whole numbers are lanes: there is room beside the outermost
  return isWhole(column) ? [low - 0.5, high + 0.5] : [low, high];
}
function fit() {
  const [x0, x1] = widened(...bounds(across)), [y0, y1] = widened(...bounds(up));
  const { width, height } = canvas.getBoundingClientRect();
  let sx = (width - 70)/(x1 - x0), sy = (height - 56)/(y1 - y0);
  // a circle is drawn as one, unless one of its axes is that of another size
  const isSpace = data.columns[across]?.length && data.columns[across]?.length === data.columns[up]?.length;
  if (isSpace && Math.max(sx/sy, sy/sx) < 100) sx = sy = Math.min(sx, sy);
  view = { x: x0 + (x1 - x0)/2, y: y0 + (y1 - y0)/2, sx, sy };
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
// Round numbers in a range, about n of them; none where it is too narrow for numbers of this size.
function ticks(low, high, n, least = 0) {
  const rough = (high - low)/n;
  if (!(rough > Math.max(Math.abs(low), Math.abs(high))*1e-15) || !Number.isFinite(rough)) return [];
  const power = 10**Math.floor(Math.log10(rough)), f = rough/power;
  const step = Math.max(power*(f < 1.5 ? 1 : f < 3.5 ? 2 : f < 7.5 ? 5 : 10), least), first = Math.ceil(low/step);
  const count = Math.min(Math.max(Math.floor(high/step) - first + 1, 0), 1000);
  return Array.from({ length: count }, (_, k) => +((first + k)*step).toPrecision(15));
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
  const ink = css("--ink"), paper = css("--inside");
  pen.font = "11px system-ui, sans-serif";
  drawGrid(box, X, Y);
  if (!nTimes) return;
  const k = sampleAt(now), size = nAgents <= 60 ? 6 : nAgents <= 400 ? 4.5 : 3;
  if (trails) drawTrails(k, X, Y);
  const placed = agent => [X(valueAt(across, agent, k, now)), Y(valueAt(up, agent, k, now))];
  // two that may meet touch with these
  const reach = data.ranges.filter(([pair]) => pair.includes(across) && pair.includes(up)).map(([, within]) => within/2*view.sx);
  pen.strokeStyle = css("--faint"); pen.lineWidth = 1;
  for (let agent = 0; agent < nAgents; agent++) for (const radius of reach) {
    const [x, y] = placed(agent);
    if (!(radius > size) || !(x > -radius && x < box.width + radius && y > -radius && y < box.height + radius)) continue;
    pen.beginPath(); pen.arc(x, y, radius, 0, 7); pen.stroke();
  }
  for (let agent = 0; agent < nAgents; agent++) {
    const [x, y] = placed(agent);
    if (!(x > -20 && x < box.width + 20 && y > -20 && y < box.height + 20)) continue;
    path(shapes[modeAt(agent, k) % shapes.length] ?? "circle", x, y, size);
    // a rim in the colour of the paper sets it off from trails
    if (nAgents <= rimsMost) { pen.lineWidth = 2; pen.strokeStyle = paper; pen.stroke(); }
    pen.fillStyle = colour(agent, k); pen.fill();
    const isSelected = selected.includes(agent);
    if (isSelected) { pen.lineWidth = 2; pen.strokeStyle = ink; pen.stroke(); }
    if (names || (isSelected && selected.length < nAgents && nAgents > 1)) { pen.fillStyle = ink; pen.fillText(data.agents[agent], x + size + 3, y - size); }
  }
  // a ring around who has just had an event: it grows and fades; where there are many events, sooner
  const run = end - begin, glow = Math.max(Math.min(run/60, 40*run/Math.max(events.length, 1)), speed*0.05);
  pen.lineWidth = 2;
  for (let e = eventsBefore(now) - 1; e >= 0 && now - events[e][0] <= glow; e--) {
    const age = (now - events[e][0])/glow;
    pen.globalAlpha = 1 - age; pen.strokeStyle = ink;
    for (const agent of [events[e][2], events[e][3]]) if (agent >= 0) {
      const [x, y] = placed(agent);
      if (!Number.isFinite(x + y)) continue;
      pen.beginPath(); pen.arc(x, y, size + 3 + 12*age, 0, 7); pen.stroke();
    }
  }
  pen.globalAlpha = 1;
  if (!playing) tellPlane(k);
}
// Lines at round numbers, the names of the axes, and walls.
function drawGrid(box, X, Y) {
  const left = view.x - box.width/2/view.sx, right = view.x + box.width/2/view.sx;
  const low = view.y - box.height/2/view.sy, high = view.y + box.height/2/view.sy;
  const xs = ticks(left, right, box.width/90, isWhole(across) ? 1 : 0), ys = ticks(low, high, box.height/70, isWhole(up) ? 1 : 0);
  const tell = [labels(xs), labels(ys)];
  pen.lineWidth = 1; pen.strokeStyle = css("--line"); pen.fillStyle = css("--faint");
  xs.forEach((x, k) => { pen.beginPath(); pen.moveTo(X(x), 0); pen.lineTo(X(x), box.height); pen.stroke(); pen.fillText(tell[0][k], X(x) + 3, box.height - 4); });
  ys.forEach((y, k) => { pen.beginPath(); pen.moveTo(0, Y(y)); pen.lineTo(box.width, Y(y)); pen.stroke(); pen.fillText(tell[1][k], 3, Y(y) - 3); });
  pen.fillStyle = css("--ink"); pen.fillText(labelOf(up), 6, 14);
  pen.textAlign = "right"; pen.fillText(labelOf(across), box.width - 6, box.height - 18); pen.textAlign = "left";
  pen.strokeStyle = css("--ink"); pen.lineWidth = 1.2; pen.globalAlpha = 0.55; pen.setLineDash([6, 4]);
  for (const [column, at] of data.walls) {
    if (column === across) { pen.beginPath(); pen.moveTo(X(at), 0); pen.lineTo(X(at), box.height); pen.stroke(); }
    if (column === up) { pen.beginPath(); pen.moveTo(0, Y(at)); pen.lineTo(box.width, Y(at)); pen.stroke(); }
  }
  pen.setLineDash([]); pen.globalAlpha = 1;
}
// Where agents come from. Where an event has set what the plane shows, the line is broken.
function drawTrails(k, X, Y) {
  // so many points of each trail as can be drawn in time
  const length = Math.min(k, Math.floor(60000/Math.max(nAgents, 1)), 150);
  pen.lineWidth = 1;
  for (let agent = 0; agent < nAgents; agent++) {
    if (place(agent, k) < 0) continue;
    pen.strokeStyle = colour(agent, k); pen.beginPath();
    let drawn = false;
    const to = (x, y) => {
      if (!Number.isFinite(x) || !Number.isFinite(y)) drawn = false;
      else if (drawn) pen.lineTo(X(x), Y(y));
      else { pen.moveTo(X(x), Y(y)); drawn = true; }
    };
    for (let j = k - length; j <= k; j++) {
      to(valueAt(across, agent, j, times[j]), valueAt(up, agent, j, times[j]));
      const at = place(agent, j), jump = at >= 0 && place(agent, j + 1) >= 0 && jumps.get(at);
      if (!jump || jump[1] > now) continue;
      const x = sides(across, agent, j, at, jump), y = sides(up, agent, j, at, jump);
      if (x && y) { to(x[0], y[0]); drawn = false; to(x[1], y[1]); }
    }
    to(valueAt(across, agent, k, now), valueAt(up, agent, k, now));
    pen.stroke();
  }
}
// What is to be seen, in words.
function tellPlane(k) {
  const counts = new Map();
  let n = 0;
  for (let agent = 0; agent < nAgents; agent++) {
    const mode = modeAt(agent, k);
    if (mode < 0) continue;
    n++;
    counts.set(mode, (counts.get(mode) ?? 0) + 1);
  }
  const list = [...counts].map(([mode, count]) => `${count} ${data.modeNames[mode] ?? ""}`).slice(0, 12).join(", ");
  canvas.setAttribute("aria-label", `${labelOf(up)} over ${labelOf(across)} at ${now.toFixed(decimals)} s: ${n} agents (${list})`);
}
// The agent next to a point of the canvas.
function pick(px, py) {
  const box = canvas.getBoundingClientRect(), k = sampleAt(now);
  let best = [16, -1];
  for (let agent = 0; agent < nAgents; agent++) {
    const x = box.width/2 + (valueAt(across, agent, k, now) - view.x)*view.sx, y = box.height/2 - (valueAt(up, agent, k, now) - view.y)*view.sy;
    const d = Math.hypot(x - px, y - py);
    if (d < best[0]) best = [d, agent];
  }
  if (best[1] >= 0) { $("agent").value = best[1]; select([best[1]]); }
}
