"""CSS colours: the forms that a level may use. Nothing else gets into a picture."""

from __future__ import annotations

from typing import Annotated

from pydantic import StrictStr, StringConstraints

_NAMES = """
aliceblue antiquewhite aqua aquamarine azure beige bisque black blanchedalmond blue blueviolet
brown burlywood cadetblue chartreuse chocolate coral cornflowerblue cornsilk crimson cyan darkblue
darkcyan darkgoldenrod darkgray darkgreen darkgrey darkkhaki darkmagenta darkolivegreen darkorange
darkorchid darkred darksalmon darkseagreen darkslateblue darkslategray darkslategrey darkturquoise
darkviolet deeppink deepskyblue dimgray dimgrey dodgerblue firebrick floralwhite forestgreen
fuchsia gainsboro ghostwhite gold goldenrod gray green greenyellow grey honeydew hotpink indianred
indigo ivory khaki lavender lavenderblush lawngreen lemonchiffon lightblue lightcoral lightcyan
lightgoldenrodyellow lightgray lightgreen lightgrey lightpink lightsalmon lightseagreen
lightskyblue lightslategray lightslategrey lightsteelblue lightyellow lime limegreen linen magenta
maroon mediumaquamarine mediumblue mediumorchid mediumpurple mediumseagreen mediumslateblue
mediumspringgreen mediumturquoise mediumvioletred midnightblue mintcream mistyrose moccasin
navajowhite navy oldlace olive olivedrab orange orangered orchid palegoldenrod palegreen
paleturquoise palevioletred papayawhip peachpuff peru pink plum powderblue purple rebeccapurple
red rosybrown royalblue saddlebrown salmon sandybrown seagreen seashell sienna silver skyblue
slateblue slategray slategrey snow springgreen steelblue tan teal thistle tomato turquoise violet
wheat white whitesmoke yellow yellowgreen transparent
"""

NAMES = tuple(_NAMES.split())
"""The named colours of CSS."""

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

PATTERN = f"^({'|'.join(NAMES)}|{_FORMS})$"

Color = Annotated[StrictStr, StringConstraints(pattern=PATTERN, max_length=64)]
"""A CSS colour: a name in small letters, `#rgb`, `#rrggbb` (or with alpha), `rgb(…)`, `rgba(…)`,
`hsl(…)`."""
