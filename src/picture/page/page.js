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
$("error").textContent = data.error ?? ""; $("error").hidden = !data.error;
$("left-out").textContent = data.leftOut; $("left-out").hidden = !data.leftOut;
for (const id of ["across", "up"]) {
  option($(id), TIME, labelOf(TIME));
  data.columns.forEach((column, c) => option($(id), c, column.label));
  option($(id), NUMBER, labelOf(NUMBER));
}
// without a variable to be shown, each agent has a line of its own
if (data.columns.length === 0) up = NUMBER;
$("across").value = across; $("up").value = up;
const natural = (end - begin)/20 || 1;
for (const [factor, text] of [[0.25, "\u00bc"], [0.5, "\u00bd"], [1, "1"], [2, "2"], [4, "4"]]) option($("speed"), factor*natural, text + " (" + number(factor*natural) + " s a second)");
$("speed").value = natural; speed = natural;
$("time").min = begin; $("time").max = end;
const drawn = new Set(modes);
data.modeNames.forEach((name, m) => {
  if (!drawn.has(m)) return;
  const item = document.createElement("span");
  const shape = shapes[m % shapes.length], fill = `var(--c${m % data.nColours})`;
  const drawing = { circle: "<circle cx='7' cy='7' r='5'/>", triangle: "<path d='M7 1L13 12H1z'/>", square: "<rect x='2' y='2' width='10' height='10'/>",
    diamond: "<path d='M7 1L13 7L7 13L1 7z'/>", cross: "<path d='M5 1h4v4h4v4h-4v4h-4v-4h-4v-4h4z'/>", star: "<path d='M7 0L9 5L14 5L10 8L12 14L7 10L2 14L4 8L0 5L5 5z'/>" }[shape];
  item.innerHTML = `<svg width="14" height="14" style="fill:${fill}">${drawing}</svg>`;
  item.append(name);
  $("legend").append(item);
});
// Those with most variables tell most; of them, those who live longest; of them, the first.
const has = agent => charted.filter(c => Number.isFinite(values[c][starts[agent]])).length;
const all = data.agents.map((_, agent) => agent), seen = all.filter(agent => lives[2*agent + 1] > 0);
const telling = seen.map(agent => [agent, has(agent)]).filter(([, n]) => n > 0 || charted.length === 0)
  .sort(([a, n], [b, m]) => m - n || lives[2*b + 1] - lives[2*a + 1]).map(([agent]) => agent);
const few = telling.slice(0, charted.length === 0 ? bandsMost : chartsMost).sort((a, b) => a - b);
option($("agent"), "few", seen.length <= few.length ? "all" : few.length + " of " + seen.length);
all.slice(0, 5000).forEach(agent => option($("agent"), agent, data.agents[agent]));
for (let from = 0; from < charted.length; from += chartsMost) {
  option($("variables"), from, charted.slice(from, from + chartsMost).map(c => data.columns[c].label.split(",")[0]).join(", "));
}
$("variables").closest("label").hidden = charted.length <= chartsMost;
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
$("variables").onchange = () => { chartsFrom = +$("variables").value; select(selected); };
$("transition").onchange = list; $("find").oninput = list;
$("next").onclick = () => neighbour(1); $("previous").onclick = () => neighbour(-1);
$("events").onclick = event => {
  const row = event.target.closest("tr[data-event]");
  if (!row) return;
  jump(+row.dataset.event);
  if (event.target.matches(".place")) showPlace(data.places[events[+row.dataset.event][1]]);
};
$("events").onkeydown = event => {
  const step = { ArrowUp: -1, ArrowDown: 1 }[event.key];
  if (step) neighbour(step);
  else if (event.key === "Enter" && event.target.matches("tr")) jump(+event.target.dataset.event);
  else return;
  event.preventDefault(); event.stopPropagation();
};
document.querySelectorAll("#tabs button").forEach((tab, k) => { tab.onclick = () => openText(k); });
function repaint() { readColours(); select(selected); }
$("help").onclick = () => $("keys").showModal();
$("theme").onclick = () => {
  const dark = getComputedStyle(document.documentElement).colorScheme === "dark";
  document.documentElement.dataset.theme = dark ? "light" : "dark";
  repaint();
};
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
canvas.addEventListener("wheel", event => { event.preventDefault(); zoom(Math.exp(-event.deltaY*0.0015), [event.offsetX, event.offsetY]); }, { passive: false });
let held = null;
canvas.onpointerdown = event => { held = [event.offsetX, event.offsetY, view.x, view.y]; canvas.setPointerCapture(event.pointerId); };
canvas.onpointermove = event => { if (held) { view.x = held[2] - (event.offsetX - held[0])/view.sx; view.y = held[3] + (event.offsetY - held[1])/view.sy; drawPlane(); } };
canvas.onpointerup = event => {
  if (held && Math.hypot(event.offsetX - held[0], event.offsetY - held[1]) < 4) pick(event.offsetX, event.offsetY);
  held = null;
};
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
function asked() {
  const t = Number(location.hash.slice(1));
  return location.hash && Number.isFinite(t) ? t : begin;
}
addEventListener("hashchange", () => setTime(asked()));
readColours(); list(); select(few); fit(); setTime(asked());
