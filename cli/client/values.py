"""What the service says, typed in the part that this program uses; `raw` is all of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from core.states import InspectionState

ACTIVE = (InspectionState.QUEUED, InspectionState.RUNNING, InspectionState.CANCELLING)
"""States that may still change by themselves."""


@dataclass(frozen=True)
class InspectionInfo:
    """An inspection."""

    id: str
    state: str
    stage: str | None
    progress: float
    eta_s: tuple[float, float] | None
    label: str
    external_id: str
    error: Mapping[str, Any] | None
    etag: str | None
    raw: Mapping[str, Any]

    @property
    def active(self) -> bool:
        """True while it is not over."""
        return self.state in ACTIVE

    @classmethod
    def from_json(cls, data: Mapping[str, Any], etag: str | None = None) -> InspectionInfo:
        """From the resource."""
        eta = data.get("eta_s")
        return cls(
            id=str(data["id"]),
            state=str(data["state"]),
            stage=data.get("stage"),
            progress=float(data.get("progress", 0.0)),
            eta_s=(float(eta[0]), float(eta[1])) if eta else None,
            label=str(data.get("label", "")),
            external_id=str(data.get("external_id", "")),
            error=data.get("error"),
            etag=etag,
            raw=data,
        )


@dataclass(frozen=True)
class ArtifactInfo:
    """One file of an inspection."""

    path: str
    size: int
    """Bytes."""
    sha256: str

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> ArtifactInfo:
        """From an entry of the list."""
        return cls(str(data["path"]), int(data["size"]), str(data["sha256"]))
