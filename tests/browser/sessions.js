// Plays hosted sessions in Chromium: link, keys, reload, a second tab, and a network that fails. tests/browser/check.sh runs it.
"use strict";

const assert = require("node:assert/strict");
const { execFileSync, spawn } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { chromium, devices } = require("playwright-core");
const { startProxy } = require("./flaky_network.js");

const SCREENSHOTS = path.resolve("target/browser");
const ADMIN_CODE = "correct horse";
const WAIT_MS = 60_000;
/** Without WebGL, xterm.js draws text with elements, which the checks can read. */
const READABLE = ["--no-sandbox", "--disable-3d-apis"];
const DRAWN = ["--no-sandbox", "--enable-unsafe-swiftshader"];

const study = path.join(fs.mkdtempSync(path.join(os.tmpdir(), "novamind-browser-")), "pilot");

function novamind(args, input = "") {
  return execFileSync(process.env.NOVAMIND, args, { input, encoding: "utf8" });
}

/** Creates a study whose session starts without practice and questions. */
function createStudy(address) {
  novamind(["study", "new", study]);
  for (const file of fs.readdirSync(path.join(study, "questions"))) fs.unlinkSync(path.join(study, "questions", file));
  fs.writeFileSync(
    path.join(study, "study.toml"),
    'name = "pilot"\ntitle = "A company"\n[seeds]\nplan = "secret"\ncount = 2\n[practice]\noffer = "none"\n',
  );
  novamind(["study", "assign", study, "--participants", "4"]);
  novamind(["study", "key", study]);
  novamind(["host", "code", study], `${ADMIN_CODE}\n`);
  const file = path.join(study, "links.csv");
  novamind(["host", "links", study, "--csv", file, "--url", address]);
  const lines = fs.readFileSync(file, "utf8").trim().split("\n").slice(1);
  return Object.fromEntries(lines.map((line) => line.split(",")).map(([label, link]) => [label, link]));
}

/** Starts the host on a free port, and waits until it accepts connections. */
function startHost() {
  const host = spawn(process.env.NOVAMIND, ["--study", study, "host", "--listen", "127.0.0.1:0"], {
    stdio: ["ignore", "pipe", "inherit"],
  });
  return new Promise((resolve, reject) => {
    let text = "";
    host.stdout.on("data", (data) => {
      text += data;
      const port = /http:\/\/127\.0\.0\.1:(\d+)/.exec(text);
      if (port) resolve({ port: Number(port[1]), process: host });
    });
    host.on("exit", (code) => reject(new Error(`the host ended with ${code}`)));
  });
}

function stopHost(host) {
  host.process.removeAllListeners("exit");
  return new Promise((resolve) => {
    host.process.on("exit", resolve);
    host.process.kill("SIGTERM");
  });
}

const screenText = (page) => page.locator(".xterm-rows").innerText().then((text) => text.replaceAll("\u00a0", " "));

/** Waits until the terminal shows a text. */
async function shows(page, part) {
  const end = Date.now() + WAIT_MS;
  let text = "";
  while (Date.now() < end) {
    text = await screenText(page);
    if (part instanceof RegExp ? part.test(text) : text.includes(part)) return text;
    await page.waitForTimeout(50);
  }
  throw new Error(`the terminal does not show ${part}:\n${text}`);
}

async function openPage(context, address) {
  const page = await context.newPage();
  page.on("pageerror", (error) => assert.fail(`error in the page: ${error.message}`));
  page.on("console", (message) => {
    assert(!/Content Security Policy/.test(message.text()), message.text());
  });
  // The host must not cause requests to other machines.
  page.on("request", (request) => assert(/^(http:\/\/127\.0\.0\.1:|data:)/.test(request.url()), request.url()));
  await page.goto(address);
  return page;
}

async function press(page, ...keys) {
  for (const key of keys) {
    await page.keyboard.press(key);
    await page.waitForTimeout(150);
  }
}

