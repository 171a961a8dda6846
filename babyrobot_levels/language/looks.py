"""How a level looks: themes and display."""

import re
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, StrictStr, StringConstraints, WithJsonSchema
from pydantic_core import PydanticCustomError

from babyrobot_levels.language.base import Flag, Model, Number, Once, form, forms

_TABLE = """
aliceblue f0f8ff antiquewhite faebd7 aqua 00ffff aquamarine 7fffd4 azure f0ffff beige f5f5dc
bisque ffe4c4 black 000000 blanchedalmond ffebcd blue 0000ff blueviolet 8a2be2 brown a52a2a
burlywood deb887 cadetblue 5f9ea0 chartreuse 7fff00 chocolate d2691e coral ff7f50
cornflowerblue 6495ed cornsilk fff8dc crimson dc143c cyan 00ffff darkblue 00008b darkcyan 008b8b
darkgoldenrod b8860b darkgray a9a9a9 darkgreen 006400 darkgrey a9a9a9 darkkhaki bdb76b
darkmagenta 8b008b darkolivegreen 556b2f darkorange ff8c00 darkorchid 9932cc darkred 8b0000
darksalmon e9967a darkseagreen 8fbc8f darkslateblue 483d8b darkslategray 2f4f4f
darkslategrey 2f4f4f darkturquoise 00ced1 darkviolet 9400d3 deeppink ff1493 deepskyblue 00bfff
dimgray 696969 dimgrey 696969 dodgerblue 1e90ff firebrick b22222 floralwhite fffaf0
forestgreen 228b22 fuchsia ff00ff gainsboro dcdcdc ghostwhite f8f8ff gold ffd700
goldenrod daa520 gray 808080 green 008000 greenyellow adff2f grey 808080 honeydew f0fff0
hotpink ff69b4 indianred cd5c5c indigo 4b0082 ivory fffff0 khaki f0e68c lavender e6e6fa
lavenderblush fff0f5 lawngreen 7cfc00 lemonchiffon fffacd lightblue add8e6 lightcoral f08080
lightcyan e0ffff lightgoldenrodyellow fafad2 lightgray d3d3d3 lightgreen 90ee90 lightgrey d3d3d3
lightpink ffb6c1 lightsalmon ffa07a lightseagreen 20b2aa lightskyblue 87cefa
lightslategray 778899 lightslategrey 778899 lightsteelblue b0c4de lightyellow ffffe0 lime 00ff00
limegreen 32cd32 linen faf0e6 magenta ff00ff maroon 800000 mediumaquamarine 66cdaa
mediumblue 0000cd mediumorchid ba55d3 mediumpurple 9370db mediumseagreen 3cb371
mediumslateblue 7b68ee mediumspringgreen 00fa9a mediumturquoise 48d1cc mediumvioletred c71585
midnightblue 191970 mintcream f5fffa mistyrose ffe4e1 moccasin ffe4b5 navajowhite ffdead
navy 000080 oldlace fdf5e6 olive 808000 olivedrab 6b8e23 orange ffa500 orangered ff4500
orchid da70d6 palegoldenrod eee8aa palegreen 98fb98 paleturquoise afeeee palevioletred db7093
papayawhip ffefd5 peachpuff ffdab9 peru cd853f pink ffc0cb plum dda0dd powderblue b0e0e6
purple 800080 rebeccapurple 663399 red ff0000 rosybrown bc8f8f royalblue 4169e1
saddlebrown 8b4513 salmon fa8072 sandybrown f4a460 seagreen 2e8b57 seashell fff5ee sienna a0522d
silver c0c0c0 skyblue 87ceeb slateblue 6a5acd slategray 708090 slategrey 708090 snow fffafa
springgreen 00ff7f steelblue 4682b4 tan d2b48c teal 008080 thistle d8bfd8 tomato ff6347
turquoise 40e0d0 violet ee82ee wheat f5deb3 white ffffff whitesmoke f5f5f5 yellow ffff00
yellowgreen 9acd32
"""

