"""The style that pages and the editor share."""

import re
from importlib.resources import files


def test_old_browsers_have_the_light_colours() -> None:
    style = files("babyrobot_levels.render").joinpath("static", "picture.css").read_text("utf-8")
    light = dict(re.findall(r"(--[\w-]+): light-dark\((#\w+), #\w+\);", style))
    assert light
    assert dict(re.findall(r"(--[\w-]+): (#\w+);", style)) == light
