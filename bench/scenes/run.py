"""Scenes through the command line and scored: one file for each finished score, so that a table can be gone on with."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.accuracy.score import score_result
from bench.kept import Found, kept_or_new, read_found, warnings_of
from bench.scenes.make import make_missing
from bench.scenes.spec import Scene
from core.errors import StageFailed

LIMIT_S = 900.0
"""A run that takes longer is ended and counts as failed."""
PROGRAM = ("core", "cli", "store", "worker")
"""Packages whose code decides what a run finds."""


@dataclass(frozen=True)
class Column:
    """How the scenes are run."""

    name: str
    preset: str
    options: Mapping[str, str]


DEFAULT = Column("default", "default", {})
THESIS = Column("thesis", "thesis", {"matching.method": "auto", "dense.sources": "4"})


@dataclass(frozen=True)
class Bench:
    """Where scenes and scores lie: ``scenes/NAME``, ``results/COLUMN/NAME.json``, ``runs/COLUMN/NAME`` while kept."""

    folder: Path
    keep: bool = False
    """Keep the result folders, to look at or to fit on."""
    reuse: bool = False
    """Go on in a kept result folder: what a change of the program does not touch is not computed again."""

    def score(self, scene: Scene, column: Column) -> Found:
        """The score of a scene, from before when nothing that it depends on has changed."""
        key = f"{scene.digest()[:16]}-{_options_key(column)}-{program_digest()[:16]}"
        source = self.folder / "scenes" / scene.name

        def make() -> Found:
            make_missing(scene, source)
            return {"scene": scene.name, "column": column.name, **self._run(scene, column, source)}

        return kept_or_new(self._path(scene, column), key, make)

    def known(self, scene: Scene, column: Column) -> Found:
        """The last score of a scene, by whatever code; empty when there is none."""
        return read_found(self._path(scene, column))

    def _path(self, scene: Scene, column: Column) -> Path:
        return self.folder / "results" / column.name / f"{scene.name}.json"

    def _run(self, scene: Scene, column: Column, source: Path) -> Found:
        out = self.folder / "runs" / column.name / scene.name
        if not self.reuse:
            shutil.rmtree(out, ignore_errors=True)
        found = run_and_score(source, scene.roi, column, out)
        if not self.keep:
            shutil.rmtree(out)
        return found


def run_and_score(source: Path, roi: Sequence[float], column: Column, out: Path) -> Found:
    """Run a clip with truth through the command line and score what it left.

    Args:
        source: folder of `video.mp4`, `annotations.json` and `truth`.
        roi: as shares of the picture's width and height.
        column: preset and options.
        out: result folder; gone on with when it is there.

    Returns:
        {seconds, exit, verdict, flags, funnel, score}; no time is told where the result folder was there.

    Raises:
        StageFailed: the run left no `quality.json`.
    """
    whole = not out.exists()
    command = [sys.executable, "-m", "cli.main", "run", str(source / "video.mp4"), str(source / "annotations.json")]
    command += ["--out", str(out), "--preset", column.preset, "--roi", ",".join(f"{v:g}" for v in roi)]
    for name, value in column.options.items():
        command += ["--set", f"{name}={value}"]
    began = time.monotonic()
    code, said = _finished(command)
    seconds = time.monotonic() - began
    quality = read_found(out / "quality.json")
    if not quality:
        raise StageFailed(f"the run of {source.name} left no quality.json: {said[-500:]}", where=source.name)
    return {
        "seconds": round(seconds, 1) if whole else None,
        "exit": code,
        "verdict": quality.get("verdict"),
        "flags": warnings_of(quality),
        "funnel": quality.get("funnel"),
        "score": score_result(out, source / "truth"),
    }


def _finished(command: Sequence[str]) -> tuple[int, str]:
    """Exit code and error output; the whole group of processes ends at the limit."""
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        try:
            _, said = process.communicate(timeout=LIMIT_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            _, said = process.communicate()
    return process.returncode, said


def _options_key(column: Column) -> str:
    text = json.dumps([column.preset, sorted(column.options.items())])
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def program_digest() -> str:
    """Hash of the code that runs are made by."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[2]
    for package in PROGRAM:
        for path in sorted((root / package).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
