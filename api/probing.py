"""Looking into files of strangers: in a process of their own, so that whatever they do to a decoder stays there."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from core.errors import BadInput, ResourceError, error_from_dict
from core.settings import Settings
from store.settings import DeploymentSettings

_ENTRY = "core.intake"
_SIDE_BY_SIDE = 2
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


@dataclass
class Prober:
    """Runs at most a few checks at a time; the others wait their turn."""

    settings: DeploymentSettings
    _turns: asyncio.Semaphore = field(default_factory=lambda: asyncio.Semaphore(_SIDE_BY_SIDE))

    async def check(self, video: Path, annotations: Path | None, settings: Settings) -> None:
        """Return when the input can be used.

        Raises:
            BadInput: what is wrong with it, or that it took more time or memory than an input may.
            ResourceError: the check could not be run.
        """
        question = {
            "video": str(video),
            "annotations": str(annotations) if annotations else None,
            "roi": settings.roi.model_dump(mode="json"),
            "parent": os.getpid(),
            "memory_bytes": self.settings.probe_memory_bytes,
            "seconds": self.settings.probe_seconds,
        }
        async with self._turns:
            found = await self._ask(question)
        if "error" in found:
            raise error_from_dict(found["error"])

    async def _ask(self, question: dict[str, Any]) -> dict[str, Any]:
        # Started by the loop's own thread: the kernel ends the child when the thread that started it ends.
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", _ENTRY),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            env=_environment(),
        )
        try:
            async with asyncio.timeout(self.settings.probe_seconds):
                said, _ = await process.communicate(json.dumps(question).encode())
        except TimeoutError:
            raise BadInput("looking into the video took too long", code="probe_timeout", where="video") from None
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        return _understood(said, process.returncode)


def _understood(said: bytes, code: int | None) -> dict[str, Any]:
    """The child's answer; a child that died did so of its input, unless it never started."""
    if code is not None and code > 0:
        raise ResourceError("the input could not be checked", code="probe_failed", where="video")
    try:
        answer = json.loads(said)
    except ValueError:
        message = "the video made its decoder crash, or needs more memory or time than it may take"
        raise BadInput(message, code="probe_died", where="video") from None
    assert isinstance(answer, dict)  # what `core.intake` prints
    return answer


def _environment() -> dict[str, str]:
    root = str(Path(__file__).resolve().parent.parent)
    known = os.environ.get("PYTHONPATH", "")
    return {**os.environ, **_ONE_THREAD, "PYTHONPATH": f"{root}{os.pathsep}{known}" if known else root}
