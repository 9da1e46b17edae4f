"use strict";

const BUDGET_MS = 41.57;
const STAGE_NAMES = ["Preprocessing", "Prediction", "Features, matching", "Update, map", "Drawing"];
const WINDOW = 120;  // frames that the times are of
const LARGEST = { width: 640, height: 480 };  // picture that the tracker takes
const DRIVE_STATES = { initialising: "starting", tracking: "tracking", uncertain: "uncertain", lost: "lost" };
const HINTS = {
  initialising: "Move the camera sideways, slowly, over something with texture: a desk, a shelf, a carpet.",
  tracking: "Tap the picture to place a cairn.",
  uncertain: "Little is seen of the map. Go back a little, or turn to something with texture.",
  lost: "Lost. Point the camera where it was before, or start again.",
};

const $ = (id) => document.getElementById(id);
const canvas = $("picture");
const context = canvas.getContext("2d");
const captured = document.createElement("canvas");  // the camera's picture that is being tracked
const capture = captured.getContext("2d", { willReadFrequently: true });
const overlay = document.createElement("canvas");
const video = document.createElement("video");
video.muted = true;
video.playsInline = true;

let worker = null;
let expected = null;  // hashes of the other targets: hall.json
let mode = "drive";
let busy = false;  // the worker has a picture
let session = 0;  // of the camera: answers of an older one are dropped
let stream = null;
let times = [];
let equal = 0;
let compared = 0;
let lastShown = 0;
let paused = false;
let lastTime = -1;  // of the video, s

// --- loading ---

async function get(name) {
  const answer = await fetch(name);
  if (!answer.ok) throw new Error(`${name}: ${answer.status} ${answer.statusText}`);
  return answer;
}

/** From now on neither the page nor its worker, which inherits this, can reach anything. */
function forbidConnections() {
  const policy = document.createElement("meta");
  policy.httpEquiv = "Content-Security-Policy";
  policy.content = "default-src 'none'; script-src 'wasm-unsafe-eval'; style-src 'self'; worker-src blob:; " +
    "media-src blob:; connect-src 'none'; img-src 'none'";
  document.head.append(policy);
}

async function load() {
  const [engineText, workerText, wasm, clip, hashes] = await Promise.all([
    get("engine.js").then((a) => a.text()), get("worker.js").then((a) => a.text()),
    get("engine.wasm").then((a) => a.arrayBuffer()), get("hall.clip").then((a) => a.arrayBuffer()),
    get("hall.json").then((a) => a.json())]);
  expected = hashes;
  forbidConnections();
  const source = new Blob([engineText, "\n", workerText], { type: "text/javascript" });
  worker = new Worker(URL.createObjectURL(source));
  worker.onmessage = ({ data }) => handlers[data.type](data);
  worker.onerror = (event) => say(`The tracker's thread failed: ${event.message}`, true);
  worker.postMessage({ type: "load", wasm, clip }, [wasm, clip]);
}

// --- what is shown ---

let heldUntil = 0;  // a message that is not to be replaced by hints yet
function say(text, bad, holdMs = 0) {
  heldUntil = performance.now() + holdMs;
  $("message").textContent = text;
  $("message").classList.toggle("bad", Boolean(bad));
}

function showState(state, text) {
  $("state").textContent = text;
  $("state").className = `state ${state}`;
}

/** Mean of the middle half: browsers round their clocks, and other programs interrupt. */
function typical(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.slice(Math.floor(sorted.length / 4), Math.ceil(0.75 * sorted.length));
  return middle.reduce((a, b) => a + b, 0) / middle.length;
}

function showTimes(frame) {
  const stages = frame.stageUs.map((us) => us / 1000);
  times.push({ stages, total: stages.reduce((a, b) => a + b, 0), whole: frame.wholeMs });
  if (times.length > WINDOW) times.shift();
  if (performance.now() - lastShown < 200) return;
  lastShown = performance.now();
  const total = typical(times.map((t) => t.total));
  $("time").textContent = total.toFixed(2);
  $("bar").childNodes.forEach((piece, i) => {
    const own = typical(times.map((t) => t.stages[i]));
    piece.style.width = `${Math.min(100, 100 * own / BUDGET_MS)}%`;
    $("stages").querySelectorAll("dd")[i].textContent = `${own.toFixed(2)} ms`;
  });
  const largest = Math.max(...times.map((t) => t.total)).toFixed(1);
  $("rate").textContent =
    `Largest ${largest} ms. The tracker alone would do ${Math.round(1000 / Math.max(total, 0.01))} frames a second.`;
}

function showCounts(frame) {
  $("landmarks").textContent = frame.landmarks;
  $("matches").textContent = `${frame.matches} of ${frame.searched}`;
  $("inliers").textContent = frame.inliers;
  $("placed").textContent = frame.placed;
}

