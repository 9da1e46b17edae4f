"use strict";

// The charts of a run's page: each function gives uPlot's options and data, or null where the run has none.
// `run` is the page's data, `color` looks up a colour of the page's style.

const STAGES = ["--s0", "--s1", "--s2", "--s3", "--s4"];
const has = (values) => values !== null && values !== undefined && values.some((v) => v !== null);
const known = (values) => values.filter((v) => v !== null && v !== undefined);
const largest = (values) => known(values).reduce((a, b) => Math.max(a, b), 0);
/** The value below which so many of the values lie. */
const quantile = (values, share) => {
  const sorted = known(values).sort((a, b) => a - b);
  return sorted.length > 0 ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : 0;
};
const text = (v, unit, digits = 2) => (v === null || v === undefined ? "–" : `${v.toFixed(digits)}${unit}`);

function axes(color, ylabel, narrow) {
  const axis = { stroke: color("--muted"), grid: { stroke: color("--line"), width: 1 }, ticks: { show: false }, font: "12px system-ui" };
  return [
    { ...axis, size: 34, space: narrow ? 60 : 80, values: (u, ticks) => ticks.map((t) => `${+t.toFixed(3)} s`) },
    { ...axis, size: narrow ? 46 : 56, label: narrow ? undefined : ylabel, labelFont: "12px system-ui", labelSize: 16 },
  ];
}

const line = (color, label, name, format, more = {}) => ({
  label, stroke: color(name), width: 1.3, points: { show: false }, value: (u, v) => format(v), ...more,
});
const time = { label: "time", value: (u, t) => text(t, " s") };
const flat = (run, v) => run.t.map(() => v);
const fixed = (top, bottom = 0) => ({ y: { range: () => [bottom, top] } });

/** Stretches of time in which the camera was not tracked. */
function shade(run, color) {
  return (u) => {
    u.ctx.save();
    u.ctx.fillStyle = color("--shade");
    let from = -1;
    for (let i = 0; i <= run.t.length; ++i) {
      const bad = i < run.t.length && run.state[i] !== "tracking";
      if (bad && from < 0) from = i;
      if (bad || from < 0) continue;
      const a = u.valToPos(run.t[from], "x", true), b = u.valToPos(run.t[Math.min(i, run.t.length - 1)], "x", true);
      const left = Math.max(a, u.bbox.left), right = Math.min(Math.max(b, a + 1), u.bbox.left + u.bbox.width);
      if (right > left) u.ctx.fillRect(left, u.bbox.top, right - left, u.bbox.height);
      from = -1;
    }
    u.ctx.restore();
  };
}

function latency(run, color, narrow, wish) {
  const sums = [], stages = run.stages;
  stages.forEach((stage, k) => sums.push(stage.ms.map((v, i) => (v || 0) + (k > 0 ? sums[k - 1][i] : 0))));
  const top = wish.toBudget ? 1.15 * Math.max(run.budget, Math.min(largest(run.total), 4 * run.budget))
    : Math.min(1.15 * Math.max(quantile(run.total, 0.995), 0.01), 4 * run.budget);
  // The highest sum is drawn first: each then covers the part of those below.
  const order = stages.map((_, k) => stages.length - 1 - k);
  return {
    options: {
      scales: fixed(top), axes: axes(color, "ms", narrow),
      series: [time, ...order.map((k) => line(color, stages[k].name, STAGES[k], (v) => v, {
        fill: color(STAGES[k]), width: 0, value: (u, v, s, i) => (i === null ? "–" : text(stages[k].ms[i], " ms", 3)),
      })), line(color, "frame", "--ink", (v) => text(v, " ms", 3), { width: 0.7 }),
      line(color, "budget", "--bad", (v) => text(v, " ms"), { dash: [6, 4] })],
    },
    data: [run.t, ...order.map((k) => sums[k]), run.total, flat(run, run.budget)],
  };
}

