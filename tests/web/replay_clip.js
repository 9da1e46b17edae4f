"use strict";

// Plays a clip in node with the page's module and its JavaScript, and prints the lines of
// tests/target/replay.cpp with --overlay yes. With --time: milliseconds of the tracker a frame instead, of the
// fastest of five runs, and of decoding and all else.
//
// usage: node replay_clip.js ENGINE.wasm CLIP [--time]

const fs = require("fs");
const path = require("path");
const { performance } = require("perf_hooks");
const { makeEngine } = require(path.join(__dirname, "../../web/page/engine.js"));

async function main() {
  const [wasm, clip, option] = process.argv.slice(2);
  const engine = await makeEngine(fs.readFileSync(wasm), () => performance.now());
  engine.loadClip(fs.readFileSync(clip));
  let best = null;
  for (let run = 0; run < (option === "--time" ? 5 : 1); ++run) {
    const start = performance.now();
    let tracked = 0;
    let frames = 0;
    engine.startDrive();
    for (let result = engine.nextFrame(); result !== null; result = engine.nextFrame()) {
      ++frames;
      tracked += result.stageUs.reduce((sum, us) => sum + us, 0) / 1000;
      if (option === "--time") continue;
      console.log(`frame ${result.number} ${result.tUs} ${result.status} ${result.frameHash}`);
      console.log(`overlay ${result.number} ${result.pictureHash}`);
    }
    const times = { tracker: tracked / frames, all: (performance.now() - start) / frames };
    if (best === null || times.tracker < best.tracker) best = times;
  }
  if (option === "--time") {
    console.log(`tracker ${best.tracker.toFixed(3)} ms, with decoding and colours ${best.all.toFixed(3)} ms a frame`);
  }
}

main();
