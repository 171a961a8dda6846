#!/usr/bin/env bash
# pytmx lists the layers of a hidden group of Tiled as visible.
#
# Packages: pytmx 3.32
# Tried: 2026-11-28, Python 3.11
# Expected: what Tiled does not show is not among `visible_layers` and `visible_object_groups`.
# Seen: the group itself is left out, its layers are listed, with `visible` 1; their `parent` is the map, not the group, so that
#   nobody can find out. The offset of a group does not move its layers, either.
# Why it matters: authors hide groups of helper objects, alternative starts or solutions. A game that is made of the visible layers
#   has them all.
# Here: what stands in a hidden group is left out, and told
#   (`test_what_is_not_shown_is_left_out_and_told` in tests/extensions/formats/test_tiled.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile pytmx==3.32
cat >map.tmx <<'EOF'
<?xml version="1.0" encoding="UTF-8"?>
<map version="1.10" orientation="orthogonal" renderorder="right-down" width="3" height="3" tilewidth="32"
 tileheight="32" infinite="0" nextlayerid="5" nextobjectid="3">
 <group id="1" name="solution" visible="0">
  <objectgroup id="2" name="way"><object id="1" x="0" y="0" width="32" height="32"/></objectgroup>
 </group>
 <objectgroup id="3" name="hidden itself" visible="0"/>
 <group id="4" name="moved" offsetx="64" offsety="32">
  <objectgroup id="5" name="walls"><object id="2" x="0" y="0" width="32" height="32"/></objectgroup>
 </group>
</map>
EOF
venv/bin/python - <<'EOF'
from importlib.metadata import version

import pytmx

print("pytmx", version("pytmx"))
map = pytmx.TiledMap("map.tmx")
print("expected of the object layers that are visible: ['walls']")
seen = [map.layers[number].name for number in map.visible_object_groups]
print("seen:", seen)
way = map.get_layer_by_name("way")
print("of the layer in the hidden group: visible", way.visible, "parent", type(way.parent).__name__)
walls = map.get_layer_by_name("walls")
print("of the layer in the group that is moved by [64, 32]: offset", [walls.offsetx, walls.offsety])
assert seen == ["way", "walls"]
assert way.visible == 1 and way.parent is map
assert [walls.offsetx, walls.offsety] == [0, 0]
EOF
