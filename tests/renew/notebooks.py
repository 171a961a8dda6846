"""Run the notebooks from top to bottom and store what they put out.

Usage: PYTHONPATH=tests python -m renew.notebooks [NOTEBOOK…] [--into FOLDER]

Without a name, all of `notebooks/` are run; without a folder, each is written where it was. The
one on JAX needs the extra `jax` in the environment.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import nbformat
from jupyter_client.kernelspec import KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from support.places import ROOT

FOLDER = ROOT / "notebooks"

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
"""A notebook's own metadata: nothing that depends on who ran it."""


def run(path: Path) -> str:
    """Return the text of a notebook with the outputs of a fresh run.

    Raises:
        CellExecutionError: a cell fails.
    """
    notebook = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    # Told no folders, the manager knows only the kernel of the running interpreter.
    kernels = AsyncKernelManager(kernel_spec_manager=KernelSpecManager(kernel_dirs=[]))
    with tempfile.TemporaryDirectory() as empty:
        NotebookClient(
            notebook,
            km=kernels,
            timeout=120,
            record_timing=False,
            coalesce_streams=True,
            resources={"metadata": {"path": empty}},
        ).execute()
    notebook["metadata"] = METADATA
    for cell in notebook["cells"]:
        cell["metadata"] = {}
    text: str = nbformat.writes(notebook)  # type: ignore[no-untyped-call]
    return text + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("notebooks", nargs="*", type=Path, default=sorted(FOLDER.glob("*.ipynb")))
    parser.add_argument("--into", type=Path)
    arguments = parser.parse_args()
    for path in arguments.notebooks:
        text = run(path)
        ((arguments.into or path.parent) / path.name).write_text(text, "utf-8")


if __name__ == "__main__":
    main()
