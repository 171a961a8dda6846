#!/usr/bin/env bash
# Sets up the headless browser that tests/e2e/browser drives; done at once where there is one.
# Usage: bash scripts/browser.sh [PYTHON]    PYTHON is one that has Playwright (default: python3)
#
# Where apt-get is at hand and allowed, it installs the distribution's Chromium. Elsewhere, and
# where that one does not start, Playwright downloads its own, into the user's cache folder.
set -euo pipefail
python="${1:-python3}"

works() {
    chromium --version || chromium-browser --version
} >/dev/null 2>&1

works && exit

as_root=()
[ "$(id -u)" = 0 ] || as_root=(sudo -n)
if command -v apt-get >/dev/null && "${as_root[@]}" true 2>/dev/null; then
    install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
        apt-get install --yes --no-install-recommends chromium fonts-dejavu-core)
    echo "installing the distribution's chromium" >&2
    "${install[@]}" >/dev/null 2>&1 ||
        { "${as_root[@]}" apt-get update && "${install[@]}"; } >/dev/null 2>&1 || true
    works && exit
    # It needs libraries of the system too.
    exec "$python" -m playwright install --only-shell --with-deps chromium
fi
exec "$python" -m playwright install --only-shell chromium
