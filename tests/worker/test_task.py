"""What an error in a stage becomes at the border of its process."""

from __future__ import annotations

import errno
import subprocess
import sys
from pathlib import Path

import pytest

from core.errors import BadInput, StageFailed, error_from_dict
from worker.task import describe

_LIMITS = {"address_bytes": 3 << 30}


def raised(error: BaseException, cause: BaseException | None = None) -> BaseException:
    try:
        raise error from cause
    except type(error) as caught:
        return caught


@pytest.mark.parametrize(
    ("error", "kind", "code", "retryable"),
    [
        (BadInput("no video", code="not_a_video"), "BadInput", "not_a_video", False),
        (MemoryError(), "ResourceError", "oom", True),
        (RuntimeError("DefaultCPUAllocator: can't allocate memory"), "ResourceError", "oom", True),
        (raised(RuntimeError("no model"), MemoryError()), "ResourceError", "oom", True),
        (OSError(errno.EFBIG, "File too large"), "StageFailed", "file_too_large", False),
        (OSError(errno.ENOSPC, "full"), "DiskFull", "disk_full", False),
        (OSError(errno.EDQUOT, "quota"), "DiskFull", "disk_full", False),
        (raised(RuntimeError("cannot write"), OSError(errno.EROFS, "x")), "DiskFull", "disk_full", False),
        (FileNotFoundError(errno.ENOENT, "gone"), "BladeAtlasError", "internal", False),
        (ValueError("odd"), "BladeAtlasError", "internal", False),
    ],
)
def test_errors_cross_the_border_by_what_they_mean(
    tmp_path: Path, error: BaseException, kind: str, code: str, retryable: bool
) -> None:
    record = describe(error, "join", tmp_path, _LIMITS)
    assert (record["kind"], record["code"], record["retryable"]) == (kind, code, retryable)
    rebuilt = error_from_dict(record)
    assert (type(rebuilt).__name__, rebuilt.code) == (kind, code)


def test_any_error_on_a_full_disk_is_the_full_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worker.task.disk_is_full", lambda _folder: True)
    assert describe(StageFailed("could not read model"), "join", tmp_path, _LIMITS)["code"] == "disk_full"


def test_the_process_of_a_task_starts_without_database_and_log() -> None:
    """A run has hundreds of them: half a second of each went to what only the runner needs."""
    asked = "import sys, worker.task; print([m for m in ('sqlalchemy', 'structlog', 'celery') if m in sys.modules])"
    said = subprocess.run([sys.executable, "-c", asked], check=True, capture_output=True, text=True)
    assert said.stdout.strip() == "[]"
