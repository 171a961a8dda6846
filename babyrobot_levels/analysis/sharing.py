"""`share`: a level as one line, a share code or the link to a page that plays it."""

import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.analysis.solver.results import UndefinedReturnError
from babyrobot_levels.language.share_code import encode
from babyrobot_levels.mdp.gridworld import GridWorld, LevelLike, world_of
from babyrobot_levels.render.page import link_fragment, without_panels
from babyrobot_levels.render.page_format import TooLargeError
from babyrobot_levels.text.errors import warn

_NO_BLANKS = re.compile(r"(?!(?!https?:|file:)\w+:/)[^\s#]+")
"""What an address is made of, to which a level is appended behind `#`."""

_HOST = re.compile(r"(?![^/]+\.html?(/|$))(([\w-]+\.)+[\w-]+(:\d+)?|[\w-]+:\d+)(/.*)?")
"""An address without its scheme; a page beside the one that has the link may be `play.html`."""


def share(level: LevelLike, link: str | None = None, *, answers: bool = True) -> str:
    """Return a level as a share code, or as a link, as `babyrobot share` prints it.

    Whatever is left out of a link is told in a warning.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        link: the address of any page that `level.play` or `babyrobot preview` has made: it plays
            the level of the link. None for a share code.
        answers: whether a link knows the solution: values, optimal actions and hints.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the level is not valid, or larger than a level file may be.
        ValueError: the level is too large for a link, or `link` is no address.
    """
    world = world_of(level)
    if link is None:
        return encode(world.to_dict(whole=True))
    if reason := link_fault(link):
        raise ValueError(f"link cannot be {link!r}: {reason}")
    return f"{link}#{fragment_of(world, answers=answers, tell=warn)}"


def link_fault(link: str) -> str | None:
    """Return why an address is none that links can begin with; None if it is one."""
    if not _NO_BLANKS.fullmatch(link):
        return "expected an address of the web, without blanks and `#`"
    return f"browsers take that for a file; write https://{link}" if _HOST.fullmatch(link) else None


def fragment_of(level: GridWorld, *, answers: bool, tell: Callable[[str], None]) -> str:
    """Return the part of a link after its `#`; `tell` is told what it is without.

    Raises:
        TooLargeError: the level is too large for a page, or for a link.
    """
    played = level
    if level.has_random_maze:
        tell("the maze is random: the page plays the one of seed 0 (see `babyrobot resolve`)")
        played = level.with_maze_seed(0)
    without_panels(played)
    # What is too large is told before it is solved.
    fragment, guide = link_fragment(level, played), None
    try:
        guide = guide_of(played) if answers else None
    except UndefinedReturnError as error:
        tell(f"the page shows no optimal moves: {error}")
    if guide is not None:
        for known in (guide, replace(guide, turning=None)):
            with suppress(TooLargeError):
                return link_fragment(level, played, known)
        tell("the page shows no optimal moves: the link would be too long with them")
    return fragment