function drawPoints(frame) {
  if (!document.querySelector(mode === "drive" ? "#drive-controls .dots" : "#camera-controls .dots").checked) return;
  context.strokeStyle = "#22d3ee";
  context.lineWidth = 1.5;
  for (let i = 0; i < frame.points.length; i += 2) {
    context.beginPath();
    context.arc(frame.points[i], frame.points[i + 1], 4, 0, 2 * Math.PI);
    context.stroke();
  }
}

function fitCanvas(width, height) {
  for (const each of [canvas, overlay]) {
    if (each.width !== width || each.height !== height) Object.assign(each, { width, height });
  }
}

function compareHashes(frame) {
  const at = expected.numbers.indexOf(frame.number);
  $("number").textContent = frame.number;
  const rows = [["this page", frame.frameHash, frame.pictureHash]];
  let good = at >= 0;
  for (const target of expected.targets) {
    rows.push([target.name, target.frames[at], target.pictures[at]]);
    good = good && target.frames[at] === frame.frameHash && target.pictures[at] === frame.pictureHash;
  }
  ++compared;
  if (good) ++equal;
  $("hashes").replaceChildren(...rows.map(([name, ...values]) => {
    const row = document.createElement("tr");
    const head = document.createElement("th");
    head.scope = "row";
    head.textContent = name;
    row.append(head, ...values.map((value) => {
      const cell = document.createElement("td");
      cell.textContent = value;
      return cell;
    }));
    return row;
  }));
  $("equal").textContent = `${equal} of ${compared} frames equal`;
  $("equal").className = `big ${equal === compared ? "good" : "bad"}`;
}

function showDrive(frame) {
  fitCanvas(frame.width, frame.height);
  context.putImageData(new ImageData(frame.picture, frame.width, frame.height), 0, 0);
  drawPoints(frame);
  showState(frame.state, DRIVE_STATES[frame.state]);
  compareHashes(frame);
  worker.postMessage({ type: "shown" });
}

function showCamera(frame) {
  fitCanvas(frame.width, frame.height);
  overlay.getContext("2d").putImageData(new ImageData(frame.picture, frame.width, frame.height), 0, 0);
  context.drawImage(captured, 0, 0);
  context.drawImage(overlay, 0, 0);
  drawPoints(frame);
  showState(frame.state, frame.state);
  if (performance.now() > heldUntil) say(HINTS[frame.state]);
}

const handlers = {
  ready() {
    for (const id of ["drive", "camera", "file", "pause"]) $(id).disabled = false;
    $("stages").replaceChildren(...STAGE_NAMES.flatMap((name, i) => {
      const [term, value] = [document.createElement("dt"), document.createElement("dd")];
      term.className = `s${i}`;
      term.textContent = name;
      value.textContent = "–";
      return [term, value];
    }));
    startDrive();
  },
  frame(frame) {
    if (frame.mode !== mode || (mode === "camera" && frame.session !== session)) {
      busy = false;
      return;
    }
    (mode === "drive" ? showDrive : showCamera)(frame);
    showTimes(frame);
    showCounts(frame);
    busy = false;
  },
  refused() { busy = false; },
  placed({ status }) {
    const texts = {
      ok: "Placed.", full: "Eight cairns are the most. Start again for new ones.",
      not_found: "Too little is known of the scene yet: move on sideways.",
    };
    say(texts[status] || `Not placed: ${status}.`, status !== "ok", 2500);
  },
  end() {
    document.body.dataset.driveMs = $("time").textContent;  // for tests, as the next
    document.body.dataset.drive = `ended ${equal} of ${compared}`;
    if (mode === "drive" && !paused) startDrive();
  },
  probed({ reached }) { document.body.dataset.probe = reached ? "reached" : "blocked"; },
  error({ text }) {
    busy = false;
    say(`The tracker stopped: ${text}.`, true);
  },
};

// --- the drive ---

function startDrive() {
  stopVideo();
  setMode("drive");
  equal = compared = 0;
  paused = false;
  $("pause").textContent = "Pause";
  say(expected.about);
  worker.postMessage({ type: "drive" });
  sendPace();
}

function sendPace() {
  worker.postMessage({ type: "pace", fast: $("fast").checked, paused });
}

function setMode(next) {
  mode = next;
  times = [];
  showState("initialising", "starting");
  for (const id of ["time", "number", "landmarks", "matches", "inliers", "placed"]) $(id).textContent = "–";
  ++session;
  busy = false;
  $("drive").setAttribute("aria-pressed", String(next === "drive"));
  $("camera").setAttribute("aria-pressed", String(next === "camera" && stream !== null));
  $("file-label").classList.toggle("pressed", next === "camera" && stream === null);
  $("drive-controls").hidden = next !== "drive";
  $("hash-card").hidden = next !== "drive";
  $("camera-controls").hidden = next === "drive";
  canvas.parentElement.classList.toggle("tap", next === "camera");
}

// --- the visitor's camera, or a video file ---

