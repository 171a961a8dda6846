# mypy: disable-error-code="import-not-found,import-untyped"
"""The model checker Storm, asked by `checker.py`. Runs in an environment of its own."""

import json
import sys
import time

import stormpy

PRECISION = "1/1000000"
"""By which share of a value an answer may be wrong: what Storm comes with."""


def main() -> None:
    """Answer questions until there are none."""
    options = stormpy.developer.storage.UmbImportOptions()
    options.build_state_valuations = False
    asked, models = "", []
    for line in sys.stdin:
        question = json.loads(line)
        if question["folder"] != asked:
            asked = question["folder"]
            paths = [f"{asked}/{number}.umb" for number in range(question["count"])]
            models = [stormpy.build_model_from_umb(path, options=options) for path in paths]
        discount = question["discount"]
        text = 'R{"cost"}min=? [F "end"]'
        if discount < 1:
            text = f'R{{"cost"}}min=? [Cdiscount={discount}]'
        (wanted,) = stormpy.parse_properties(text)
        new = (
            stormpy.environments.sound
            if question["engine"] == "sound"
            else stormpy.environments.Environment
        )
        settings = new()
        settings.solver().min_max().precision = stormpy.Rational(
            question.get("precision", PRECISION)
        )
        clock = getattr(time, question.get("clock", "perf_counter"))
        begin = clock()
        try:
            found = [
                stormpy.model_checking(model, wanted, environment=settings) for model in models
            ]
        except RuntimeError as error:
            print(json.dumps({"failed": str(error).splitlines()[0]}), flush=True)
            continue
        seconds = clock() - begin
        values = [
            -float(result.get_value(model.initial_states[0]))
            for result, model in zip(found, models, strict=True)
        ]
        print(json.dumps({"seconds": seconds, "values": values}), flush=True)


if __name__ == "__main__":
    main()
