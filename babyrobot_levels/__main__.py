"""`python -m babyrobot_levels` is the command `babyrobot`."""

from babyrobot_levels.cli.app import main

if __name__ == "__main__":
    main()
