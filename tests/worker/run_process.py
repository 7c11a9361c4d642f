"""`python -m tests.worker.run_process VIDEO OUT [WORKERS]`: a run in a process of its own, to be killed."""

from __future__ import annotations

import sys
from pathlib import Path

from core.settings import make_settings
from core.videos import Recording
from tests.worker.fake_stages import GRAPH, SMALL
from worker.local_run import run_inspection


def main(video: str, out: str, workers: str = "2") -> int:
    outcome = run_inspection(
        [Recording(Path(video))], Path(out), make_settings(options=SMALL), workers=int(workers), graph=GRAPH
    )
    return {"succeeded": 0, "interrupted": 130}.get(outcome.state, 1)


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
