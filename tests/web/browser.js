"use strict";

// Opens the page in headless Chromium, as a visitor would, at desktop and phone width, light and dark:
// the drive and its hashes, that nothing can be sent, a recording as the camera, a tap, a camera that is refused, and
// where VIDEO is given a video file in place of the camera. Leaves pictures of the page in OUT. Exit status 1 and a line
// for each check that fails.
//
// usage: node browser.js PAGE_FOLDER CAMERA.y4m OUT [VIDEO]      (playwright-core by NODE_PATH)

const fs = require("fs");
const http = require("http");
const os = require("os");
const path = require("path");
const { chromium } = require("playwright-core");

/** The first of the browser's names that is in the PATH. */
function findChromium() {
  for (const name of ["chromium", "chromium-browser", "google-chrome"]) {
    for (const folder of process.env.PATH.split(path.delimiter)) {
      if (fs.existsSync(path.join(folder, name))) return path.join(folder, name);
    }
  }
  throw new Error("browser.js: neither chromium nor google-chrome is in the PATH");
}

const TYPES = {
  ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".wasm": "application/wasm",
  ".json": "application/json",
};
const ARGUMENTS = [
  "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync",
];
const DESKTOP = { viewport: { width: 1280, height: 900 }, colorScheme: "light" };
const PHONE = { viewport: { width: 390, height: 844 }, colorScheme: "dark", deviceScaleFactor: 2, hasTouch: true };

let failures = 0;
function check(good, what) {
  console.log(`${good ? "good" : "BAD "} ${what}`);
  if (!good) ++failures;
}

function serve(folder, requests) {
  const server = http.createServer((request, answer) => {
    const name = request.url === "/" ? "/index.html" : request.url;
    requests.push(name);
    const file = path.join(folder, path.normalize(name));
    if (!fs.existsSync(file)) {
      answer.writeHead(404).end();
      return;
    }
    answer.writeHead(200, { "content-type": TYPES[path.extname(file)] || "application/octet-stream" });
    fs.createReadStream(file).pipe(answer);
  });
  return new Promise((resolve) => { server.listen(0, "127.0.0.1", () => resolve(server)); });
}

async function open(profile, extra, options) {
  const context = await chromium.launchPersistentContext(fs.mkdtempSync(profile), {
    executablePath: findChromium(), headless: true, args: [...ARGUMENTS, ...extra], ...options,
  });
  const page = context.pages()[0] || await context.newPage();
  page.on("pageerror", (error) => check(false, `no error on the page: ${error.message}`));
  return { context, page };
}

const text = (page, id) => page.textContent(`#${id}`);
const fits = (page) => page.evaluate(() => document.scrollingElement.scrollWidth <= window.innerWidth);

async function drive(page, address, out, name) {
  const frames = JSON.parse(fs.readFileSync(path.join(process.argv[2], "hall.json"))).numbers.length;
  await page.goto(address);
  await page.waitForFunction(() => parseInt(document.getElementById("number").textContent, 10) >= 75, null,
    { timeout: 60000 });
  await page.screenshot({ path: path.join(out, `drive-${name}.png`), fullPage: true });
  check(await fits(page), `${name}: nothing is wider than the page`);
  await page.check("#fast");
  await page.waitForFunction(() => document.body.dataset.drive, null, { timeout: 120000 });
  const ended = await page.evaluate(() => document.body.dataset.drive);
  check(ended === `ended ${frames} of ${frames}`, `${name}: every frame of the drive has the other targets' hashes: ${ended}`);
  console.log(`     ${name}: ${await page.evaluate(() => document.body.dataset.driveMs)} ms a frame`);
}

async function nothingIsSent(page, address, requests) {
  const before = requests.length;
  const reached = await page.evaluate((url) => fetch(url).then(() => true, () => false), `${address}index.html?probe`);
  check(!reached, "the page cannot fetch once it is loaded");
  await page.evaluate((url) => worker.postMessage({ type: "probe", url }), `${address}index.html?probe`);
  await page.waitForFunction(() => document.body.dataset.probe);
  check(await page.evaluate(() => document.body.dataset.probe) === "blocked", "nor can its worker");
  check(requests.length === before, "the server saw no request after loading");
}

