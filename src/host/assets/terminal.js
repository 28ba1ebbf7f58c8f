// The terminal of a participant. The host sends output of the session as binary messages, and everything else as JSON.
//
// Every input has a number. The host acknowledges numbers, and inputs that it has not acknowledged are sent again after a
// reconnect; the host ignores numbers that it knows. So a network cut neither loses nor doubles a key.
"use strict";

(() => {
  /** Characters of the smallest and the largest window, as in src/host/attachment.rs. */
  const LIMITS = { columns: [60, 200], rows: [16, 60] };
  /** A larger font may fill a window that is too large, but leaves at least this number of characters. */
  const COMFORTABLE = { columns: [120], rows: [40] };
  const FONT_SIZE = 15;
  /** The host sends a message at least every 2 s. After this time without one, the connection is considered lost. */
  const SILENCE_MS = 6000;
  /** Keys that are typed this long after the connection was lost are ignored, because the user does not see their effect. */
  const TYPE_AHEAD_MS = 3000;
  const MAX_RETRY_MS = 1000;
  const PAUSED_RETRY_MS = 5000;
  /** Number of displayed bytes after which the host is informed. */
  const REPORT_BYTES = 8192;

  const styleNonce = document.currentScript.nonce;
  const element = (id) => document.getElementById(id);
  const clamp = (value, [least, most]) => Math.min(Math.max(value, least), most);

  // xterm.js adds style elements, which the content security policy allows only with the nonce of the page.
  const createElement = document.createElement.bind(document);
  document.createElement = (name, options) => {
    const created = createElement(name, options);
    if (name === "style") created.nonce = styleNonce;
    return created;
  };

  const terminal = new Terminal({
    allowProposedApi: true,
    cursorBlink: false,
    drawBoldTextInBrightColors: false,
    fontFamily:
      '"DejaVu Sans Mono", "Cascadia Mono", Menlo, Consolas, "Liberation Mono", "Noto Sans Mono", "Apple Braille", "Segoe UI Symbol", "Noto Sans Symbols 2", monospace',
    fontSize: FONT_SIZE,
    macOptionClickForcesSelection: true,
    rescaleOverlappingGlyphs: true,
    scrollback: 0,
    // Colors that a theme of the program names instead of defining them.
    theme: {
      background: "#101216",
      foreground: "#d8dae0",
      black: "#1b1e25",
      red: "#f2716b",
      green: "#6cc37a",
      yellow: "#d9a441",
      blue: "#6ea8fe",
      magenta: "#c792ea",
      cyan: "#3fc1c9",
      white: "#d8dae0",
      brightBlack: "#667080",
      brightRed: "#ff938c",
      brightGreen: "#8fe09b",
      brightYellow: "#f5c866",
      brightBlue: "#93c0ff",
      brightMagenta: "#dcb4f7",
      brightCyan: "#6ee3ea",
      brightWhite: "#ffffff",
    },
  });
  const fit = new FitAddon.FitAddon();
  terminal.loadAddon(fit);
  terminal.loadAddon(new UnicodeGraphemesAddon.UnicodeGraphemesAddon());
  terminal.open(element("terminal"));
  useWebGl();

  // Without WebGL, xterm.js draws with elements of the page.
  function useWebGl() {
    try {
      const webgl = new WebglAddon.WebglAddon();
      webgl.onContextLoss(() => webgl.dispose());
      terminal.loadAddon(webgl);
    } catch (error) {
      console.info("WebGL is not available:", error.message);
    }
  }

  // ---- Connection ----

  /** Identifies this page, so that the host knows which inputs it has received from it. */
  const client = crypto.getRandomValues(new Uint32Array(4)).join("-");
  /** Inputs that the host has not acknowledged: { number, text }. */
  let unacknowledged = [];
  let lastNumber = 0;
  let socket = null;
  let isConnected = false;
  let wasConnected = false;
  let lostAt = 0;
  let retries = 0;
  let retryTimer = 0;
  let silenceTimer = 0;
  let receivedBytes = 0;
  let reportedBytes = 0;

  function connect() {
    clearTimeout(retryTimer);
    const address = new URL("/socket", location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    const opened = new WebSocket(address);
    socket = opened;
    opened.binaryType = "arraybuffer";
    const isCurrent = (handler) => (event) => opened === socket && handler(event);
    opened.onopen = isCurrent(() => {
      const { cols: columns, rows } = terminal;
      const label = document.body.dataset.label;
      send({ type: "hello", label, client, resume: wasConnected, columns, rows });
    });
    opened.onmessage = isCurrent(({ data }) => {
      expectMessage();
      if (typeof data === "string") receive(JSON.parse(data));
      else display(new Uint8Array(data));
    });
    opened.onclose = isCurrent(reconnect);
    expectMessage();
  }

  function expectMessage() {
    clearTimeout(silenceTimer);
    silenceTimer = setTimeout(reconnect, SILENCE_MS);
  }

  function disconnect() {
    clearTimeout(silenceTimer);
    const closed = socket;
    socket = null;
    if (isConnected) lostAt = Date.now();
    isConnected = false;
    if (closed) closed.close();
  }

  /** Connects at once the first time, then with a growing delay of at most one second. */
  function reconnect() {
    disconnect();
    element("connection").hidden = false;
    const delay = retries === 0 ? 0 : Math.min(MAX_RETRY_MS, 50 * 2 ** retries);
    retries += 1;
    clearTimeout(retryTimer);
    retryTimer = setTimeout(connect, delay);
  }

  function send(message) {
    if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
  }

  function receive(message) {
    switch (message.type) {
      case "welcome":
        return welcome(message);
      case "acknowledged":
        unacknowledged = unacknowledged.filter(({ number }) => number > message.number);
        return;
      case "notice":
        return showNotice(message.text);
      case "closed":
        return closed(message);
      case "alive":
        return send({ type: "alive" });
    }
  }

  function welcome({ acknowledged, continues }) {
    if (!continues && unacknowledged.length > 0) {
      unacknowledged = [];
      showNotice("The session was started again. The keys that you typed while the connection was lost were not sent.");
    }
    unacknowledged = unacknowledged.filter(({ number }) => number > acknowledged);
    isConnected = true;
    wasConnected = true;
    retries = 0;
    receivedBytes = 0;
    reportedBytes = 0;
    element("connection").hidden = true;
    hideDialog();
    terminal.reset();
    resize();
    for (const input of unacknowledged) send({ type: "input", ...input });
  }

  function display(bytes) {
    receivedBytes += bytes.length;
    const shown = receivedBytes;
    terminal.write(bytes, () => {
      if (shown - reportedBytes < REPORT_BYTES) return;
      reportedBytes = shown;
      send({ type: "displayed", bytes: shown });
    });
  }

  function input(text) {
    if (!isConnected && Date.now() - lostAt > TYPE_AHEAD_MS) return;
    lastNumber += 1;
    const numbered = { number: lastNumber, text };
    unacknowledged.push(numbered);
    if (isConnected) send({ type: "input", ...numbered });
  }

  terminal.onData(input);

  // ---- Dialogs and notices ----

  function closed({ reason, text }) {
    disconnect();
    wasConnected = false;
    unacknowledged = [];
    element("connection").hidden = true;
    const buttons = { taken_over: "Continue here", ended: "Open the session again", failed: "Try again" };
    const retryAfter = { paused: PAUSED_RETRY_MS, shutdown: MAX_RETRY_MS }[reason];
    showDialog(retryAfter ? `${text} This window connects again automatically.` : text, buttons[reason]);
    if (retryAfter) retryTimer = setTimeout(connect, retryAfter);
  }

  function showDialog(text, button) {
    element("dialog-text").textContent = text;
    element("dialog-button").hidden = !button;
    element("dialog-button").textContent = button || "";
    element("dialog").hidden = false;
    if (button) element("dialog-button").focus();
  }

  function hideDialog() {
    if (element("dialog").hidden) return;
    element("dialog").hidden = true;
    terminal.focus();
  }

  function showNotice(text) {
    element("notice-text").textContent = text;
    element("notice").hidden = false;
    resize();
  }

  element("dialog-button").onclick = () => {
    hideDialog();
    connect();
  };
  element("notice-close").onclick = () => {
    element("notice").hidden = true;
    resize();
    terminal.focus();
  };

  // ---- Size ----

  /** Chooses the size of the font so that the window has a permitted number of columns and rows. */
  function resize() {
    terminal.options.fontSize = FONT_SIZE;
    let size = fit.proposeDimensions();
    if (!size || !size.cols || !size.rows) return;
    const ratio = (limits, index) => [size.cols / limits.columns[index], size.rows / limits.rows[index]];
    const enlarge = Math.min(Math.max(...ratio(LIMITS, 1)), ...ratio(COMFORTABLE, 0));
    const shrink = Math.min(...ratio(LIMITS, 0));
    if (enlarge > 1) terminal.options.fontSize = FONT_SIZE * enlarge;
    if (shrink < 1) terminal.options.fontSize = FONT_SIZE * shrink;
    // Cells have whole pixels, so the number of characters does not follow the size of the font exactly.
    for (let tries = 0; tries < 8; tries += 1) {
      size = fit.proposeDimensions();
      if (Math.min(...ratio(LIMITS, 0)) < 1) terminal.options.fontSize -= 0.5;
      else if (size.cols > LIMITS.columns[1] && Math.min(...ratio(COMFORTABLE, 0)) > 1) terminal.options.fontSize += 0.5;
      else break;
    }
    const columns = clamp(size.cols, LIMITS.columns);
    const rows = clamp(size.rows, LIMITS.rows);
    if (columns !== terminal.cols || rows !== terminal.rows) terminal.resize(columns, rows);
    if (isConnected) send({ type: "size", columns, rows });
  }

  let resizeTimer = 0;
  new ResizeObserver(() => {
    clearTimeout(resizeTimer);
    resizeTimer = setTimeout(resize, 50);
  }).observe(element("terminal"));

  // ---- Copy and paste ----

  terminal.attachCustomKeyEventHandler((event) => {
    const modified = event.ctrlKey || event.metaKey;
    const key = event.key.toLowerCase();
    // The browser pastes, and xterm.js passes the text on.
    if (modified && key === "v") return false;
    if (modified && key === "c" && terminal.hasSelection()) {
      if (event.type === "keydown") {
        copy(terminal.getSelection());
        terminal.clearSelection();
        event.preventDefault();
      }
      return false;
    }
    return event.key !== "F11";
  });

  // A session copies with the control sequence OSC 52. It cannot read the clipboard.
  terminal.parser.registerOscHandler(52, (data) => {
    const encoded = data.slice(data.indexOf(";") + 1);
    if (encoded === "?") return true;
    try {
      const bytes = Uint8Array.from(atob(encoded), (character) => character.charCodeAt(0));
      copy(new TextDecoder().decode(bytes));
    } catch (error) {
      console.info("Copied text is not valid:", error.message);
    }
    return true;
  });

  function copy(text) {
    // Pages without TLS cannot use the clipboard interface.
    if (!navigator.clipboard) return copyWithCommand(text);
    navigator.clipboard.writeText(text).catch(() => copyWithCommand(text));
  }

  function copyWithCommand(text) {
    const area = createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
    terminal.focus();
  }

  // ---- Keys for devices without a keyboard ----

  const KEYS = { esc: "\x1b", tab: "\t", up: "\x1b[A", down: "\x1b[B", left: "\x1b[D", right: "\x1b[C", enter: "\r" };
  for (const button of document.querySelectorAll("#keys button")) {
    // Buttons must not take the focus, because the keyboard of the device would close.
    button.onpointerdown = (event) => event.preventDefault();
    button.onclick = () => input(KEYS[button.dataset.key] || button.textContent);
  }

  resize();
  terminal.focus();
  connect();
})();
