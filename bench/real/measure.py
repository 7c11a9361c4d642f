"""Product and peer on a clip, each as a process whose time is told; finished scores are kept and gone on with."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import psutil
import pycolmap

from bench.kept import Found, kept_or_new, read_found, warnings_of
from bench.real import peer
from bench.real.clip import Clip, Reference
from bench.real.score import score_peer, score_product
from bench.scenes.run import program_digest
from core.errors import StageFailed
from worker.events import EventKind

LIMIT_S = 3 * 3600.0
"""A run that takes longer is ended and counts as failed."""
PICTURES_FPS = 10.0
"""Told of pictures, which hold no times. KITTI's are taken at this rate; of the others none is known."""
LAST_SPARSE = "extend"
"""Stage of a run after which its sparse model is final."""


@dataclass(frozen=True)
class Ended:
    """How a process ended and what it used, with all that it started."""

    code: int
    cpu_s: float
    mark_cpu_s: float | None
    """Processor seconds when it printed the line that was waited for; None when it never did."""
    said: str
    """The end of its error output."""


def run_and_time(command: Sequence[str], log: Path, mark: Mapping[str, str], limit_s: float = LIMIT_S) -> Ended:
    """Run a command that may print JSON lines; the whole group of processes ends at the limit.

    Args:
        command: program and arguments.
        log: gets its error output.
        mark: fields of the JSON line at which the processor time is read.
        limit_s: in seconds of the clock.
    """
    marked: float | None = None
    with (
        log.open("w", encoding="utf-8") as errors,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True, start_new_session=True) as process,
    ):
        timer = threading.Timer(limit_s, os.killpg, (process.pid, signal.SIGKILL))
        timer.start()
        try:
            for line in process.stdout or ():
                if marked is None and mark and _shows(line, mark):
                    marked = _cpu_of_tree(process.pid)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            raise
        finally:
            # Popen's own wait does not tell what was used.
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            timer.cancel()
    said = log.read_text(encoding="utf-8", errors="replace")[-500:]
    return Ended(process.returncode, usage.ru_utime + usage.ru_stime, marked, said)


def _shows(line: str, mark: Mapping[str, str]) -> bool:
    try:
        fields = json.loads(line)
    except ValueError:
        return False
    return isinstance(fields, dict) and all(fields.get(name) == value for name, value in mark.items())


def _cpu_of_tree(pid: int) -> float:
    """Processor seconds of a living process, its living descendants, and all that these have waited for."""
    root = psutil.Process(pid)
    total = 0.0
    for process in (root, *root.children(recursive=True)):
        try:
            total += sum(process.cpu_times()[:4])
        except psutil.NoSuchProcess:
            # It ended since; its parent has waited for it or will, and then counts it.
            continue
    return total


@dataclass(frozen=True)
class Bench:
    """Where runs and scores lie: ``runs/SIDE/CLIP`` and ``results/SIDE/CLIP.json``."""

    folder: Path
    options: Mapping[str, str]
    """Set in the product's runs."""

    def peer(self, clip: Clip, reference: Reference) -> Found:
        """Score of COLMAP as a user runs it: {key, clip, cpu_s, score}."""

        def run(out: Path) -> Found:
            command = [sys.executable, "-m", peer.__name__, str(clip.video), str(out)]
            ended = run_and_time(command, out.with_suffix(".log"), {})
            if ended.code != 0:
                raise StageFailed(f"COLMAP failed on {clip.name}: {ended.said}", where=clip.name)
            return {"cpu_s": round(ended.cpu_s, 1), "score": asdict(score_peer(out, clip, reference))}

        return self._known_or("colmap", f"{peer.OVERLAP}-{pycolmap.__version__}", clip, run)

    def product(self, clip: Clip, reference: Reference) -> Found:
        """Score of the product with default options: {key, clip, cpu_s, exit, verdict, flags, score}.

        The time is that up to the final sparse model, or of the whole run where there is none.
        """

        def run(out: Path) -> Found:
            command = [sys.executable, "-m", "cli.main", "run", str(clip.video), "--out", str(out)]
            command += ["--roi", "full", "--json"]
            if clip.video.is_dir():
                command += ["--fps", f"{PICTURES_FPS:g}"]
            for name, value in self.options.items():
                command += ["--set", f"{name}={value}"]
            mark = {"event": str(EventKind.ENDED), "key": LAST_SPARSE}
            ended = run_and_time(command, out.with_suffix(".log"), mark)
            quality = read_found(out / "quality.json")
            if not quality:
                raise StageFailed(f"the run of {clip.name} left no quality.json: {ended.said}", where=clip.name)
            return {
                "cpu_s": round(ended.cpu_s if ended.mark_cpu_s is None else ended.mark_cpu_s, 1),
                "exit": ended.code,
                "verdict": quality.get("verdict"),
                "flags": warnings_of(quality),
                "score": asdict(score_product(out, clip, reference)),
            }

        options = ",".join(f"{name}={value}" for name, value in sorted(self.options.items()))
        side = "product-set" if options else "product"
        return self._known_or(side, f"{options}-{program_digest()[:16]}", clip, run)

    def _known_or(self, side: str, key: str, clip: Clip, run: Callable[[Path], Found]) -> Found:
        """The kept score when its key is the same; a new run otherwise."""

        def make() -> Found:
            out = self.folder / "runs" / side / clip.name
            shutil.rmtree(out, ignore_errors=True)
            out.parent.mkdir(parents=True, exist_ok=True)
            return {"clip": clip.name, **run(out)}

        return kept_or_new(self.folder / "results" / side / f"{clip.name}.json", key, make)