async function camera(page, requests, out, name) {
  const before = requests.length;
  await page.click("#camera");
  await page.waitForSelector("#camera-controls:not([hidden])");
  await page.waitForFunction(() => document.getElementById("state").textContent === "tracking", null,
    { timeout: 60000 });
  const box = await page.locator("#picture").boundingBox();
  for (let tries = 0; tries < 20 && await text(page, "placed") !== "1"; ++tries) {
    await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.6 * box.height);
    await page.waitForTimeout(500);
  }
  check(await text(page, "placed") === "1", `${name}: a tap places an object`);
  await page.waitForTimeout(1500);
  check(["tracking", "uncertain"].includes(await text(page, "state")), `${name}: the camera is followed`);
  check(await fits(page), `${name}: nothing is wider than the page with a camera`);
  await page.screenshot({ path: path.join(out, `camera-${name}.png`), fullPage: true });
  console.log(`     ${name}: ${await text(page, "time")} ms a frame, ${await text(page, "landmarks")} landmarks`);
  check(requests.length === before, `${name}: no request while the camera runs`);
}

async function videoFile(profile, address, out, video) {
  const { context, page } = await open(profile, [], DESKTOP);
  await page.goto(address);
  await page.waitForSelector("#camera:enabled");
  await page.setInputFiles("#file", video);
  await page.waitForSelector("#camera-controls:not([hidden])");
  await page.waitForFunction(() => document.getElementById("state").textContent === "tracking" &&
    parseInt(document.getElementById("inliers").textContent, 10) >= 10, null, { timeout: 60000 });
  check(true, "a video file is followed");
  await page.screenshot({ path: path.join(out, "video.png"), fullPage: true });
  await page.setInputFiles("#file", path.join(__dirname, "browser.js"));
  await page.waitForSelector("#message.bad");
  check(/cannot play/.test(await text(page, "message")), `a file that is no video: ${await text(page, "message")}`);
  await context.close();
}

/** Without a camera, or with one that nobody allows: the page says what it needs, and shows the drive. */
async function refused(profile, address, out, name, extra, expected) {
  const { context, page } = await open(profile, extra, DESKTOP);
  await page.goto(address);
  await page.waitForSelector("#camera:enabled");
  await page.click("#camera");
  await page.waitForSelector("#message.bad");
  const message = await text(page, "message");
  check(expected.test(message), `${name}: ${message}`);
  await page.waitForFunction(() => parseInt(document.getElementById("number").textContent, 10) > 0);
  await page.screenshot({ path: path.join(out, `${name}.png`), fullPage: true });
  await context.close();
}

async function main() {
  const [folder, recording, out, video] = process.argv.slice(2).map((name) => path.resolve(name));
  fs.mkdirSync(out, { recursive: true });
  const requests = [];
  const server = await serve(folder, requests);
  const address = `http://localhost:${server.address().port}/`;
  const profiles = fs.mkdtempSync(path.join(os.tmpdir(), "cairn-chromium-"));
  const profile = path.join(profiles, "profile-");
  const fake = ["--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream",
    `--use-file-for-fake-video-capture=${recording}`];
  for (const [name, options] of [["desktop", DESKTOP], ["phone", PHONE]]) {
    const { context, page } = await open(profile, fake, options);
    await drive(page, address, out, name);
    await nothingIsSent(page, address, requests);
    await camera(page, requests, out, name);
    await context.close();
  }
  await refused(profile, address, out, "no-camera", [], /^No camera was found/);
  await refused(profile, address, out, "camera-not-allowed", ["--use-fake-device-for-media-stream"],
    /^The camera was not allowed/);
  if (video !== undefined) await videoFile(profile, address, out, video);
  server.close();
  fs.rmSync(profiles, { recursive: true, force: true, maxRetries: 10, retryDelay: 500 });
  process.exitCode = failures > 0 ? 1 : 0;
}

main();
