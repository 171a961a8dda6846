#!/usr/bin/env bash
# mlcroissant gives texts as bytes, and numbers as numbers.
#
# Packages: mlcroissant 1.1.1
# Tried: 2026-11-28, Python 3.11
# Expected: a field of type `sc:Text` is a text in each record, as one of type `sc:Integer` is a number.
# Seen: `b'first'`. A field that is compared with a text is never equal, without an error.
# Why it matters: data sets of levels and episodes are filtered by names: `record["levels/name"] == "first"` finds nothing.
# Here: docs/datasets.md says so, and the test of what is written decodes what it reads
#   (`test_croissant_describes_what_is_there` in tests/extensions/publish/test_dataset.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile mlcroissant==1.1.1
cat >levels.csv <<'EOF'
name,steps
first,7
second,12
EOF
venv/bin/python -W ignore - <<'EOF'
import hashlib
import json
from importlib.metadata import version
from pathlib import Path

import mlcroissant as mlc
from absl import logging

logging.set_verbosity(logging.ERROR)
print("mlcroissant", version("mlcroissant"))
digest = hashlib.sha256(Path("levels.csv").read_bytes()).hexdigest()
file = mlc.FileObject(
    id="levels.csv", name="levels.csv", content_url="levels.csv", encoding_formats=["text/csv"], sha256=digest
)


def field(name, kind):
    source = mlc.Source(file_object="levels.csv", extract=mlc.Extract(column=name))
    return mlc.Field(id=f"levels/{name}", name=name, data_types=kind, source=source)


fields = [field("name", mlc.DataType.TEXT), field("steps", mlc.DataType.INTEGER)]
described = mlc.Metadata(
    name="levels",
    description="Two levels.",
    license="cc0-1.0",
    url="https://example.org/levels",
    distribution=[file],
    record_sets=[mlc.RecordSet(id="levels", name="levels", fields=fields)],
)
Path("croissant.json").write_text(json.dumps(described.to_json(), default=str))
print("expected of the first record: {'levels/name': 'first', 'levels/steps': 7}")
seen = next(iter(mlc.Dataset(jsonld="croissant.json").records("levels")))
print("seen:", seen)
assert seen == {"levels/name": b"first", "levels/steps": 7}
EOF
