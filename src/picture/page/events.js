// ---- events: of a long list only the rows that can be seen are there

const scroll = $("events").closest(".scroll"), rowsMost = 60;
let listed = [], first = 0, chosen = -1, rowHeight = 24;
// Whether a name has this text in it; a number at its end is meant as a whole.
function isFound(name, text) {
  for (let at = name.indexOf(text); at >= 0; at = name.indexOf(text, at + 1)) {
    if (!/\d$/.test(text) || !/\d/.test(name[at + text.length] ?? "")) return true;
  }
  return false;
}
function list() {
  const wanted = $("transition").value, text = $("find").value.trim().toLowerCase();
  const found = text && data.agents.map(name => isFound(name.toLowerCase(), text));
  listed = [];
  events.forEach((event, e) => {
    if (wanted !== "" && event[1] !== +wanted) return;
    if (text && !found[event[2]] && !(event[3] >= 0 && found[event[3]])) return;
    listed.push(e);
  });
  const of = data.nEvents > events.length ? `the first ${events.length} of ${data.nEvents}` : data.nEvents;
  // one event has a row for each mode that it changes
  $("count").textContent = `(${listed.length === events.length ? of : listed.length + " of " + of} rows)`;
  scroll.scrollTop = 0;
  show(0);
}
// Makes the rows from this one on.
function show(from) {
  first = Math.max(0, Math.min(Math.floor(from), listed.length - rowsMost));
  const focused = document.activeElement?.closest("tr[data-event]")?.dataset.event;
  const body = document.createElement("tbody");
  for (const e of listed.slice(first, first + rowsMost)) {
    const [t, transition, agent, other, before, after] = events[e], row = body.insertRow();
    row.dataset.event = e;
    row.tabIndex = -1;
    const cells = [t.toFixed(Math.max(decimals, 6)), data.transitions[transition], data.agents[agent], other >= 0 ? data.agents[other] : "",
      before >= 0 ? data.modePaths[before] + " \u2192 " + data.modePaths[after] : ""];
    for (const cell of cells) { const made = row.insertCell(); made.textContent = cell; if (cell.length > 24) made.title = cell; }
    if (data.places[transition]) {
      const link = document.createElement("button");
      link.className = "place"; link.title = cells[1] + ": show it in the model"; link.textContent = cells[1]; link.tabIndex = -1;
      row.cells[1].replaceChildren(link);
    }
  }
  const [above, below] = document.querySelectorAll("#events tbody.space td");
  $("events").tBodies[1].replaceWith(body);
  rowHeight = body.rows[0]?.getBoundingClientRect().height || rowHeight;
  above.style.height = first*rowHeight + "px";
  below.style.height = Math.max(listed.length - first - rowsMost, 0)*rowHeight + "px";
  reachable();
  if (focused !== undefined) body.querySelector(`tr[data-event="${focused}"]`)?.focus({ preventScroll: true });
}
// One row, and its link, are in the order of the tab key: that of the time, else the first.
function reachable() {
  const body = $("events").tBodies[1];
  body.querySelectorAll("[tabindex='0']").forEach(element => { element.tabIndex = -1; });
  const row = body.querySelector("tr.now") ?? body.rows[0];
  if (!row) return;
  row.tabIndex = 0;
  const link = row.querySelector("button");
  if (link) link.tabIndex = 0;
}
scroll.addEventListener("scroll", () => {
  const top = Math.floor(scroll.scrollTop/rowHeight), seen = Math.ceil(scroll.clientHeight/rowHeight);
  if (top < first || top + seen > first + rowsMost) { show(top - (rowsMost - seen)/2); mark(); }
});
// The place in the list of the event that was jumped to, else of the last one up to now.
function placeNow() {
  // of several events at one instant the one that was jumped to
  const asked = events[chosen]?.[0] === now ? listed.indexOf(chosen) : -1;
  if (asked >= 0) return asked;
  const before = eventsBefore(now) - 1;
  let low = 0, high = listed.length;
  while (low < high) { const middle = (low + high) >> 1; if (listed[middle] <= before) low = middle + 1; else high = middle; }
  return low - 1;
}
function mark() {
  document.querySelector("#events tr.now")?.classList.remove("now");
  const at = placeNow(), row = at < 0 ? null : document.querySelector(`#events tr[data-event="${listed[at]}"]`);
  row?.classList.add("now");
  reachable();
  return row;
}
function markEvent() {
  const at = placeNow();
  if (at >= 0 && (at < first || at >= first + rowsMost)) show(at - rowsMost/2);
  const row = mark();
  if (row && !playing) {
    scroll.scrollTop = row.offsetTop - scroll.clientHeight/2;
    if (document.activeElement?.closest("#events")) row.focus({ preventScroll: true });
  }
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
