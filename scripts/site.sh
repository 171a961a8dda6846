#!/usr/bin/env bash
# Builds the documentation as a web site that needs no server and no network, and as a zip beside it. The editor in it
# needs a web server; npm and pip fetch what it runs on.
# Usage: bash scripts/site.sh [OUTPUT]       the folder; build/site if it is not given
set -euo pipefail
output="$(realpath --canonicalize-missing "${1:-"$(dirname "$0")/../build/site"}")"
cd "$(dirname "$0")/.."
source scripts/venv.sh
make_venv .venv-site
install_into .venv-site --editable . --group site
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
.venv-site/bin/sphinx-build --quiet --fail-on-warning --keep-going --builder html \
    --conf-dir docs --doctree-dir "$work/doctrees" . "$work/site"
cat >"$work/site/index.html" <<'HTML'
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<meta http-equiv="refresh" content="0; url=docs/index.html">
<title>babyrobot-levels</title>
<link rel="icon" href="_static/robot.svg">
<p><a href="docs/index.html">The documentation of babyrobot-levels</a></p>
</html>
HTML
.venv-site/bin/babyrobot gallery gallery --home ../docs/index.html --editor ../editor/ -o "$work/site/gallery"
.venv-site/bin/babyrobot edit --site "$work/site/editor"
mkdir -p "$output"
cp -r "$work/site/." "$output"
.venv-site/bin/python -c 'import shutil, sys; shutil.make_archive(sys.argv[2], "zip", sys.argv[1])' "$work/site" "$output"
echo "$output/index.html"
