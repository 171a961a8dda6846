#!/usr/bin/env bash
# After an exception inside `hold_canvas()`, ipycanvas draws nothing any more, on any canvas.
#
# Packages: ipycanvas 0.14.3
# Tried: 2026-11-28, Python 3.11
# Expected: a context manager that holds drawing back lets go when its block is left, also by an exception or by
#   "interrupt the kernel".
# Seen: what is drawn afterwards, on this and on every other canvas of the kernel, is sent nowhere, and nothing says so. The next block of
#   `hold_canvas()` that ends well sends all at once.
# Why it matters: animations of episodes in notebooks draw inside such blocks, and are interrupted all the time. The cell that fails is
#   not the cell that stays empty.
# Here: levels hold and let go by themselves
#   (`test_what_an_exception_left_unfinished_is_painted_the_next_time` in tests/render/notebook/test_canvas.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile ipycanvas==0.14.3
venv/bin/python - <<'EOF'
from importlib.metadata import version

import ipywidgets
from ipycanvas import Canvas, hold_canvas

print("ipycanvas", version("ipycanvas"))
messages = []
ipywidgets.Widget.send = lambda self, content, buffers=None: messages.append(content)


def sent(canvas):
    before = len(messages)
    canvas.fill_rect(0, 0, 1, 1)
    return len(messages) - before


first, second = Canvas(), Canvas()
usual = [sent(first) > 0, sent(second) > 0]
print("drawing on two canvases sends messages:", usual)
try:
    with hold_canvas():
        first.fill_rect(0, 0, 1, 1)
        raise KeyError("in the middle of an animation")
except KeyError:
    pass
print("expected after an exception in hold_canvas(): [True, True]")
seen = [sent(first) > 0, sent(second) > 0]
print("seen:", seen)
before = len(messages)
with hold_canvas():
    pass
print("messages at the end of an empty block of hold_canvas():", len(messages) - before)
assert usual == [True, True] and seen == [False, False]
assert len(messages) > before
EOF
