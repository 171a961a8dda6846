#!/usr/bin/env bash
# A serializer that fails in one branch of a union is dropped without a word by pydantic, Ctrl-C included, and another branch writes the value.
#
# Packages: pydantic 2.14.4
# Tried: 2026-11-28, Python 3.11
# Expected: an exception of a serializer ends `model_dump()`, as it does for a field with one type; KeyboardInterrupt in any case.
# Seen: for a field with a union of types, the exception is taken for "not this type", and the serializer of the other type writes the
#   value: here a text for a number, without a warning. So is a KeyboardInterrupt that comes in the middle.
# Why it matters: unions are what files of levels and configurations are made of ("a number or a name"). Ctrl-C in a long
#   `generate` or `lint` is lost now and then, and a mistake in a serializer becomes wrong data.
# Here: the handler of Ctrl-C notes the signal, and what works asks for it
#   (`test_an_interrupt_that_a_library_drops_ends_the_work_all_the_same` in tests/cli/test_streams.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile pydantic==2.14.4
venv/bin/python - <<'EOF'
import warnings
from typing import Annotated

import pydantic
from pydantic import BaseModel, PlainSerializer

warnings.simplefilter("error")
print("pydantic", pydantic.VERSION)


def interrupted(value):
    raise KeyboardInterrupt


Number = Annotated[int, PlainSerializer(interrupted)]
Name = Annotated[str, PlainSerializer(lambda value: "a name")]


class Plain(BaseModel):
    reward: Number


class Union(BaseModel):
    reward: Number | Name


def dumped(model):
    try:
        return model(reward=1).model_dump()
    except BaseException as error:
        return type(error).__name__


print("a field of one type:", dumped(Plain))
print("expected of a union: the same")
print("seen:", dumped(Union))
assert isinstance(dumped(Plain), str)
assert dumped(Union) == {"reward": "a name"}
EOF