function error(run, color, narrow) {
  if (!run.path || !(has(run.path.sigma) || has(run.path.error))) return null;
  const unit = run.path.unit === "m" ? " m" : "", series = [], data = [];
  if (has(run.path.sigma)) {
    series.push(line(color, "3 sigma", "--orange", (v) => text(v, unit, 3), { fill: color("--ring") }));
    data.push(run.path.sigma.map((s) => (s === null ? null : 3 * s)));
  }
  if (has(run.path.error)) {
    series.push(line(color, "error", "--blue", (v) => text(v, unit, 3)));
    data.push(run.path.error);
  }
  const top = 1.15 * Math.max(...data.map((d) => quantile(d, 0.98)), 1e-6);
  if (has(run.angle)) {
    series.push(line(color, "attitude, 1 sigma", "--grey", (v) => text(v, "°"), { scale: "angle", width: 1 }));
    data.push(run.angle);
  }
  return {
    options: {
      scales: { ...fixed(top), angle: { range: () => [0, Math.max(0.01, 2.5 * quantile(run.angle, 0.98))] } },
      axes: axes(color, run.path.unit, narrow), series: [time, ...series],
    },
    data: [run.t, ...data],
  };
}

function registration(run, color, narrow) {
  if (!has(run.registration)) return null;
  const mean = known(run.registration).reduce((a, b) => a + b, 0) / known(run.registration).length;
  return {
    options: {
      scales: fixed(Math.max(1, 1.15 * quantile(run.registration, 0.995))), axes: axes(color, "px", narrow),
      series: [time, line(color, "registration error", "--blue", (v) => text(v, " px")),
        line(color, "mean", "--grey", (v) => text(v, " px"), { dash: [6, 4] })],
    },
    data: [run.t, run.registration, flat(run, mean)],
  };
}

function map(run, color, narrow) {
  const whole = (v) => text(v, "", 0);
  return {
    options: {
      scales: fixed(1.1 * Math.max(1, largest(run.landmarks), largest(run.matches))), axes: axes(color, "", narrow),
      series: [time, line(color, "landmarks", "--grey", whole), line(color, "matches", "--orange", whole),
        line(color, "inliers", "--green", whole)],
    },
    data: [run.t, run.landmarks, run.matches, run.inliers],
  };
}

function consistency(run, color, narrow) {
  const nees = run.nees.map((v) => (v === null ? null : v / 3));
  if (!has(run.nis) && !has(nees)) return null;
  const series = [], data = [];
  if (has(run.nis)) {
    series.push(line(color, "NIS", "--blue", (v) => text(v, "")));
    data.push(run.nis);
  }
  if (has(nees)) {
    series.push(line(color, "NEES", "--orange", (v) => text(v, "")));
    data.push(nees);
  }
  return {
    options: {
      scales: fixed(1.15 * Math.max(2, ...data.map((d) => quantile(d, 0.98)))), axes: axes(color, "", narrow),
      series: [time, ...series, line(color, "consistent", "--grey", (v) => text(v, "", 0), { dash: [6, 4] })],
    },
    data: [run.t, ...data, flat(run, 1)],
  };
}

// Counters that grow while everything is well.
const ROUTINE = new Set(["innovations_used", "landmarks_added", "landmarks_removed", "landmarks_archived",
  "landmarks_reactivated", "landmarks_replaced", "candidates_dropped", "corners_dropped", "searches_deferred"]);

