"""Python packages that carry packs, as an installer leaves them on the disk."""

from __future__ import annotations

from pathlib import Path

LEVEL = "version: 1\nsize: [4, 3]\n"


def write(path: Path, text: str = LEVEL) -> Path:
    """Write a file, and the folders around it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8")
    return path


def carry(
    site: Path,
    module: str,
    entries: str,
    code: str = "",
    is_namespace: bool = False,
    is_there: bool = True,
) -> None:
    """Write what an installed package consists of whose entry points are lines of `entries`.

    Args:
        site: the folder from which it is imported.
        module: its import path. Metadata stand under the name of the whole path.
        entries: lines `name = value`.
        code: what its modules do when they are run.
        is_namespace: whether the outermost package has no `__init__.py`.
        is_there: whether there are packages at all, or only metadata.
    """
    parts = module.split(".")
    for depth in range(is_namespace + 1, len(parts) + 1) if is_there else ():
        write(site.joinpath(*parts[:depth], "__init__.py"), code)
    info = site / f"{module.replace('.', '_')}-1.0.dist-info"
    write(info / "METADATA", f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
    write(info / "entry_points.txt", f"[babyrobot_levels.packs]\n{entries}\n")
