"""`run_inspection`: the plan with local runners, as the command line calls it."""

from __future__ import annotations

from pathlib import Path

from core.errors import StageFailed
from core.settings import Settings
from worker.outcome import OnEvent, Outcome


def run_inspection(
    video: Path,
    annotations: Path | None,
    out: Path,
    settings: Settings,
    *,
    workers: int | None = None,
    on_event: OnEvent | None = None,
    from_stage: str | None = None,
    force: bool = False,
) -> Outcome:
    """Run or continue one inspection in the folder `out`.

    Args:
        workers: tasks side by side; None = number of cores.
        on_event: called from runner threads, one call at a time.
        from_stage: forget the results of this stage and of all that depend on it.
        force: accept a folder that holds the result of another input.

    Ctrl-C and SIGTERM stop children, release leases and return the state ``interrupted``.

    Raises:
        BadInput: input file missing, unknown stage, folder of another input, or in use by another run.
        DiskFull: the folder cannot be written from the start.
    """
    raise StageFailed("the runner is being installed", where=str(out))
