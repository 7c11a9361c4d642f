"""Which program and engines answer."""

from __future__ import annotations

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field

from core.versions import engine_versions, program_version

router = APIRouter(prefix="/v1", tags=["system"])


class System(BaseModel):
    """Versions of the program and of the engines installed beside it."""

    model_config = ConfigDict(
        json_schema_extra={"example": {"version": "0.1.0", "engines": {"pycolmap": "4.2.1", "torch": "2.13.0"}}}
    )

    version: str = Field(description="version of this program")
    engines: dict[str, str] = Field(description="package and its version, or `not installed`")


@router.get("/system", summary="Versions")
def system() -> System:
    """Read from package metadata; no engine is loaded."""
    return System(version=program_version(), engines=engine_versions())
