#!/bin/sh
# Checks exports and interfaces with Python packages: atif and inspect-ai read eleven runs, exported scripts lead to the same states, and
# mcp lists and calls every tool. Uses a virtual environment in target/python. If Python or the packages are
# missing, the script reports this and succeeds, or fails with --required.
set -eu
cd "$(dirname "$0")/../.."
program=${NOVAMIND:-target/debug/novamind}
environment=target/python
skip() {
    echo "SKIPPED: $1"
    [ "$required" = yes ] && exit 1
    exit 0
}
required=no
[ "${1:-}" = "--required" ] && required=yes
command -v python3 >/dev/null || skip "python3 is not installed"
[ -x "$environment/bin/python" ] || python3 -m venv "$environment" >/dev/null 2>&1 || skip "python3 cannot create a virtual environment"
"$environment/bin/pip" install --quiet --disable-pip-version-check 'atif==1.8.*' 'inspect-ai>=0.3.200' 'mcp>=1.9' pandas pyarrow \
    >/dev/null 2>&1 || skip "the packages atif, inspect-ai and mcp cannot be installed"
[ -x "$program" ] || cargo build --quiet
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
NOVAMIND_RUNS="$work/runs" XDG_CONFIG_HOME="$work/config" NOVAMIND="$program" \
    "$environment/bin/python" tests/python/check_exports.py "$work"
NOVAMIND_RUNS="$work/runs" XDG_CONFIG_HOME="$work/config" NOVAMIND="$program" \
    "$environment/bin/python" tests/python/check_scripts.py "$work"
NOVAMIND_RUNS="$work/runs" XDG_CONFIG_HOME="$work/config" NOVAMIND="$program" \
    "$environment/bin/python" tests/python/check_mcp.py