_WORDS = _TABLE.split()

NAMED = dict(zip(_WORDS[::2], _WORDS[1::2], strict=True))
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

    base: Color = "orange"
    """The ground."""
    lines: Color = "#777777"
    """The dashed lines between the cells."""
    start: Color = "#c61414"
    """The ground of a start."""
    start_text: Color = "#ffffff"
    """The text on a start."""
    exit: Color = "#007200"
    """The ground of an exit."""
    exit_text: Color = "#ffffff"
    """The text on an exit."""
    border: Color = "black"
    """The outer wall."""
    walls: Color = "black"
    """The walls."""
    arrows: Color = "#00008b"
    """Arrows: warps, wind, policies."""
    text_bg: Color = "rgba(60,60,60,0.75)"
    """The ground of a panel."""
    text_fg: Color = "#ffffff"
    """The text of a panel, and texts on the grid."""
    blocked: Color = "#5b4a3f"
    """Blocked cells."""
    puddle: Color = "#1f63b0"
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


def _theme(padding: float, wall_width: float, /, **colors: str) -> Theme:
    # They are valid: to check them at each start would take longer than to check a level.
    widths = Widths.model_construct(padding=padding, walls=wall_width, border=wall_width)
    return Theme.model_construct(colors=Colors.model_construct(None, **colors), widths=widths)


BUILTIN_THEMES: dict[str, Theme] = {
    "default": Theme.model_construct(
        set(), colors=Colors.model_construct(), widths=Widths.model_construct()
    ),
    "black_orange": _theme(
        3.0,
        6.0,
        base="#1e1e1e",
        lines="#707070",
        start="#007acc",
        exit="#e51914",
        border="#cc5500",
        walls="#cc5500",
        arrows="#cccccc",
        text_bg="rgba(40,40,40,0.85)",
        text_fg="#cccccc",
        blocked="#6e6e6e",
        puddle="#3b9ddd",
        robot="#b9c4cf",
    ),
    "blue_green": _theme(
        3.0,
        6.0,
        base="#beb8eb",
        lines="#5e5c6c",
        start="#1b69ae",
        exit="#0b5563",
        border="#5e5c6c",
        walls="#5e5c6c",
        arrows="#0a4d5a",
        text_bg="rgba(40,40,40,0.85)",
        text_fg="#cccccc",
        blocked="#656279",
        puddle="#38699d",
        robot="#4a5568",
    ),
    "green": _theme(
        3.0,
        6.0,
        base="#588157",
        lines="#84a98c",
        start="#d6dfc4",
        start_text="#1f3329",
        exit="#1e3234",
        border="#1f3329",
        walls="#1f3329",
        arrows="#1e3234",
        text_bg="rgba(40,40,40,0.85)",
        text_fg="#cccccc",
        blocked="#1f3323",
        puddle="#bfe3fa",
        robot="#d5dbe1",
    ),
    "high_contrast": _theme(
        4.0,
        7.0,
        base="#000000",
        lines="#7f7f7f",
        start="#ffb000",
        start_text="#000000",
        exit="#00d68f",
        exit_text="#000000",
        border="#8c8c8c",
        walls="#ffffff",
        arrows="#ffff00",
        text_bg="#000000",
        text_fg="#ffffff",
        blocked="#7f7f7f",
        puddle="#5ab0ff",
        robot="#f2f2f2",
    ),
    "print": _theme(
        3.0,
        5.0,
        base="#ffffff",
        lines="#9a9a9a",
        start="#949494",
        start_text="#000000",
        exit="#000000",
        exit_text="#ffffff",
        border="#000000",
        walls="#000000",
        arrows="#000000",
        text_bg="#ffffff",
        text_fg="#000000",
        blocked="#595959",
        puddle="#8e8e8e",
        robot="#4d4d4d",
    ),
}
"""The built-in themes: four in the colours of PyPI `babyrobot`, one of high contrast, for
projectors, and one for paper, in greys."""
