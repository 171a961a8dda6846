"""How a level looks: themes and display."""

import json
import re
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, StrictStr, StringConstraints, WithJsonSchema
from pydantic_core import PydanticCustomError

from babyrobot_levels.language.base import Flag, Model, Number, Once, form, forms

_KNOWN = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))

NAMED: dict[str, str] = _KNOWN["colors"]
"""The named colours of CSS with their digits: Pillow, which has them, is slow to import."""

NAMES = (*NAMED, "transparent")
"""All names of colours."""

_BYTE = r"(25[0-5]|2[0-4][0-9]|1?[0-9]?[0-9])"
_PERCENT = r"(100|[0-9]?[0-9])%"
_ALPHA = r"(0|1|0?\.[0-9]{1,4}|1\.0)"
_COMMA = r" ?, ?"
_HUE = r"(360|3[0-5][0-9]|[12]?[0-9]?[0-9])"

_FORMS = (
    r"#([0-9a-fA-F]{3}|[0-9a-fA-F]{4}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8})"
    rf"|rgb\( ?{_BYTE}{_COMMA}{_BYTE}{_COMMA}{_BYTE} ?\)"
    rf"|rgba\( ?{_BYTE}{_COMMA}{_BYTE}{_COMMA}{_BYTE}{_COMMA}{_ALPHA} ?\)"
    rf"|hsl\( ?{_HUE}{_COMMA}{_PERCENT}{_COMMA}{_PERCENT} ?\)"
)

FORM_PATTERN = f"^({_FORMS})$"
"""The colours that are not names."""

LONGEST_COLOR = 64
"""The most characters of a colour."""


def is_color(text: str) -> bool:
    """Tell whether a text is a colour, if it is not too long."""
    return text in NAMES or re.fullmatch(_FORMS, text) is not None


def _css_color(text: str) -> str:
    if not is_color(text):
        raise PydanticCustomError("color", "must be a CSS colour")
    return text


COLOR_CHECK = AfterValidator(_css_color)
"""What the type of every field that is a colour has."""

# A `pattern` would be compiled for every field that is a colour.
Color = Annotated[
    StrictStr,
    StringConstraints(max_length=LONGEST_COLOR),
    COLOR_CHECK,
    Once(),
    WithJsonSchema({"type": "string", "format": "color"}),
]
"""A CSS colour: a name in small letters, `#rgb`, `#rrggbb` (or with alpha), `rgb(…)`, `rgba(…)`,
`hsl(…)`."""


Pixels = Annotated[Number, Field(ge=0, le=1000)]
Width = Annotated[Number, Field(ge=0, le=100)]

THEME_NAME = r"^[a-z0-9]+([-_][a-z0-9]+)*$"
ThemeName = Annotated[StrictStr, StringConstraints(pattern=THEME_NAME, max_length=100)]


class Colors(Model):
    """The colours of a theme. Those that are left out are those of the theme `default`."""

    base: Color = "#f4f0e7"
    """The ground."""
    lines: Color = "rgba(110,100,84,0.42)"
    """The dashed lines between the cells."""
    start: Color = "#3d5ab8"
    """The ground of a start."""
    start_text: Color = "#ffffff"
    """The text on a start."""
    exit: Color = "#187a53"
    """The ground of an exit."""
    exit_text: Color = "#ffffff"
    """The text on an exit."""
    border: Color = "#2b3540"
    """The outer wall."""
    walls: Color = "#2b3540"
    """The walls."""
    arrows: Color = "#27357e"
    """Arrows: warps, wind, policies."""
    text_bg: Color = "rgba(43,53,64,0.88)"
    """The ground of a panel."""
    text_fg: Color = "#ffffff"
    """The text of a panel, and texts on the grid."""
    blocked: Color = "#6a7480"
    """Blocked cells."""
    puddle: Color = "#2f88bd"
    """Puddles."""
    robot: Color = "#586370"
    """The robot."""


class Widths(Model):
    """Widths in pixels, for cells of 64 pixels."""

    padding: Width = 2.0
    """The free space around the grid."""
    walls: Width = 4.0
    """The walls."""
    border: Width = 5.0
    """The outer wall."""


class Theme(Model):
    """Colours and widths."""

    colors: Colors = Field(default_factory=cache(Colors.model_construct))
    """The colours."""
    widths: Widths = Field(default_factory=cache(Widths.model_construct))
    """The widths."""

    def with_robot(self, color: str) -> Self:
        """Return the theme with another colour of the robot."""
        return self.model_copy(update={"colors": self.colors.model_copy(update={"robot": color})})


class Panel(Model):
    """A panel beside or below the grid."""

    width: Pixels = 200.0
    """Its width in pixels; of a bottom panel, its height."""
    color: Color | None = None
    """Its ground, if it is not the theme's."""
    text_color: Color | None = None
    """Its text, if it is not the theme's."""


def _panel_form(value: Any) -> str:
    if isinstance(value, dict | Panel):
        return "mapping"
    return "word" if isinstance(value, str) else "number"


PanelLike = Annotated[
    Annotated[Literal["none"], form("word")]
    | Annotated[Pixels, form("number")]
    | Annotated[Panel, form("mapping")],
    forms("`none`, a size in pixels, or a mapping", _panel_form),
]


class Robot(Model):
    """How the robot is shown."""

    show: Flag = True
    """Whether it is shown in pictures of the level alone."""
    speed: Annotated[Number, Field(gt=0, le=100)] = 1.0
    """How fast it glides: 1 is its usual speed."""


class Display(Model):
    """What is shown beside the level itself."""

    compass: Flag = False
    """Whether a compass is drawn."""
    start_text: Flag = True
    """Whether a start is labelled."""
    exit_text: Flag = True
    """Whether an exit is labelled."""
    coordinates: Flag = False
    """Whether each cell shows its coordinates."""
    side_panel: PanelLike = "none"
    """A panel to the right: `none`, a width, or a mapping."""
    bottom_panel: PanelLike = "none"
    """A panel below: `none`, a height, or a mapping."""
    robot: Robot = Field(default_factory=cache(Robot.model_construct))
    """The robot."""


ThemeLike = Annotated[
    Annotated[ThemeName, form("word")] | Annotated[Theme, form("mapping")],
    forms(
        "a theme's name or a mapping",
        lambda value: "mapping" if isinstance(value, dict | Theme) else "word",
    ),
]


def _theme(*, colors: dict[str, str], widths: dict[str, float]) -> Theme:
    # They are valid: to check them at each start would take longer than to check a level.
    return Theme.model_construct(
        colors=Colors.model_construct(None, **colors), widths=Widths.model_construct(None, **widths)
    )


BUILTIN_THEMES: dict[str, Theme] = {
    "default": Theme.model_construct(
        set(), colors=Colors.model_construct(), widths=Widths.model_construct()
    ),
    **{name: _theme(**theme) for name, theme in _KNOWN["themes"].items()},
}
"""The built-in themes: the default and a dark one, four in the colours of PyPI `babyrobot`, one of
high contrast, for projectors, and one for paper, in greys. In all but `babyrobot` and `print`, a
start is blue and an exit green."""
