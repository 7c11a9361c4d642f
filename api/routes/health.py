"""Is the process alive, and can it answer?"""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field

from core.settings import PRESET_NAMES, make_settings

router = APIRouter(tags=["health"])


class Health(BaseModel):
    """The process answers."""

    status: Literal["ok"] = Field("ok", description="always `ok` when there is an answer at all")


class Readiness(BaseModel):
    """What was checked, and that it works."""

    model_config = ConfigDict(json_schema_extra={"example": {"status": "ready", "checks": {"presets": "ok"}}})

    status: Literal["ready"] = "ready"
    checks: dict[str, str] = Field(description="each check and its result")


@router.get("/healthz", summary="Is the process alive?")
def healthz() -> Health:
    """Answer as long as the process runs."""
    return Health(status="ok")


@router.get("/readyz", summary="Can the service answer?")
def readyz() -> Readiness:
    """Build every preset: what the other routes serve depends on nothing else."""
    for preset in PRESET_NAMES:
        make_settings(preset)
    return Readiness(checks={"presets": "ok"})
