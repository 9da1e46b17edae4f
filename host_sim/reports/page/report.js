"use strict";

// Ties the page's charts, video, pictures and scrubber to one present frame. `document.body.dataset.charts` names the
// charts that were drawn; `charts` and `present` are there for tests.

const run = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const video = $("video");
const wish = { toBudget: false };
const charts = {};
let present = 0;
let zoomed = null;  // [from, to] in s, or null: all

function colors() {
  const style = getComputedStyle(document.documentElement);
  return (name) => style.getPropertyValue(name).trim();
}

function nearest(t) {
  let low = 0, high = run.t.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (run.t[middle] < t) low = middle + 1; else high = middle;
  }
  return low > 0 && t - run.t[low - 1] < run.t[low] - t ? low - 1 : low;
}

// ---- the present frame

function marker(chart, kind) {
  const element = document.createElement("div");
  element.className = kind;
  chart.over.append(element);
  return element;
}

function mark(name) {
  const { u, now } = charts[name];
  let inside, left, top = 0;
  if (name === "path") {
    const p = u.estimateOf.get(present);
    left = p ? u.valToPos(p[1], "x") : -1;
    top = p ? u.valToPos(p[2], "y") : -1;
    inside = p && top >= 0 && top <= u.over.clientHeight;
    now.style.top = `${top}px`;
  } else {
    left = u.valToPos(run.t[present], "x");
    inside = true;
  }
  now.hidden = !(inside && left >= 0 && left <= u.over.clientWidth);
  now.style.left = `${left}px`;
}

function show(frame, seek) {
  present = Math.max(0, Math.min(run.t.length - 1, frame));
  $("scrubber").value = present;
  $("readout").textContent = `frame ${run.frame[present]}, ${run.t[present].toFixed(2)} s, ${run.state[present]}, `
    + `${(run.total[present] || 0).toFixed(2)} ms, ${run.inliers[present]} inliers of ${run.landmarks[present]} landmarks`;
  for (const name of Object.keys(charts)) mark(name);
  const figures = [...document.querySelectorAll("figure[data-frame]")];
  const apart = (figure) => Math.abs(Number(figure.dataset.frame) - run.frame[present]);
  const closest = figures.reduce((a, b) => (a === null || apart(b) < apart(a) ? b : a), null);
  for (const figure of figures) figure.classList.toggle("now", figure === closest);
  // The video has every frame once, at its own rate.
  if (seek && video !== null) video.currentTime = (present + 0.5) / run.video_rate;
}

function tieVideo() {
  if (video === null) return;
  const follow = () => {
    if (!video.seeking) show(Math.min(Math.floor(video.currentTime * run.video_rate), run.t.length - 1), false);
    if (!video.paused) requestAnimationFrame(follow);
  };
  video.addEventListener("play", () => { $("play").textContent = "❚❚"; requestAnimationFrame(follow); });
  video.addEventListener("pause", () => { $("play").textContent = "▶"; });
  video.addEventListener("seeked", follow);
  video.addEventListener("error", () => { video.hidden = true; $("no-video").hidden = false; });
}

function play() {
  if (video !== null && !video.hidden) {
    if (video.paused) video.play(); else video.pause();
    return;
  }
  if (play.timer !== undefined) {
    clearInterval(play.timer);
    play.timer = undefined;
  } else {
    play.timer = setInterval(() => show(present + 1 < run.t.length ? present + 1 : 0, false), 33);
  }
  $("play").textContent = play.timer === undefined ? "▶" : "❚❚";
}

// ---- zoom, common to all charts over time

function zoom(from, to) {
  const end = run.t[run.t.length - 1];
  zoomed = from <= 0 && to >= end ? null : [Math.max(0, from), Math.min(end, to)];
  const [min, max] = zoomed || [run.t[0], Math.max(end, 1e-3)];
  for (const [name, { u }] of Object.entries(charts)) {
    if (name !== "path") u.setScale("x", { min, max });
  }
  show(present, false);
}

function zoomBy(factor) {
  const [from, to] = zoomed || [run.t[0], run.t[run.t.length - 1]];
  const half = 0.5 * factor * (to - from), t = run.t[present];
  zoom(t - half, t + half);
}

// ---- charts