/** A lane for each counter that grew, and the score above them. */
function health(run, color, narrow) {
  const names = Object.keys(run.events).filter((name) => name !== "innovations_used");
  names.sort((a, b) => ROUTINE.has(a) - ROUTINE.has(b) || (a < b ? -1 : 1));
  const lanes = names.map((name, k) => {
    const row = run.t.map(() => null);
    for (const [i] of run.events[name]) row[i] = names.length - k;
    return row;
  });
  if (lanes.length === 0 && !has(run.score)) return null;
  const grew = names.map((name) => new Map(run.events[name]));
  const top = names.length + 0.6;
  const all = axes(color, "", narrow);
  all[1] = { ...all[1], size: narrow ? 116 : 190, label: undefined, font: narrow ? "10px system-ui" : "12px system-ui",
    splits: () => names.map((_, k) => names.length - k), values: () => names.map((n) => n.replaceAll("_", " ")) };
  return {
    height: 60 + 20 * names.length + (has(run.score) ? 70 : 0),
    options: {
      scales: { y: { range: () => [has(run.score) ? -2.6 : 0.4, top] } }, axes: all,
      series: [time, ...names.map((name, k) => line(color, name.replaceAll("_", " "),
        ROUTINE.has(name) ? "--grey" : "--bad", (v) => v, {
          paths: () => null, points: { show: true, size: 5, width: 0, fill: color(ROUTINE.has(name) ? "--grey" : "--bad") },
          value: (u, v, s, i) => (i === null ? "–" : `+${grew[k].get(i) || 0}`),
        })), ...(has(run.score) ? [line(color, "score", "--blue", (v) => v,
        { value: (u, v, s, i) => (i === null ? "–" : text(run.score[i], "")) })] : [])],
    },
    // The score's 0 to 2 lies in the three lanes below the counters.
    data: [run.t, ...lanes, ...(has(run.score) ? [run.score.map((v) => (v === null ? null : Math.min(v, 2) - 2.4))] : [])],
  };
}

/** Path, truth, landmarks and 3-sigma ellipses in one plane, with equal scales. */
function path(run, color) {
  const drawn = run.path;
  if (!drawn) return null;
  const points = [...drawn.estimate.map((p) => [p[1], p[2]]), ...drawn.truth, ...(drawn.whole ? drawn.landmarks : [])];
  const low = [0, 1].map((k) => points.reduce((m, p) => Math.min(m, p[k]), Infinity));
  const high = [0, 1].map((k) => points.reduce((m, p) => Math.max(m, p[k]), -Infinity));
  return { points, low, high };
}

function drawPath(u, run, color) {
  const { ctx, bbox } = u, drawn = run.path, ratio = devicePixelRatio;
  const x = (v) => u.valToPos(v, "x", true), y = (v) => u.valToPos(v, "y", true);
  const follow = (points, name, width) => {
    ctx.beginPath();
    points.forEach((p, i) => (i > 0 ? ctx.lineTo(x(p[0]), y(p[1])) : ctx.moveTo(x(p[0]), y(p[1]))));
    ctx.strokeStyle = color(name);
    ctx.lineWidth = width * ratio;
    ctx.stroke();
  };
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  const unit = Math.abs(x(1) - x(0));
  // As one area: one over the other they would hide the path.
  ctx.fillStyle = color("--ring");
  ctx.beginPath();
  for (const [px, py, a, b, angle] of drawn.ellipses) {
    const [long, short] = [a, b].map((half) => Math.min(half * unit, 4000)), turn = drawn.flip ? angle : -angle;
    ctx.moveTo(x(px) + long * Math.cos(turn), y(py) + long * Math.sin(turn));
    ctx.ellipse(x(px), y(py), long, short, turn, 0, 2 * Math.PI);
  }
  ctx.fill();
  ctx.fillStyle = color("--grey");
  for (const [px, py] of drawn.landmarks) ctx.fillRect(x(px) - ratio, y(py) - ratio, 2 * ratio, 2 * ratio);
  follow(drawn.truth, "--grey", 3);
  follow(drawn.estimate.map((p) => [p[1], p[2]]), "--blue", 1.4);
  if (drawn.estimate.length > 0) {
    ctx.beginPath();
    ctx.arc(x(drawn.estimate[0][1]), y(drawn.estimate[0][2]), 4 * ratio, 0, 2 * Math.PI);
    ctx.fillStyle = color("--green");
    ctx.fill();
  }
  ctx.restore();
}
