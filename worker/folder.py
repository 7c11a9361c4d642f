"""The folder of a local run: `.bladeatlas/` inside it, one run at a time, one input unless forced."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock, Timeout

from core.errors import BadInput, BladeAtlasError, DiskFull
from core.outputs import OUTPUTS, TABLES

HIDDEN = ".bladeatlas"


@dataclass(frozen=True)
class RunFolder:
    """Where things lie in the output folder of a local run."""

    out: Path

    @property
    def hidden(self) -> Path:
        """This program's own folder."""
        return self.out / HIDDEN

    @property
    def database(self) -> Path:
        """The plan."""
        return self.hidden / "plan.db"

    @property
    def results(self) -> Path:
        """Results by stage and fingerprint."""
        return self.hidden / "results"

    @property
    def logs(self) -> Path:
        """One log per task."""
        return self.hidden / "logs"

    def foreign_files(self) -> list[str]:
        """Names of the contract that are taken; in a folder without a plan, by files of somebody else."""
        names = (*TABLES, *(output.path for output in OUTPUTS))
        return [name for name in names if (self.out / name).exists()]


@contextmanager
def locked(out: Path) -> Iterator[RunFolder]:
    """The folder, made when needed and held against other runs.

    Raises:
        BadInput: it is no folder, may not be written, or another run uses it.
        DiskFull: the disk has no space for it.
    """
    folder = RunFolder(out)
    path = folder.hidden / "lock"
    lock = FileLock(path, blocking=False, fallback_to_soft=False)  # the kernel's: a killed run holds nothing
    try:
        folder.hidden.mkdir(parents=True, exist_ok=True)
        held = lock.acquire()
    except Timeout:
        raise BadInput(f"another run is working in '{out}'", code="folder_in_use", where="--out") from None
    except OSError as error:
        raise _cannot_write(out, error) from None
    with held:
        try:
            path.write_text(str(os.getpid()), encoding="ascii")  # and proves that the disk takes data
        except OSError as error:
            raise _cannot_write(out, error) from None
        yield folder


def _cannot_write(out: Path, error: OSError) -> BladeAtlasError:
    reason = os.strerror(error.errno or 0).lower()
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return DiskFull(f"the output folder '{out}' cannot be written: {reason}", where="--out")
    return BadInput(f"the output folder '{out}' cannot be written: {reason}", code="unwritable_output", where="--out")
