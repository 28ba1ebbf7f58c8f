#!/bin/sh
# Plays hosted sessions in Chromium. Usage: tests/browser/check.sh [--required]
#
# NOVAMIND is the program. CHROMIUM is the browser; otherwise the one in PATH is used, or Playwright's is installed. Screenshots
# are written to target/browser. Without node or Chromium, the checks are skipped, or fail with --required.
set -eu
cd "$(dirname "$0")/../.."
: "${NOVAMIND:=target/debug/novamind}"
NOVAMIND=$(cd "$(dirname "$NOVAMIND")" && pwd)/$(basename "$NOVAMIND")
tools=target/browser/tools

skip() {
    echo "tests/browser: $1; hosted sessions in a browser were not checked"
    [ "$required" = no ] || exit 1
    exit 0
}
required=no
[ "${1:-}" = --required ] && required=yes

command -v node >/dev/null || skip "node is not installed"
if [ -z "${CHROMIUM:-}" ]; then
    CHROMIUM=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
fi
mkdir -p "$tools"
if [ ! -d "$tools/node_modules/playwright-core" ]; then
    npm install --silent --no-save --prefix "$tools" playwright-core@1.65.1 || skip "playwright-core cannot be installed"
fi
if [ -z "$CHROMIUM" ]; then
    node "$tools/node_modules/playwright-core/cli.js" install chromium || skip "Chromium cannot be installed"
fi
export NOVAMIND CHROMIUM
NODE_PATH="$tools/node_modules" exec node tests/browser/sessions.js