/** Agrees to the consent text, and starts the session. */
async function start(page) {
  for (let step = 0; step < 20; step += 1) {
    const text = await screenText(page);
    if (/wk 0\//.test(text) && !/tour/i.test(text)) return;
    await press(page, "End", "y", "Enter");
    await page.waitForTimeout(400);
  }
  assert.fail(`the session does not start:\n${await screenText(page)}`);
}

async function playWeek(page, week) {
  await press(page, "n", "Enter");
  await page.keyboard.type("played in a browser");
  await press(page, "Enter", "f", "Enter");
  await shows(page, new RegExp(`wk ${week}/`));
  await press(page, "Enter");
}

/** Types numbered words while the network fails. Each character must arrive once and in order. */
async function typeWhileNetworkFails(page, proxy, failures, words) {
  const typed = Array.from({ length: words }, (_, index) => `w${String(index).padStart(3, "0")}`).join(".");
  const failing = failures(proxy);
  await page.keyboard.type(typed, { delay: 6 });
  await failing;
  const squeeze = (text) => text.replaceAll(/[^w0-9.]/g, "");
  const end = Date.now() + WAIT_MS;
  let shown = "";
  while (Date.now() < end && !shown.includes(typed)) {
    shown = squeeze(await screenText(page));
    await page.waitForTimeout(100);
  }
  assert(shown.includes(typed), `typed ${typed}\nshown ${shown}`);
}

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

async function main() {
  fs.mkdirSync(SCREENSHOTS, { recursive: true });
  let host;
  const proxy = await startProxy(() => host.port);
  const address = `http://127.0.0.1:${proxy.port}`;
  const links = createStudy(address);
  host = await startHost();
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || undefined, args: READABLE });
  const drawing = await chromium.launch({ executablePath: process.env.CHROMIUM || undefined, args: DRAWN });
  const check = async (name, steps) => {
    await steps();
    console.log(`ok  ${name}`);
  };
  try {
    const context = await browser.newContext({ viewport: { width: 1280, height: 720 } });
    let page = await openPage(context, links.P01);
    await check("a link opens the session and leaves the address", async () => {
      await page.waitForURL(`${address}/`);
      await start(page);
    });
    await check("two weeks are played with keys", async () => {
      await playWeek(page, 1);
      await playWeek(page, 2);
    });
    await check("a reload continues the session", async () => {
      await page.reload();
      await shows(page, /wk 2\//);
    });
    await check("a tab that was closed is opened again", async () => {
      await page.close();
      page = await openPage(context, address);
      await shows(page, /wk 2\//);
    });
    await check("no key is lost or doubled when connections are cut", async () => {
      await press(page, "0", "Tab", "e");
      await typeWhileNetworkFails(page, proxy, async (network) => {
        for (let cut = 0; cut < 6; cut += 1) {
          await pause(230);
          network.cut();
        }
      }, 60);
    });
    await check("no key is lost or doubled when the network is silent for 7 s", async () => {
      await press(page, "Control+s", "e");
      await page.keyboard.type(" ");
      await typeWhileNetworkFails(page, proxy, async (network) => {
        await pause(200);
        network.silence();
        await pause(7000);
        network.restore();
      }, 61);
      await press(page, "Control+s");
    });
    await check("a session that is connected again shows no banner", async () => {
      await page.locator("#connection").waitFor({ state: "hidden" });
    });
    await check("a restart of the host continues the session", async () => {
      await stopHost(host);
      host = await startHost();
      await page.locator("#dialog").waitFor({ state: "hidden", timeout: WAIT_MS });
      await shows(page, /wk 2\//);
    });
    await check("a second tab takes over, and the first can continue", async () => {
      const second = await openPage(context, address);
      await shows(second, /wk 2\//);
      await page.getByText("opened in another window").waitFor();
      await page.screenshot({ path: path.join(SCREENSHOTS, "taken-over.png") });
      await page.getByRole("button", { name: "Continue here" }).click();
      await second.getByText("opened in another window").waitFor();
      await shows(page, /wk 2\//);
      await second.close();
    });
    await check("the experimenter signs in, sends a message, and pauses and resumes a session", async () => {
      const admin = await openPage(await browser.newContext({ viewport: { width: 1280, height: 720 } }), `${address}/admin`);
      await admin.getByLabel("Code").fill(ADMIN_CODE);
      await admin.getByRole("button", { name: "Open" }).click();
      await admin.getByRole("link", { name: "P01" }).waitFor();
      await admin.screenshot({ path: path.join(SCREENSHOTS, "admin.png") });
      await admin.getByRole("link", { name: "P01" }).click();
      await admin.getByLabel("Text").fill("The break is at noon <b>.");
      await admin.getByRole("button", { name: "Send the message" }).click();
      await admin.getByText("The message was sent.").waitFor();
      await page.getByText("Message from the experimenter: The break is at noon <b>.").waitFor();
      await page.screenshot({ path: path.join(SCREENSHOTS, "message.png") });
      await page.getByRole("button", { name: "Close" }).click();
      await admin.screenshot({ path: path.join(SCREENSHOTS, "admin-session.png") });
      await admin.getByRole("button", { name: "Pause the session" }).click();
      await page.getByText("paused this session").waitFor({ timeout: WAIT_MS });
      await page.screenshot({ path: path.join(SCREENSHOTS, "paused.png") });
      await admin.getByRole("button", { name: "Resume the session" }).click();
      await page.locator("#dialog").waitFor({ state: "hidden", timeout: WAIT_MS });
      await shows(page, /wk 2\//);
    });
    await check("screenshots at three sizes", async () => {
      const sizes = {
        "1280x720": { viewport: { width: 1280, height: 720 } },
        "1920x1080": { viewport: { width: 1920, height: 1080 } },
        phone: devices["Pixel 5"],
      };
      for (const [name, options] of Object.entries(sizes)) {
        const drawn = await openPage(await drawing.newContext(options), links.P01);
        await drawn.waitForTimeout(4000);
        await drawn.screenshot({ path: path.join(SCREENSHOTS, `${name}.png`) });
        await drawn.close();
      }
    });
    await check("a wrong link is explained", async () => {
      const wrong = await openPage(context, `${address}/s/00000000000000000000000000000000`);
      await wrong.getByText("This link is not valid").waitFor();
      await wrong.close();
    });
  } finally {
    await browser.close();
    await drawing.close();
    await stopHost(host);
    proxy.close();
    fs.rmSync(path.dirname(study), { recursive: true, force: true });
  }
}

main().catch((error) => {
  console.error(error);
  process.exitCode = 1;
});
