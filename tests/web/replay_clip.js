"use strict";

// Plays a clip in node with the page's module and its JavaScript, and prints the lines of
// tests/target/replay.cpp with --overlay yes. With --time RUNS: milliseconds a frame instead, of the tracker and of
// everything; of each frame the fastest of RUNS runs counts.
//
// usage: node replay_clip.js ENGINE.wasm CLIP [--time RUNS]

const fs = require("fs");
const path = require("path");
const { performance } = require("perf_hooks");
const { makeEngine } = require(path.join(__dirname, "../../web/page/engine.js"));

function print(result) {
  console.log(`frame ${result.number} ${result.tUs} ${result.status} ${result.frameHash}`);
  console.log(`overlay ${result.number} ${result.pictureHash}`);
}

/** Plays the clip once; see(result, milliseconds of the whole frame, index). */
function play(engine, see) {
  engine.startDrive();
  for (let index = 0; ; ++index) {
    const start = performance.now();
    const result = engine.nextFrame();
    if (result === null) return;
    see(result, performance.now() - start, index);
  }
}

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

async function main() {
  const [wasm, clip, option, runs] = process.argv.slice(2);
  const engine = await makeEngine(fs.readFileSync(wasm), () => performance.now());
  engine.loadClip(fs.readFileSync(clip));
  if (option !== "--time") {
    play(engine, print);
    return;
  }
  const tracker = [];
  const all = [];
  for (let run = 0; run < Number(runs); ++run) {
    play(engine, (result, wholeMs, index) => {
      const trackerMs = result.stageUs.reduce((sum, us) => sum + us, 0) / 1000;
      tracker[index] = Math.min(trackerMs, run === 0 ? Infinity : tracker[index]);
      all[index] = Math.min(wholeMs, run === 0 ? Infinity : all[index]);
    });
  }
  console.log(`tracker ${mean(tracker).toFixed(3)} ms, with decoding and colours ${mean(all).toFixed(3)} ms a frame`);
}

main();
