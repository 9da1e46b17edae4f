"use strict";

// The tracker's thread. main.js puts engine.js before it.

let engine = null;
let drive = null;  // of the drive that plays: {startMs, startUs, shown, timer}
let fast = false;
let paused = false;

function post(result, extra) {
  const picture = engine.shownPicture(result.width, result.height);
  self.postMessage({ type: "frame", ...result, ...extra, picture }, [picture.buffer]);
}

function fail(error) {
  self.postMessage({ type: "error", text: error.message });
}

function stopDrive() {
  if (drive !== null) clearTimeout(drive.timer);
  drive = null;
}

function step() {
  try {
    const own = drive;
    const start = performance.now();
    const result = engine.nextFrame();
    if (result === null) {
      self.postMessage({ type: "end" });
      stopDrive();
      return;
    }
    own.lastUs = result.tUs;
    if (own.startUs === null) restartClock(own);
    own.shown = false;
    post(result, { mode: "drive", wholeMs: performance.now() - start });
  } catch (error) {
    stopDrive();
    fail(error);
  }
}

function restartClock(own) {
  own.startMs = performance.now();
  own.startUs = own.lastUs;
}

/** The next frame, once the last one was shown and its time has come. */
function schedule() {
  if (drive === null || paused || !drive.shown) return;
  clearTimeout(drive.timer);
  const frameUs = 1e6 / 30;
  const due = drive.startUs === null
    ? 0 : drive.startMs + (drive.lastUs - drive.startUs + frameUs) / 1000 - performance.now();
  if (!fast && due < -200) restartClock(drive);  // this device is slower than the drive: no catching up
  drive.timer = setTimeout(step, fast ? 0 : Math.max(0, due));
}

const handlers = {
  async load({ wasm, clip }) {
    engine = await makeEngine(wasm, () => performance.now());
    engine.loadClip(new Uint8Array(clip));
    self.postMessage({ type: "ready" });
  },
  drive() {
    stopDrive();
    engine.startDrive();
    paused = false;
    drive = { startMs: 0, startUs: null, lastUs: 0, shown: true, timer: 0 };
    schedule();
  },
  shown() {
    if (drive !== null) drive.shown = true;
    schedule();
  },
  pace(message) {
    fast = message.fast;
    paused = message.paused;
    if (drive !== null && drive.startUs !== null) restartClock(drive);
    schedule();
  },
  camera({ width, height, fovRad }) {
    stopDrive();
    engine.startCamera(width, height, fovRad);
  },
  picture({ rgba, tUs, session }) {
    const start = performance.now();
    const result = engine.trackCamera(new Uint8Array(rgba), tUs);
    if (result === null) {
      self.postMessage({ type: "refused" });
      return;
    }
    post(result, { mode: "camera", session, wholeMs: performance.now() - start });
  },
  place({ x, y }) {
    self.postMessage({ type: "placed", status: engine.place(x, y) });
  },
  /** For the tests: whether this thread can reach the network. */
  async probe({ url }) {
    const reached = await fetch(url).then(() => true, () => false);
    self.postMessage({ type: "probed", reached });
  },
};

self.onmessage = async ({ data }) => {
  try {
    await handlers[data.type](data);
  } catch (error) {
    fail(error);
  }
};
