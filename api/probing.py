"""Looking into files of strangers: in a process of their own, so that whatever they do to a decoder stays there."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from api.turns import Turns
from core.child_environment import child_environment
from core.errors import BadInput, ResourceError, error_from_dict
from core.settings import Settings
from core.video.limits import VideoLimits
from core.videos import Recording
from store.settings import DeploymentSettings

_ENTRY = "core.intake"
_SIDE_BY_SIDE = 2
_SPARE = 1
"""One more for an account of which none is looked into: two videos made to take long may not keep it waiting."""
_TIMEOUT_FACTOR = 3.0
"""The limit is one of processor time; on the clock a busy machine may take so many times as long."""


@dataclass
class Prober:
    """Runs at most a few checks at a time; the others wait their turn, which goes round the owners."""

    settings: DeploymentSettings
    turns: Turns = field(init=False)
    _limits: VideoLimits = field(init=False)

    def __post_init__(self) -> None:
        settings = self.settings
        self._limits = VideoLimits(settings.max_frame_pixels, settings.max_video_frames, settings.max_video_seconds)
        self.turns = Turns(
            _SIDE_BY_SIDE,
            settings.max_probes_waiting,
            settings.max_probes_waiting_per_owner,
            settings.probe_wait_seconds,
            spare=_SPARE,
        )

    async def check(self, owner: str, recordings: Sequence[Recording], settings: Settings) -> None:
        """Return when the input can be used.

        Raises:
            BadInput: what is wrong with it, or that it took more time or memory than an input may.
            ResourceError: the check could not be run, or not in time.
            Refused: 429 or 503, too many wait already, or no turn came in time.
        """
        question = {
            "recordings": [one.to_dict() for one in recordings],
            "annotation_format": settings.input.annotation_format,
            "video_stream": settings.input.video_stream,
            "fps": settings.input.fps,
            "calibration_size": settings.camera.size_px,
            "roi": settings.roi.model_dump(mode="json"),
            "limits": asdict(self._limits),
            "parent": os.getpid(),
            "memory_bytes": self.settings.probe_memory_bytes,
            "seconds": self.settings.probe_seconds,
        }
        async with self.turns.turn(owner):
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
            env=child_environment(threads=1),
        )
        try:
            async with asyncio.timeout(self.settings.probe_seconds * _TIMEOUT_FACTOR):
                said, _ = await process.communicate(json.dumps(question).encode())
        except TimeoutError:
            # Its processor time was not used up: others had it, which is not the video's fault.
            message = "the machine is too busy to look into the video; try again later"
            raise ResourceError(message, code="probe_busy", where="video") from None
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        if process.returncode == -signal.SIGXCPU:
            message = f"looking into the video took more than {self.settings.probe_seconds:g} s (probe_seconds)"
            raise BadInput(message, code="probe_timeout", where="video")
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
