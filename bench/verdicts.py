"""`bladeatlas-bench verdicts`: what finished results say of themselves, held against what was right."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.arguments import add_results
from bench.kept import Found, markdown_table, read_found, warnings_of
from bench.scenes.spec import Scene, named
from bench.scenes.suite import FAMILIES
from core.errors import BadInput
from core.flags import Verdict

PLACES_PERCENT = 3.0
"""A model is right whose mapped places are at most this far off (median), percent of the chord."""
CAMERAS_PERCENT = 0.5
"""Where no places are known, one whose cameras are, percent of the path's extent."""
TAIL = 10.0 / 3.0
"""The 95 % may be this many times the limit of the median: 10 % of the chord, from where on a place counts as wrong."""
HEAD = ("result", "verdict", "flags", "frames", "median / 95 %", "is right")


@dataclass(frozen=True)
class Judged:
    """One result: what it says, and how far off it is."""

    name: str
    verdict: str
    flags: Sequence[str]
    """Codes of the flags above `info`."""
    registered: int
    errors_percent: tuple[float, float] | None
    """Median and 95 % of places, of the chord, or of cameras, of the path; None where no truth could be compared."""
    of: str
    """What the errors are percent of."""
    hopeless: bool = False
    """Nobody can reconstruct the clip: refusing it is right."""

    @property
    def right(self) -> bool | None:
        """Whether the model is; None where it cannot be told, as of a result without a model."""
        if self.errors_percent is None:
            return None
        limit = PLACES_PERCENT if self.of == "chord" else CAMERAS_PERCENT
        middle, tail = self.errors_percent
        return middle <= limit and tail <= limit * TAIL


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "folders", type=Path, nargs="*", metavar="DIR", help="folders that `scenes` and `real` have written"
    )
    add_results(parser)


def command(arguments: argparse.Namespace) -> None:
    """Print a row for every result and how often verdict and truth agree."""
    judged = [one for folder in arguments.folders for one in of_bench(folder)]
    judged += [of_result(result, truth) for result, truth in arguments.results]
    if not judged:
        raise BadInput("no result was named", where="DIR")
    print(markdown_table(HEAD, [cells(one) for one in judged]))
    print("\n" + "\n".join(counts(judged)))


def of_bench(folder: Path) -> list[Judged]:
    """The kept scores of `bladeatlas-bench scenes` or `real`, by the order of their names.

    Raises:
        BadInput: the folder holds none.
    """
    paths = sorted((folder / "results").glob("*/*.json"))
    found = [(f"{path.parent.name}/{path.stem}", read_found(path)) for path in paths]
    judged = [_of_found(name, one) for name, one in found if "verdict" in one]
    if not judged:
        raise BadInput(f"{folder} holds no scores of `bladeatlas-bench scenes` or `real`", where="DIR")
    return judged


def of_result(result: Path, truth: Path) -> Judged:
    """One result folder, scored here against a truth folder; `BadInput` where one of them is none."""
    # Imported here so that --help does not load the vision libraries.
    from bench.accuracy.score import score_result
    from bench.accuracy.truth import load_truth

    quality = read_found(result / "quality.json")
    if not quality:
        raise BadInput(f"{result} has no quality.json", where="RESULT")
    score, chord_mm = score_result(result, truth), load_truth(truth).chord
    return Judged(
        name=result.name,
        verdict=str(quality["verdict"]),
        flags=warnings_of(quality),
        registered=int(score["frames"]["registered"]),
        errors_percent=_places(score, chord_mm),
        of="chord",
    )


def _of_found(name: str, found: Found) -> Judged:
    score = found["score"]
    of_cameras = "clip" in found
    scene = None if of_cameras else _scene(found["scene"])
    position = score["position_percent"] if of_cameras else None
    return Judged(
        name=name,
        verdict=str(found["verdict"]),
        flags=found["flags"],
        registered=int(score["registered"] if of_cameras else score["frames"]["registered"]),
        errors_percent=_places(score, sum(scene.chord_mm) / 2) if scene else tuple(position) if position else None,
        of="path" if of_cameras else "chord",
        hopeless=scene is not None and scene.expect == "flagged",
    )


def _scene(name: str) -> Scene:
    known = named([scene for family in FAMILIES.values() for scene in family])
    if name not in known:
        raise BadInput(f"no scene is called {name}", where="DIR")
    return known[name]


def _places(score: Mapping[str, Any], chord_mm: float) -> tuple[float, float] | None:
    """Median and 95 % of the mapped places' distances to the true ones, percent of the chord."""
    place = score["placement"]
    if place["position_median_mm"] is None:
        return None
    return 100.0 * place["position_median_mm"] / chord_mm, 100.0 * place["position_p95_mm"] / chord_mm


def cells(one: Judged) -> list[str]:
    """One row of the table."""
    errors = "-" if one.errors_percent is None else " / ".join(f"{value:.2f}" for value in one.errors_percent)
    right = {True: "yes", False: "**no**", None: "hopeless" if one.hopeless else "-"}[one.right]
    return [
        f"`{one.name}`",
        one.verdict,
        ", ".join(f"`{flag}`" for flag in one.flags),
        str(one.registered),
        errors if one.errors_percent is None else f"{errors} % of the {one.of}",
        right,
    ]


def counts(judged: Iterable[Judged]) -> list[str]:
    """Lines: right models that were called suspect, wrong ones that were not, and what was refused."""
    known = list(judged)
    given = [one for one in known if one.verdict != Verdict.REFUSED]
    right, wrong = [one for one in given if one.right], [one for one in given if one.right is False]
    suspected = [one for one in right if one.verdict == Verdict.SUSPECT]
    trusted = [one for one in wrong if one.verdict == Verdict.OK]
    refused = [one for one in known if one.verdict == Verdict.REFUSED]
    needless = [one for one in refused if one.right]
    share = f" ({100 * len(suspected) / len(right):.0f} %)" if right else ""
    return [
        f"right models: {len(right)}; called suspect: {len(suspected)}{share}{_names(suspected)}",
        f"wrong models: {len(wrong)}; called ok: {len(trusted)}{_names(trusted)}",
        f"refused: {len(refused)}, of them hopeless {sum(one.hopeless for one in refused)}, "
        f"with a model that was right {len(needless)}{_names(needless)}",
    ]


def _names(found: Sequence[Judged]) -> str:
    return ": " + ", ".join(one.name for one in found) if found else ""
