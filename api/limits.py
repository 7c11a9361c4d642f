"""What is refused before it hurts those who are served: a full disk, too many jobs."""

from __future__ import annotations

import shutil
from http import HTTPStatus

from api.problems import Refused
from api.services import Services
from core.errors import DiskFull
from store.listing import count_active

_BUSY_RETRY_S = 30


def free_bytes(services: Services) -> int:
    """Free space on the disk of the data folder."""
    return shutil.disk_usage(services.settings.folder("")).free


def require_space(services: Services, more: int = 0) -> None:
    """`DiskFull` (507) when `more` bytes would eat into the reserve that running jobs need."""
    if free_bytes(services) - more < services.settings.reserve_bytes:
        raise DiskFull("the disk has reached its reserve; new work is refused until there is space", where="disk")


def require_capacity(services: Services) -> None:
    """429 when as many inspections are queued or running as the service takes."""
    if count_active(services.db) >= services.settings.max_active:
        detail = f"{services.settings.max_active} inspections are queued or running already; try again later"
        headers = {"Retry-After": str(_BUSY_RETRY_S)}
        raise Refused(HTTPStatus.TOO_MANY_REQUESTS, "too_many_active", detail, headers=headers)
