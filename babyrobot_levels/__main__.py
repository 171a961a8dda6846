"""`python -m babyrobot_levels` is the command `babyrobot`."""

import sys

from babyrobot_levels.cli.app import main

if __name__ == "__main__":
    if not sys.flags.safe_path:
        # That is the working folder, whose files commands would import as modules of libraries.
        del sys.path[0]
    main()
