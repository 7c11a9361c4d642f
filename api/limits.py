"""What is refused before it hurts those who are served: a full disk. Other limits are `store.admission`'s."""

from __future__ import annotations

import shutil

from api.services import Services
from core.errors import DiskFull


def free_bytes(services: Services) -> int:
    """Free space on the disk of the data folder."""
    return shutil.disk_usage(services.settings.folder("")).free


def require_space(services: Services) -> None:
    """`DiskFull` (507) when the disk has reached the reserve that running jobs need."""
    if free_bytes(services) < services.settings.reserve_bytes:
        raise DiskFull("the disk has reached its reserve; new work is refused until there is space", where="disk")
