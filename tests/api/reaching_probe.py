"""A probe whose decoder was taken over: it tries to reach the port that its video names, and says what came of it."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from pathlib import Path

from core import intake
from core.errors import BadInput


def _reach(question: intake.Question) -> intake.Answer:
    port = int(Path(question["recordings"][0]["video"]).read_text(encoding="ascii"))
    outcomes = {}
    tries: dict[str, Callable[[], object]] = {
        "port": lambda: socket.create_connection(("127.0.0.1", port), timeout=5).close(),
        "parent": lambda: Path(f"/proc/{os.getppid()}/environ").read_bytes(),
    }
    for name, one in tries.items():
        try:
            one()
            outcomes[name] = "done"
        except OSError as error:
            outcomes[name] = type(error).__name__
    return {"error": BadInput(str(outcomes)).to_dict()}


intake.answer = _reach
intake.main()
