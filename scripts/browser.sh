#!/usr/bin/env bash
# Sets up the headless browsers that tests/e2e/browser drives; done at once where they are there.
# Usage: bash scripts/browser.sh [PYTHON]    PYTHON is one that has Playwright (default: python3)
#
# Where apt-get is at hand and allowed, it installs the distribution's Chromium and Firefox. Elsewhere,
# and where its Chromium does not start, Playwright downloads one, into the user's cache folder;
# Firefox is the one that the system has, 129 or later.
set -euo pipefail
python="${1:-python3}"

has_chromium() {
    chromium --version || chromium-browser --version
} >/dev/null 2>&1
has_firefox() {
    firefox-esr --version || firefox --version
} >/dev/null 2>&1

as_root=()
[ "$(id -u)" = 0 ] || as_root=(sudo -n)
has_apt() {
    command -v apt-get && "${as_root[@]}" true
} >/dev/null 2>&1
install() {
    local call=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends "$@")
    echo "installing the distribution's $1" >&2
    { "${call[@]}" || { "${as_root[@]}" apt-get update && "${call[@]}"; }; } >/dev/null 2>&1 || true
}

if ! has_firefox; then
    ! has_apt || install firefox-esr fonts-dejavu-core
    has_firefox || echo "Firefox is missing: its tests will fail; https://www.mozilla.org/firefox has it" >&2
fi
has_chromium && exit
if has_apt; then
    install chromium fonts-dejavu-core
    has_chromium && exit
    # It needs libraries of the system too.
    exec "$python" -m playwright install --only-shell --with-deps chromium
fi
exec "$python" -m playwright install --only-shell chromium
