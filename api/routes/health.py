"""Is the process alive, and can it answer?"""

from __future__ import annotations

import socket
from collections.abc import Callable
from http import HTTPStatus
from typing import Literal
from urllib.parse import urlsplit

from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict, Field
from sqlalchemy import text

from api.limits import require_space
from api.problems import FieldError, Refused, responses
from api.services import Services
from api.state import state_of
from core.confinement import possible_guard

router = APIRouter(tags=["health"])

_BROKER_WAIT_S = 1.0
_PORTS = {"redis": 6379, "rediss": 6379, "amqp": 5672, "amqps": 5671}


class Health(BaseModel):
    """The process answers."""

    model_config = ConfigDict(json_schema_serialization_defaults_required=True)

    status: Literal["ok"] = Field("ok", description="always `ok` when there is an answer at all")


class Readiness(BaseModel):
    """What was checked, and that it works."""

    model_config = ConfigDict(
        json_schema_serialization_defaults_required=True,
        json_schema_extra={
            "example": {
                "status": "ready",
                "checks": {"database": "ok", "artifacts": "ok", "disk": "ok"},
                "children_network": "seccomp",
            }
        },
    )

    status: Literal["ready"] = "ready"
    checks: dict[str, str] = Field(description="each check and its result")
    children_network: str = Field(
        description="what keeps processes of this host that read uploaded files from the network: `seccomp`, "
        "`namespace`, or `none`, because the system allows neither"
    )


@router.get("/healthz", summary="Is the process alive?")
def healthz() -> Health:
    """Answer as long as the process runs."""
    return Health(status="ok")


@router.get("/readyz", summary="Can the service take work?", responses=responses(503))
def readyz(request: Request) -> Readiness:
    """Ask everything that new work needs: database, artifact store, disk, and the broker where there is one."""
    services = state_of(request).services
    checks: dict[str, Callable[[Services], None]] = {"database": _database, "artifacts": _artifacts, "disk": _disk}
    if services.settings.broker_url:
        checks["broker"] = _broker
    failed = [name for name, check in checks.items() if not _passes(check, services)]
    if failed:
        errors = [FieldError(pointer=f"/checks/{name}", detail="does not answer, or has no space") for name in failed]
        detail = f"not ready: {', '.join(failed)}"
        raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "not_ready", detail, errors=errors)
    return Readiness(checks=dict.fromkeys(checks, "ok"), children_network=possible_guard())


def _passes(check: Callable[[Services], None], services: Services) -> bool:
    try:
        check(services)
    except Exception:  # noqa: BLE001 - whatever goes wrong in a check is its result
        return False
    return True


def _database(services: Services) -> None:
    with services.db.read() as session:
        session.execute(text("SELECT 1 FROM inspections LIMIT 1"))


def _artifacts(services: Services) -> None:
    services.artifacts.exists("inputs/none")


def _disk(services: Services) -> None:
    require_space(services)


def _broker(services: Services) -> None:
    parts = urlsplit(services.settings.broker_url)
    port = parts.port or _PORTS.get(parts.scheme, 0)
    socket.create_connection((parts.hostname or "127.0.0.1", port), timeout=_BROKER_WAIT_S).close()
