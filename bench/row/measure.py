"""Rows of true surfaces and of reconstructed results, found anew by this program and scored; finished ones are kept."""

from __future__ import annotations

import hashlib
import shutil
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.accuracy.score import score_row_of
from bench.kept import Found, kept_or_new
from bench.row.cases import Case, Expected
from bench.row.true_result import make_true_result
from bench.scenes.run import program_digest
from core.errors import BadInput
from core.json_files import read_json
from core.outputs import (
    CONFIDENCE,
    DEFECT_SURFACE,
    DEFECTS,
    DETECTIONS,
    FRAMES,
    QUALITY,
    ROW,
    SPARSE,
    SUMMARY,
    SURFACE,
    TIMELINE,
    model_folder,
    model_numbers,
)
from core.row.published import write_row

NEEDED = (SPARSE, SURFACE, DEFECT_SURFACE, CONFIDENCE)
"""Of every model, for its row to be found."""
TABLES = (SUMMARY, QUALITY, FRAMES, DETECTIONS, DEFECTS, TIMELINE)
"""Of the result."""


@dataclass(frozen=True)
class Bench:
    """Where truths, results and scores lie: ``truth/NAME``, ``runs/NAME``, ``scores/NAME.json``."""

    folder: Path

    def of_case(self, case: Case) -> Found:
        """The score of a true surface."""
        truth, run = self.folder / "truth" / case.name, self.folder / "runs" / case.name

        def make() -> Found:
            make_true_result(case, truth, run)
            return {"name": case.name, "of": "true surface", **_found(run, truth, case.expected)}

        digest = hashlib.sha256(repr(case).encode()).hexdigest()[:16]
        return kept_or_new(self.folder / "scores" / f"{case.name}.json", f"{digest}-{_program()}", make)

    def of_result(self, result: Path, truth: Path | None) -> Found:
        """The score of a reconstructed result, which is left as it is.

        Args:
            result: folder of a finished run.
            truth: about its clip; None for a clip that shows no row.

        Raises:
            BadInput: the folder is no result.
        """
        if not (result / SUMMARY).is_file():
            raise BadInput(f"'{result}' has no {SUMMARY}: is it a finished result?", where="RESULT")
        run = self.folder / "runs" / f"result-{result.name}"

        def make() -> Found:
            _copied(result, run)
            expected = None if truth is not None else Expected.UNKNOWN
            return {"name": result.name, "of": "reconstruction", **_found(run, truth, expected)}

        made = (result / SUMMARY).stat().st_mtime_ns
        key = f"{result.resolve()}-{made}-{_program()}"
        return kept_or_new(self.folder / "scores" / f"result-{result.name}.json", key, make)


def _program() -> str:
    return program_digest()[:16]


def _copied(result: Path, run: Path) -> None:
    """Of a published result what its row is found from."""
    shutil.rmtree(run, ignore_errors=True)
    folders = [(model_folder(result, number), model_folder(run, number)) for number in model_numbers(result)]
    pairs = [(source / name, target / name) for source, target in folders for name in NEEDED]
    for source, target in [*pairs, *((result / name, run / name) for name in TABLES)]:
        target.parent.mkdir(parents=True, exist_ok=True)
        for path, copy in ((source, target), (source.with_suffix(".csv"), target.with_suffix(".csv"))):
            if path.is_dir():
                shutil.copytree(path, copy, dirs_exist_ok=True)
            elif path.is_file():
                shutil.copyfile(path, copy)


def _found(run: Path, truth: Path | None, expected: Expected | None) -> Found:
    """What the row of a result's first model is, and how right: {status, reason, expected, seconds, score}.

    Where nothing is expected beforehand the truth says what is: a row where three blades are in view.
    """
    began = time.monotonic()
    write_row(run)
    seconds = time.monotonic() - began
    document: dict[str, Any] = read_json(run / ROW)
    score = None if truth is None else score_row_of(run, truth)
    if expected is None:
        expected = Expected.ROW if score and score["row_expected"] else Expected.UNKNOWN
    return {
        "status": document["status"],
        "reason": document.get("reason"),
        "contrast": document["evidence"]["contrast"],
        "expected": str(expected),
        "seconds": round(seconds, 1),
        "score": score,
    }