const REFUSALS = {
  NotAllowedError: "The camera was not allowed. Allow it for this page (the symbol beside the address, or the browser's " +
    "settings), then press “Your camera” again. Its pictures stay on this device.",
  NotFoundError: "No camera was found. Connect one, or choose a video of yours.",
  NotReadableError: "The camera cannot be read: another program may be using it. Close that, then try again.",
  OverconstrainedError: "No camera gives pictures of a size that the tracker takes.",
};

function stopVideo() {
  if (stream !== null) stream.getTracks().forEach((track) => track.stop());
  stream = null;
  video.srcObject = null;
  if (video.src) URL.revokeObjectURL(video.src);
  video.removeAttribute("src");
}

async function openCamera() {
  if (!navigator.mediaDevices || !navigator.mediaDevices.getUserMedia) {
    say("Browsers give their camera only to pages of https:// or of this machine (localhost). Open this page so.", true);
    return;
  }
  stopVideo();
  say("Waiting for the camera…");
  try {
    stream = await navigator.mediaDevices.getUserMedia({
      audio: false,
      // Not cut to the size by the browser: the field of view is the camera's own.
      video: {
        facingMode: "environment", width: { ideal: 640 }, height: { ideal: 480 }, frameRate: { ideal: 30 },
        resizeMode: { ideal: "none" },
      },
    });
  } catch (error) {
    const text = REFUSALS[error.name] || `The camera could not be opened: ${error.message || error.name}.`;
    startDrive();
    say(text, true);
    return;
  }
  video.srcObject = stream;
  await playVideo("The camera gives no pictures.");
}

async function openFile(file) {
  stopVideo();
  video.src = URL.createObjectURL(file);
  video.loop = true;
  await playVideo("This browser cannot play this video.");
}

async function playVideo(fault) {
  try {
    await video.play();
  } catch (error) {
    startDrive();
    say(`${fault} (${error.message || error.name})`, true);
    return;
  }
  lastTime = -1;
  startCamera();
}

/** The largest picture that the tracker takes, of the video's shape. */
function pictureSize() {
  const scale = Math.min(1, LARGEST.width / video.videoWidth, LARGEST.height / video.videoHeight);
  return { width: Math.floor(scale * video.videoWidth), height: Math.floor(scale * video.videoHeight) };
}

function startCamera() {
  setMode("camera");
  const { width, height } = pictureSize();
  Object.assign(captured, { width, height });
  worker.postMessage({ type: "camera", width, height, fovRad: $("fov").value * Math.PI / 180 });
  nextPicture(session);
}

function nextPicture(own) {
  if (own !== session) return;
  if (video.requestVideoFrameCallback) {
    video.requestVideoFrameCallback((now, data) => takePicture(own, data.mediaTime));
  } else {
    requestAnimationFrame(() => takePicture(own, video.currentTime));
  }
}

function takePicture(own, seconds) {
  if (own !== session) return;
  const { width, height } = pictureSize();
  if (width !== captured.width || height !== captured.height || seconds < lastTime - 0.5) {
    lastTime = seconds;
    startCamera();  // the device was turned, or the video began anew
    return;
  }
  if (!busy && seconds !== lastTime) {
    lastTime = seconds;
    capture.drawImage(video, 0, 0, width, height);
    const rgba = capture.getImageData(0, 0, width, height).data.buffer;
    busy = true;
    worker.postMessage({ type: "picture", rgba, tUs: Math.round(1e6 * seconds), session }, [rgba]);
  }
  nextPicture(own);
}

// --- controls ---

$("drive").onclick = startDrive;
$("camera").onclick = openCamera;
$("file").onchange = () => { if ($("file").files.length > 0) openFile($("file").files[0]); };
$("fast").onchange = sendPace;
$("pause").onclick = () => {
  paused = !paused;
  $("pause").textContent = paused ? "Go on" : "Pause";
  sendPace();
};
$("restart").onclick = startCamera;
$("fov").oninput = () => { $("fov-value").textContent = `${$("fov").value}°`; };
$("fov").onchange = () => { if (mode === "camera") startCamera(); };
canvas.onclick = (event) => {
  if (mode !== "camera") return;
  const box = canvas.getBoundingClientRect();
  const scale = Math.min(box.width / canvas.width, box.height / canvas.height);
  const x = (event.clientX - box.left - (box.width - scale * canvas.width) / 2) / scale - 0.5;
  const y = (event.clientY - box.top - (box.height - scale * canvas.height) / 2) / scale - 0.5;
  const inside = Math.min(Math.max(x, 0), canvas.width - 1);
  worker.postMessage({ type: "place", x: inside, y: Math.min(Math.max(y, 0), canvas.height - 1) });
};

load().catch((error) => {
  showState("lost", "not loaded");
  say(`The page could not be loaded: ${error.message}. It needs WebAssembly, and a server that gives its files ` +
    "(python3 -m http.server in its folder will do).", true);
});
