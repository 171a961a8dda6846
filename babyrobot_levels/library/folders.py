"""Where the user's own levels and packs are kept."""

from __future__ import annotations

from pathlib import Path


def user_folder() -> Path:
    """Return the user's own folder for levels and packs, which need not be there."""
    from platformdirs import user_data_path

    return user_data_path("babyrobot-levels", appauthor=False)
