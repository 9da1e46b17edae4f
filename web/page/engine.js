"use strict";

// The module of web/engine/engine.h, for the page's worker and for node. No network, no clock but `now`.

const STATES = ["initialising", "tracking", "uncertain", "lost"];
const STAGES = 5;
const MOST_POINTS = 64;
const FRAME = 1;
const END = 0;

/** Makes an engine from the module's bytes. now(): milliseconds that never go back. */
async function makeEngine(wasm, now) {
  let exports = null;
  const memory = () => exports.memory.buffer;
  const imports = {
    env: {
      web_ticks: () => Math.round(1000 * now()) >>> 0,
      emscripten_notify_memory_growth: () => {},
    },
    wasi_snapshot_preview1: { proc_exit: (code) => { throw new Error(`the module ended: ${code}`); } },
  };
  exports = (await WebAssembly.instantiate(wasm, imports)).instance.exports;
  if (exports._initialize) exports._initialize();

  function statusText(status) {
    const bytes = new Uint8Array(memory(), exports.web_status_text(status));
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }
  function need(status, what) {
    if (status !== 0) throw new Error(`${what}: ${statusText(status)}`);
  }
  const hex = (view, at) => {
    const word = (offset) => view.getUint32(at + offset, true).toString(16).padStart(8, "0");
    return word(4) + word(0);
  };

  /** web_result as an object. */
  function result() {
    const view = new DataView(memory(), exports.web_last_result());
    let at = 16;
    const next = () => view.getInt32((at += 4) - 4, true);
    const values = { frameHash: hex(view, 0), pictureHash: hex(view, 8), number: next() };
    for (const name of ["status", "state", "width", "height"]) values[name] = next();
    values.stageUs = Array.from({ length: STAGES }, next);
    for (const name of ["searched", "matches", "inliers", "landmarks", "work", "placed", "drawn"]) {
      values[name] = next();
    }
    const count = next();
    values.points = Array.from({ length: 2 * count }, (_, i) => view.getFloat32(at + 4 * i, true));
    at += 8 * MOST_POINTS;
    at += at % 8;
    values.tUs = view.getFloat64(at, true);
    values.status = statusText(values.status);
    values.state = STATES[values.state];
    return values;
  }

  return {
    loadClip(bytes) {
      const start = exports.web_reserve_clip(bytes.length);
      if (start === 0) throw new Error(`no memory for a clip of ${bytes.length} bytes`);
      new Uint8Array(memory()).set(bytes, start);
    },
    startDrive() { need(exports.web_start_drive(), "clip"); },
    /** The next frame's result; null after the last. */
    nextFrame() {
      const got = exports.web_next_frame();
      if (got === END) return null;
      if (got !== FRAME) throw new Error("clip: damaged");
      return result();
    },
    startCamera(width, height, fovRad) {
      need(exports.web_start_camera(width, height, fovRad), "camera");
    },
    /** Tracks a picture (RGBA bytes). Null when it was refused: a time twice, or backwards. */
    trackCamera(rgba, tUs) {
      new Uint8Array(memory()).set(rgba, exports.web_camera_picture());
      return exports.web_track_camera(tUs) === 0 ? result() : null;
    },
    /** "ok", or why no object was placed. */
    place(x, y) { return statusText(exports.web_place(x, y)); },
    /** A copy of the picture to be shown, RGBA. */
    shownPicture(width, height) {
      const start = exports.web_shown_picture();
      return new Uint8ClampedArray(memory().slice(start, start + 4 * width * height));
    },
  };
}

if (typeof module !== "undefined") module.exports = { makeEngine };
