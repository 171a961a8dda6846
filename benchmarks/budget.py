"""What hostile levels cost: each command, the tools for assistants and the editor, on 62 files.

    python benchmarks/budget.py [--only COMMAND] [--level NAME] [--package FOLDER] [-o FILE]

Each file of `tests/support/worst.py` asks for as much as it can of something. The table has for
each command the most seconds of the processor and the most memory that it took, and for which file.
`--package` measures another checkout, with the libraries of this one. What takes twice as long as
it may, or more than 3 GB, is ended. On a busy machine, seconds of the processor are twice as many.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "tests"))

from support.worst import WORST  # noqa: E402

import babyrobot_levels as brl  # noqa: E402
from babyrobot_levels.extensions.formats.tiled import write_tiled  # noqa: E402
from babyrobot_levels.language.play import PlayFields  # noqa: E402
from babyrobot_levels.text.budget import CHECKED, COMMAND, READ, within  # noqa: E402

MOST_MEMORY = 3_000
"""The megabytes after which a command is ended."""

PAUSE = 0.1
"""Seconds between two looks at the memory of a command."""

LIMITS = {"validate": CHECKED, "lint": READ, "show": READ, "editor, another message": READ}
"""Of the commands that have others than `COMMAND`."""

COMMANDS = {
    "validate": "validate level.yaml",
    "lint": "lint level.yaml",
    "lint --diff": "lint --diff --unsafe-fixes level.yaml",
    "show": "show level.yaml",
    "show --sight": "show level.yaml --sight view",
    "format": "format --diff level.yaml",
    "expect": "expect --diff level.yaml",
    "preview": "preview level.yaml",
    "preview --values": "preview level.yaml --values --policy",
    "preview --visits": "preview level.yaml --visits -o x.svg",
    "preview --rules": "preview level.yaml --rules",
    "preview -o .svg": "preview level.yaml -o x.svg",
    "preview -o .png": "preview level.yaml -o x.png",
    "preview -o .pdf": "preview level.yaml --coordinates -o x.pdf",
    "preview -o .html": "preview level.yaml -o x.html",
    "preview --learn": "preview level.yaml --learn -o x.html",
    "preview --sight": "preview level.yaml --sight view -o x.html",
    "preview -o .gif": "preview level.yaml --policy best -o x.gif",
    "play": "play level.yaml --seed 1",
    "replay": "replay play.brlplay",
    "list": "list",
    "solve": "solve level.yaml",
    "solve --within": "solve level.yaml --within 200",
    "solve --exact": "solve level.yaml --exact",
    "solve --criterion average": "solve level.yaml --criterion average",
    "solve --sight": "solve level.yaml --sight view",
    "score best": "score best level.yaml",
    "score random": "score random level.yaml",
    "score --knowable": "score best level.yaml --knowable",
    "score of plays": "score real.brlplay --level level.yaml",
    "grade": "grade handed-in --course level.yaml",
    "check-plan": "check-plan plan.txt level.yaml",
    "compare": "compare level.yaml other.yaml",
    "diff": "diff level.yaml other.yaml",
    "share": "share level.yaml",
    "share --link": "share level.yaml --link https://example.org/play.html",
    "sheet": "sheet level.yaml -o x.pdf",
    "sheet --key": "sheet level.yaml --key -o x.pdf",
    "import": "import level.tmj",
    "export --to umb": "export level.yaml --to umb -o x.umb",
    "export --to prism": "export level.yaml --to prism",
    "export --to tiled": "export level.yaml --to tiled",
    "export --to minigrid": "export level.yaml --to minigrid",
    "export --to pomdp": "export level.yaml --to pomdp --sight view",
    "export --to sokoban": "export level.yaml --to sokoban",
    "export --to maze-dataset": "export level.yaml --to maze-dataset",
    "resolve": "resolve level.yaml",
    "generate --from": "generate --from level.yaml --count 1 --edits 1 -o made",
    "gallery": "gallery level.yaml -o site --jobs 1",
    "dataset": "dataset level.yaml -o data --jobs 1",
    "pack": "pack zoo -o zoo.brlpack",
    "install": "install zoo.brlpack",
    "course build": "course build zoo -o built",
}
"""The commands that take a level, or a folder with one."""

ASKED = {
    "mcp check": ("check",),
    "mcp solve": ("solve",),
    "mcp preview": ("preview",),
    "mcp metrics": ("metrics",),
    "mcp play_start": ("play_start",),
}
"""The tools for assistants that take a level."""

COURSE = """
name: zoo
version: 1.0.0
description: A level that asks for much.
levels:
- {level: level, points: 1}
"""

TOOL = """
import sys
from contextlib import nullcontext
from babyrobot_levels.extensions.assistants.tools import Tools
from babyrobot_levels.text.errors import BabyRobotError
try:
    from babyrobot_levels.text.budget import COMMAND, within
    limited = within(COMMAND)