function chartOfTime(name, element, make, color, narrow) {
  const made = make(run, color, narrow, wish);
  if (made === null) return null;
  const options = {
    width: element.clientWidth, height: made.height || (narrow ? 240 : 260), ...made.options,
    cursor: { sync: { key: "time", setSeries: false }, drag: { x: true, y: false, setScale: false } },
    legend: { live: true }, hooks: {
      drawClear: [shade(run, color)],
      setSelect: [(u) => {
        if (u.select.width > 4) zoom(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x"));
        u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
      }],
    },
  };
  options.scales = { x: { time: false, range: (u, min, max) => [min, max > min ? max : min + 1e-3] }, ...options.scales };
  const u = new uPlot(options, made.data, element);
  u.over.addEventListener("click", () => { if (u.cursor.idx !== null) show(u.cursor.idx, true); });
  u.over.addEventListener("dblclick", () => zoom(-1, Infinity));
  return { u, now: marker(u, "now-line") };
}

function chartOfPath(element, color, narrow) {
  const extent = path(run, color);
  if (extent === null) return null;
  const width = element.clientWidth, height = Math.min(narrow ? 340 : 460, Math.max(260, width));
  let view = null;  // [x low, x high, y low, y high] that was dragged
  const wanted = (u, k) => {
    const [low, high] = view ? [[view[0], view[2]], [view[1], view[3]]] : [extent.low, extent.high];
    const box = [u.over.clientWidth || width - 60, u.over.clientHeight || height - 40];
    const perPixel = Math.max(...[0, 1].map((i) => Math.max(high[i] - low[i], 1e-6) / box[i])) * (view ? 1 : 1.1);
    const middle = 0.5 * (low[k] + high[k]), half = 0.5 * perPixel * box[k];
    return [middle - half, middle + half];
  };
  const both = axes(color, `${run.path.axes[1]}, ${run.path.unit}`, narrow);
  both[0] = { ...both[0], values: (u, ticks) => ticks.map((t) => +t.toFixed(4)), label: `${run.path.axes[0]}, ${run.path.unit}`,
    labelFont: "12px system-ui", labelSize: 16, size: 34 };
  const u = new uPlot({
    width, height, axes: both, legend: { show: false }, mode: 2,
    scales: { x: { time: false, range: (u) => wanted(u, 0) }, y: { dir: run.path.flip ? -1 : 1, range: (u) => wanted(u, 1) } },
    series: [null, { paths: () => null, points: { show: false } }],
    cursor: { drag: { x: true, y: true, setScale: false }, points: { show: false }, dataIdx: () => null },
    hooks: {
      draw: [(u) => drawPath(u, run, color)],
      setSelect: [(u) => {
        const s = u.select;
        if (s.width > 4 && s.height > 4) {
          const y = [u.posToVal(s.top, "y"), u.posToVal(s.top + s.height, "y")].sort((a, b) => a - b);
          view = [u.posToVal(s.left, "x"), u.posToVal(s.left + s.width, "x"), ...y];
          redraw();
        }
        u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
      }],
    },
  }, [null, [extent.points.map((p) => p[0]), extent.points.map((p) => p[1])]], element);
  u.estimateOf = new Map(run.path.estimate.map((p) => [p[0], p]));
  const redraw = () => {
    u.setData(u.data);
    mark("path");
  };
  const closest = (event) => {
    const box = u.over.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let best = null, least = 900;
    for (const p of run.path.estimate) {
      const d = (u.valToPos(p[1], "x") - x) ** 2 + (u.valToPos(p[2], "y") - y) ** 2;
      if (d < least) [best, least] = [p, d];
    }
    return best;
  };
  const note = $("path-note"), legend = `blue: estimate with its 3-sigma ellipses${run.path.truth.length > 0 ? ", grey: truth" : ""}`
    + `${run.path.landmarks.length > 0 ? ", dots: landmarks" : ""}, green: start`;
  note.textContent = legend;
  u.over.addEventListener("mousemove", (event) => {
    const p = closest(event);
    note.textContent = p === null ? legend
      : `frame ${run.frame[p[0]]}: ${run.path.axes[0]} ${p[1]}, ${run.path.axes[1]} ${p[2]} ${run.path.unit}`
        + `${run.path.error[p[0]] !== null ? `, error ${run.path.error[p[0]]}` : ""}`
        + `${run.path.sigma[p[0]] !== null ? `, sigma ${run.path.sigma[p[0]]}` : ""}`;
  });
  u.over.addEventListener("click", (event) => {
    const p = closest(event);
    if (p !== null) show(p[0], true);
  });
  u.over.addEventListener("dblclick", () => { view = null; redraw(); });
  return { u, now: marker(u, "now-dot") };
}

const OVER_TIME = { latency, error, registration, map, consistency, health };

function drawAll() {
  const color = colors(), narrow = document.documentElement.clientWidth < 700;
  for (const [name, { u }] of Object.entries(charts)) {
    u.destroy();
    delete charts[name];
  }
  for (const element of document.querySelectorAll("[data-chart]")) {
    const name = element.dataset.chart;
    const made = name === "path" ? chartOfPath(element, color, narrow)
      : chartOfTime(name, element, OVER_TIME[name], color, narrow);
    if (made !== null) charts[name] = made;
    $(name).hidden = made === null && name !== "latency";
  }
  document.body.dataset.charts = Object.keys(charts).join(" ");
  zoom(...(zoomed || [-1, Infinity]));
}

if (run !== null) {
  $("scrubber").max = run.t.length - 1;
  $("scrubber").addEventListener("input", (event) => show(Number(event.target.value), true));
  $("play").addEventListener("click", play);
  $("nearer").addEventListener("click", () => zoomBy(0.5));
  $("wider").addEventListener("click", () => zoomBy(2));
  $("all").addEventListener("click", () => zoom(-1, Infinity));
  $("to-budget").addEventListener("change", (event) => { wish.toBudget = event.target.checked; drawAll(); });
  for (const figure of document.querySelectorAll("figure[data-frame]")) {
    figure.addEventListener("click", () => show(run.frame.indexOf(Number(figure.dataset.frame)), true));
  }
  tieVideo();
  drawAll();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAll);
  let width = document.documentElement.clientWidth;
  addEventListener("resize", () => {
    if (width === document.documentElement.clientWidth) return;
    width = document.documentElement.clientWidth;
    drawAll();
  });
}
