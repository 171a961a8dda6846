"""Grade the functions in this folder: what is right, by how much the rest is not, and where first.

python grade.py                     all functions, in all levels
python grade.py value_iteration     one of them
"""

import sys
from pathlib import Path

import babyrobot_levels as brl

if __name__ == "__main__":
    found = brl.grade_functions(Path(__file__).parent, functions=sys.argv[1:] or None)
    print(found)
    sys.exit(0 if all(each.passed for each in found) else 1)