except ImportError:
    limited = nullcontext()
try:
    with limited:
        getattr(Tools(), sys.argv[1])(open("level.yaml").read())
except (BabyRobotError, ValueError, ArithmeticError) as error:
    sys.exit(str(error))
"""

EDITOR = """
import json, sys, threading, time
from babyrobot_levels.extensions.editor import protocol
from babyrobot_levels.extensions.editor.session import Session

session, lock = Session("version: 1\\n"), threading.Lock()

def ask(**message):
    reply = protocol.prepare(session, message)
    if reply is None and lock.locked() and hasattr(protocol, "meanwhile"):
        reply = protocol.meanwhile(session, message)
    if reply is None:
        with lock:
            reply = protocol.answer(session, message)
    return reply

def asked_meanwhile(done, waits):
    while not done.wait(0.05):
        began = time.perf_counter()
        ask(do="levels")
        ask(do="state")
        waits.append(time.perf_counter() - began)

waits, done = [], threading.Event()
ask(do="levels")
ask(do="state")
thread = threading.Thread(target=asked_meanwhile, args=(done, waits))
thread.start()
ask(do="text", text=open("level.yaml").read(), revision=session.revision)
ask(do="answers", revision=session.revision)
done.set()
thread.join()
print(f"waited {max(waits, default=0):.2f} s", file=sys.stderr)
"""

MORE = ("editor", "editor, another message")


@dataclass
class Cost:
    """What a command took for a level: seconds, megabytes, status, and the last that it said."""

    seconds: float
    memory: float
    status: int
    said: str


def cost(name: str, folder: Path, package: Path) -> Cost:
    """Run a command in a folder that has `level.yaml`."""
    if name in COMMANDS:
        arguments = ["-m", "babyrobot_levels", *COMMANDS[name].split()]
    elif name in ASKED:
        arguments = ["-c", TOOL, *ASKED[name]]
    else:
        arguments = ["-c", EDITOR]
    most = most_seconds(name)
    variables = {**os.environ, "PYTHONPATH": str(package), "HOME": str(folder), "COLUMNS": "80"}
    with (folder / "said").open("w+") as said:
        process = subprocess.Popen(
            [sys.executable, *arguments],
            cwd=folder,
            env=variables,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (most, most)),
        )
        guard = threading.Thread(target=_end_if_large, args=(process.pid,), daemon=True)
        guard.start()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        lines = [line.strip() for line in said if line.strip()]
    told = next((line for line in lines if "error" in line.lower()), lines[-1] if lines else "")
    seconds = usage.ru_utime + usage.ru_stime
    if name == "editor, another message":
        seconds = float(told.split()[1]) if told.startswith("waited") else most
    return Cost(seconds, usage.ru_maxrss / 1000, process.returncode, told[:300])


def most_seconds(name: str) -> int:
    """Return the seconds of the processor after which a command is ended."""
    limits = COMMAND if name in MORE else LIMITS.get(name, COMMAND)
    return math.ceil(2 * limits.seconds)


def _end_if_large(pid: int) -> None:
    """End a process whose memory grows beyond the most."""
    page = os.sysconf("SC_PAGE_SIZE")
    while True:
        try:
            used = int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * page
            if used > MOST_MEMORY * 1e6:
                os.kill(pid, 9)
        except (OSError, IndexError):
            return
        time.sleep(PAUSE)


def prepare(folder: Path, text: bytes) -> None:
    """Write a level, and what commands take beside it.

    That is one that differs from it in its discount, the folder of a pack, and a long plan; and
    where the level is not too large for them, a map of Tiled, and plays.
    """
    level = folder / "level.yaml"
    level.write_bytes(text)
    other = text.replace(b"version: 1\n", b"version: 1\ndiscount: 0.5\n", 1)
    other = other.replace(b'"version": 1,', b'"version": 1, "discount": 0.5,', 1)
    (folder / "other.yaml").write_bytes(other)
    zoo = folder / "zoo" / "levels"
    zoo.mkdir(parents=True, exist_ok=True)
    (zoo / "level.yaml").write_bytes(text)
    (folder / "zoo" / "pack.yaml").write_text(COURSE)
    (folder / "levels").mkdir(exist_ok=True)
    (folder / "levels" / "level.yaml").write_bytes(text)
    with suppress(brl.BabyRobotError), within(COMMAND):
        read = brl.load(level)
        (folder / "play.brlplay").write_text(play_of(read.share_code()) + "\n")
        (folder / "level.tmj").write_text(write_tiled(read).text)
    robots = max(1, text.count(b'"start": [')) if b'"robots"' in text else 1
    (folder / "plan.txt").write_text("100000w\n" * robots)
    with suppress(brl.BabyRobotError), within(COMMAND):
        (folder / "real.brlplay").write_text(real_play_of(brl.load(level)) + "\n")
        handed_in = folder / "handed-in" / "ada"
        handed_in.mkdir(parents=True, exist_ok=True)
        (handed_in / "real.brlplay").write_bytes((folder / "real.brlplay").read_bytes())


def play_of(code: str, **real: Any) -> str:
    """Return an episode of one step, whose digest is that of no level: it is found out late."""
    fields = {
        "name": None,
        "digest": f"sha256:{0:064}",
        "code": code,
        "action_set": "all",
        "discount": 1,
        "max_steps": None,
        "seed": None,
        "seed_kind": "environment",
        "start": "drawn",
        "states": [0, 0],
        "actions": [0],
        "rewards": [0],
        "return": 0,
        "end": "unfinished",
        "made_by": "a stranger",
    }
    return PlayFields.model_validate({**fields, **real}).to_line()


def real_play_of(level: brl.Level) -> str:
    """Return an episode of one step that can have happened."""
    mdp = level.compile()
    state = int(mdp.start.nonzero()[0][0])
    reward = float(mdp.reward[state, 0, 0])
    real = {
        "digest": level.digest,
        "discount": level.discount,
        "max_steps": level.max_steps,
        "states": [state, int(mdp.next_state[state, 0, 0])],
        "rewards": [reward],
        "return": reward,
        "end": "terminated" if mdp.terminal[state, 0, 0] else "unfinished",
    }
    return play_of(level.share_code(), **real)


def measured(names: list[str], levels: list[str], package: Path) -> Iterator[tuple[str, str, Cost]]:
    """Yield command, level and cost of each pair."""
    for name in names:
        for title in levels:
            with tempfile.TemporaryDirectory() as made:
                folder = Path(made)
                prepare(folder, WORST[title]())
                if name == "install":
                    cost("pack", folder, package)
                yield name, title, cost(name, folder, package)


def main() -> None:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    every = [*COMMANDS, *ASKED, *MORE]
    parser.add_argument("--only", action="append", choices=every)
    parser.add_argument("--level", action="append", choices=[*WORST])
    parser.add_argument("--package", type=Path, default=ROOT)
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    rows: dict[str, list[tuple[str, Cost]]] = {}
    for name, title, each in measured(
        options.only or every, options.level or [*WORST], options.package
    ):
        rows.setdefault(name, []).append((title, each))
        print(
            f"{name:24} {title:40} {each.seconds:6.1f} s {each.memory:6.0f} MB "
            f"{each.status:3} {each.said[:110]}",
            flush=True,
        )
        if options.output is not None:
            with options.output.open("a") as file:
                file.write(json.dumps({"command": name, "level": title, **asdict(each)}) + "\n")
    print("\n| command | seconds | in | megabytes | in | beyond |\n|---|---|---|---|---|---|")
    for name, found in rows.items():
        limits = LIMITS.get(name, COMMAND)
        slowest = max(found, key=lambda pair: pair[1].seconds)
        largest = max(found, key=lambda pair: pair[1].memory)
        beyond = sum(
            each.seconds > limits.seconds or each.memory > limits.megabytes for _, each in found
        )
        print(
            f"| {name} | {_most(slowest[1].seconds, most_seconds(name))} | {slowest[0]} "
            f"| {_most(largest[1].memory, MOST_MEMORY)} | {largest[0]} | {beyond} |"
        )


def _most(value: float, most: float) -> str:
    return (
        f"over {most:,}"
        if value >= 0.99 * most
        else f"{value:,.1f}"
        if value < 100
        else f"{value:,.0f}"
    )


if __name__ == "__main__":
    main()
