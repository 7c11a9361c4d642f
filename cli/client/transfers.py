"""What is remembered of unfinished uploads, so that another call goes on where one was cut off."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

OnBytes = Callable[[str, int, int], None]
"""Called with a file's name, the bytes done and the bytes in all."""


def no_progress(_name: str, _done: int, _total: int) -> None:
    """Show nothing."""


def cache_folder() -> Path:
    """Where this user's programs keep what can be made again."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "bladeatlas"


class Transfers:
    """Addresses of uploads by server and file; one small file each, so that two calls do not disturb each other."""

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder or cache_folder() / "uploads"

    def find(self, server: str, path: Path) -> str | None:
        """Address of this very file's upload: same path, size and time of change."""
        with suppress(OSError, ValueError, KeyError):
            return str(json.loads(self._state(server, path).read_text(encoding="utf-8"))["url"])
        return None

    def keep(self, server: str, path: Path, url: str) -> None:
        """Remember an upload; a cache that cannot be written only costs sending again."""
        state = self._state(server, path)
        with suppress(OSError):
            state.parent.mkdir(parents=True, exist_ok=True)
            part = state.with_suffix(f".{os.getpid()}")
            part.write_text(json.dumps({"url": url, "file": str(path)}), encoding="utf-8")
            part.replace(state)

    def remove(self, server: str, *paths: Path) -> None:
        """These were used, or are gone from the server."""
        for path in paths:
            with suppress(OSError):
                self._state(server, path).unlink(missing_ok=True)

    def _state(self, server: str, path: Path) -> Path:
        stat = path.stat()
        identity = f"{server}\n{path.resolve()}\n{stat.st_size}\n{stat.st_mtime_ns}"
        return self._folder / f"{hashlib.sha256(identity.encode()).hexdigest()[:32]}.json"
