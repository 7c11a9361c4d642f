"""Making sure that local files and names survive a power cut. Loads nothing: every child process imports it."""

from __future__ import annotations

import errno
import os
import shutil
from pathlib import Path

_MIN_FREE_BYTES = 1 << 20
NO_SPACE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)
"""Numbers of errors that say: this disk takes no more."""


def sync_path(path: Path) -> None:
    """Make the content of a file, or the names in a folder, survive a power cut."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def disk_is_full(folder: Path) -> bool:
    """True when what native writers put into this folder may not all have reached the disk.

    They drop what does not fit without a word, so a disk with less than 1 MiB left holds nothing whole.
    """
    return shutil.disk_usage(folder).free < _MIN_FREE_BYTES
