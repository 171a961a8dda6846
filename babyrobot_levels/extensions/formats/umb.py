"""Levels in the unified Markov binary format (arXiv 2606.17811): `babyrobot export --to umb`."""

import gzip
import io
import tarfile
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.exact import ROUNDING, denominators
from babyrobot_levels.extensions.formats.conversion import Conversion
from babyrobot_levels.extensions.formats.processes import Process, losses, process_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Floats, Ints
from babyrobot_levels.text.errors import DISTRIBUTION, how_to_install

_FORMAT = {"format-version": 1, "format-revision": 0}
"""Not what umbi says of itself, which changes with its versions: files are always the same."""


def write_umb(level: Level) -> Conversion:
    """Return a level as an archive of the format.

    Raises:
        ImportError: the package umbi is not installed.
    """
    try:
        from umbi.umb.umb_to_tar import UmbEncoder
    except ImportError as error:
        raise ImportError(f"this format needs umbi: {how_to_install('umb')}") from error

    class Encoder(UmbEncoder):  # type: ignore[misc]
        """Writes arrays as they are: umbi packs one number after another. Checks no index twice."""

        def add_index_file(self, umb: Any) -> None:
            self.add_json("index.json", umb.index.to_json())

        def add_vector(self, name: str, kind: Any, vector: Any, optional: bool = False) -> None:
            if isinstance(vector, np.ndarray):
                letter = "f" if vector.dtype.kind == "f" else "u"
                self.add_file(name, vector.astype(f"<{letter}{kind.size_bytes}").tobytes())
            else:
                super().add_vector(name, kind, vector, optional)

        def add_bitvector(self, name: str, vector: Any, optional: bool = False) -> None:
            words = np.zeros(-(-len(vector) // 64) * 64, bool)
            words[: len(vector)] = vector
            self.add_file(name, np.packbits(words, bitorder="little").tobytes())

    process = process_of(level)
    encoder = Encoder()
    encoder.encode(_explicit(level, process), insert_umbi_metadata=False)
    return Conversion("", losses(level, process, "a UMB file"), data=_archive(encoder))


def _archive(files: dict[str, bytes]) -> bytes:
    """Return files as a compressed archive, the same whenever it is written."""
    written = io.BytesIO()
    with tarfile.open(fileobj=written, mode="w") as archive:
        for name, data in files.items():
            entry = tarfile.TarInfo(name)
            entry.size = len(data)
            archive.addfile(entry, io.BytesIO(data))
    return gzip.compress(written.getvalue(), 6, mtime=0)


def _explicit(level: Level, process: Process) -> Any:
    """Return the process as umbi takes it."""
    from umbi.umb import ExplicitUmb
    from umbi.umb.index import UmbIndex

    # Where nothing is to be chosen, there is one choice, of an action without a name.
    names, acting, count = [*process.actions, ""], process.acting, len(process.actions)
    choices = np.ones(process.size + 1, np.int64)
    choices[acting] = count
    first = np.cumsum(choices) - choices
    own = first[acting][:, None] + np.arange(count)
    action, reward = np.full(first[-1], count), np.zeros(first[-1])
    action[own] = np.arange(count)
    chance, unit = denominators(level)
    tables = process.mdp.probability[acting], process.mdp.reward[acting]
    highest = float(np.abs(tables[1]).max(initial=0.0))
    reward[own] = _rounded(np.einsum("sao,sao->sa", *tables), chance * unit, highest)
    choice, target, probability = _branches(process, first)
    moves = action[choice] < count  # What draws a start adds up nothing.
    probability[moves] = _rounded(probability[moves], chance, 1.0)
    annotations: dict[str, dict[str, Any]] = {
        "aps": {name: {"states": has} for name, has in process.labels.items()},
        "rewards": {"reward": {"choices": reward}, "cost": {"choices": -reward}},
    }
    return ExplicitUmb(
        index=UmbIndex.from_json(_index(level, process, annotations, len(action), len(target))),
        state_is_initial=np.arange(process.size) == process.initial,
        state_to_choices=first,
        choice_to_branches=np.append(0, np.cumsum(np.bincount(choice))),
        branch_to_target=target,
        branch_to_probability=probability,
        choice_to_choice_action=action,
        choice_action_to_string=names,
        annotations=annotations,
    )


def _index(
    level: Level, process: Process, annotations: Any, choices: int, branches: int
) -> dict[str, Any]:
    """Return what is in the archive: the level, its size, labels and rewards."""
    double, flag = {"type": "double", "size": 64}, {"type": "bool", "size": 1}
    about = {
        "name": level.title or level.name,
        "description": level.description,
        "authors": [level.author] if level.author else None,
        "comment": "\n".join(filter(None, (level.license, level.source))),
    }
    return {
        **_FORMAT,
        "file-data": {"tool": DISTRIBUTION},
        "model-data": {key: value for key, value in about.items() if value},
        "transition-system": {
            **{"time": "discrete", "#players": 1, "#initial-states": 1, "#observations": 0},
            **{"#states": process.size, "#choices": choices, "#branches": branches},
            **{"#choice-actions": len(process.actions) + 1, "#branch-actions": 0},
            "branch-probability-type": double,
        },
        "annotations": {
            group: {
                name: {"applies-to": [*values], "type": flag if group == "aps" else double}
                for name, values in each.items()
            }
            for group, each in annotations.items()
        },
    }


def _branches(process: Process, first: Ints) -> tuple[Ints, Ints, Floats]:
    """Return the choice, the target and the probability of each branch, ordered by these.

    Args:
        process: the process.
        first: the number of the first choice of each state.
    """
    chances = process.mdp.probability[process.acting]
    happens = chances > 0
    own = first[process.acting][:, None, None] + np.arange(len(process.actions))[:, None]
    starts = [*process.starts]
    resting = np.ones(process.size, bool)
    resting[process.acting] = False
    resting[process.initial] &= not starts
    over = np.flatnonzero(resting)
    draw = np.full(len(starts), first[process.initial])
    choice = np.concatenate([np.broadcast_to(own, chances.shape)[happens], first[over], draw])
    target = np.concatenate([process.next_state[happens], over, starts]).astype(np.int64)
    weight = np.concatenate([chances[happens], np.ones(over.size), [*process.starts.values()]])
    pairs, which = np.unique(choice * process.size + target, return_inverse=True)
    summed: Floats = np.bincount(which, weight).astype(np.float64)
    return *np.divmod(pairs, process.size), summed


def _rounded(sums: Floats, denominator: int, highest: float) -> Floats:
    """Return sums without what adding up has left: the floats of fractions with a denominator.

    Args:
        sums: the sums.
        denominator: of the fractions that their terms stand for.
        highest: the largest of the numbers that were added up.
    """
    if highest * denominator * ROUNDING > 0.25:
        return sums
    rounded: Floats = np.rint(sums * denominator) / denominator
    return rounded
