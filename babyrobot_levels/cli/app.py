"""The entry point of the command `babyrobot`: streams, signals, and what ends it.

Nothing heavy is imported here before `main` runs, so that Ctrl-C is handled from the beginning.
"""

import contextlib
import gc
import os
import signal
import sys

INTERRUPTED = 130
"""Exit status after Ctrl-C."""


def main() -> None:
    """Run the command line. No input of a user ends in a traceback."""
    _handle_interrupts()
    _prepare_streams()
    # Nothing that a command makes lives in circles for long: looking for them can wait.
    gc.set_threshold(100_000, 50, 50)
    # Levels make many small matrices, over which the threads of BLAS only wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # To find pydantic's plugins, the metadata of every package that is installed would be read.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    try:
        if "_BABYROBOT_COMPLETE" in os.environ:
            from babyrobot_levels.cli.completion import complete

            if complete():
                return
        _run()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    finally:
        # As Python ends, it would look for circles among all that was imported, more than once.
        gc.freeze()


def _run() -> None:
    from babyrobot_levels.cli.commands import app
    from babyrobot_levels.cli.console import FINDINGS, WRONG_CALL, note, width_of
    from babyrobot_levels.cli.meant import argument
    from babyrobot_levels.text import budget
    from babyrobot_levels.text.errors import (
        BabyRobotError,
        LevelError,
        LevelNotFoundError,
        RandomMazeError,
    )
    from babyrobot_levels.text.words import MissingFileError

    budget.call_before_work(end_if_interrupted)
    try:
        app(prog_name="babyrobot")
    except RandomMazeError:
        note("error: the maze of this level is random")
        note("  help: choose one first: babyrobot resolve LEVEL --maze-seed 0")
        sys.exit(FINDINGS)
    except LevelError as error:
        note(error.shown(width_of(sys.stderr)))
        sys.exit(FINDINGS)
    except BabyRobotError as error:
        is_level = isinstance(error, LevelNotFoundError) and error.name == "levels"
        is_folder = is_level and not os.path.isdir("levels")  # noqa: PTH112
        note("error: no folder levels/ here" if is_folder else f"error: {error}")
        help_text = getattr(error, "help", None)
        is_told = getattr(error, "help_text", "") or is_folder
        if isinstance(error, LevelNotFoundError) and not (error.is_file or is_told):
            help_text = argument(error.name, error.what, is_near=bool(error.nearest))
        if help_text:
            note(f"  help: {help_text}")
        sys.exit(WRONG_CALL)
    except OSError as error:
        if isinstance(error, FileNotFoundError) and error.filename:
            note(f"error: {MissingFileError(error.errno, error.strerror, error.filename)}")
        else:
            where = f": {error.filename}" if error.filename else ""
            note(f"error: {error.strerror or error}{where}")
        sys.exit(WRONG_CALL)


_arrived: list[int] = []
"""The signals to end that have come."""


def end_if_interrupted() -> None:
    """End the command if a signal has come, whose exception a library has dropped.

    Some serializers of pydantic take every exception for a value that is not of their type, and
    Python itself drops those that are raised while it calls a finalizer, as those of Numba.
    """
    if _arrived:
        _end(_arrived[0])


def _end(number: int) -> None:
    if number == signal.SIGINT:
        raise KeyboardInterrupt
    sys.exit(128 + number)


def _handle_interrupts() -> None:
    """Have Ctrl-C end the command with status 130 and without a traceback; so other signals.

    Worker processes, which inherit the handler, end at once: only the main process writes files,
    and cleans up after itself.
    """
    process = os.getpid()
    _arrived.clear()

    def interrupt(number: int, frame: object) -> None:
        if os.getpid() != process:
            os._exit(128 + number)
        _arrived.append(number)
        _end(number)

    # Whoever started us without Ctrl-C, as `nohup` does, means it; and only the main thread of a
    # process may set handlers.
    with contextlib.suppress(ValueError):
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)
            if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, interrupt)


def _prepare_streams() -> None:
    """Make sure that there are streams, and that they accept every character.

    What goes to a file or a pipe is the same on every system: UTF-8, as level files and pictures
    are, with LF at the end of lines. `PYTHONIOENCODING` overrides this.
    """
    import io
    from pathlib import Path

    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115
        stream = getattr(sys, name)
        if not isinstance(stream, io.TextIOWrapper):
            continue
        if stream.isatty():
            stream.reconfigure(errors="backslashreplace")
        else:
            encoding = os.environ.get("PYTHONIOENCODING", "").partition(":")[0]
            encoding = encoding or "utf-8"
            stream.reconfigure(encoding=encoding, errors="backslashreplace", newline="\n")


if __name__ == "__main__":
    main()
