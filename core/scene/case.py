"""The cases of the window search, and the rows of ``cases.csv``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class CaseKind(StrEnum):
    """Which pass of the search a case belongs to; also the name of its stage."""

    COARSE = "coarse"
    REFINE = "refine"


class CaseStatus(StrEnum):
    """How a case ended."""

    SUCCEEDED = "succeeded"
    NO_MODEL = "no_model"
    """It came to its end without a model, which is an outcome."""
    FAILED = "failed"


class StartMode(StrEnum):
    """What the mapping of a case started from."""

    SCRATCH = "scratch"
    WARM = "warm"
    """The model of another case."""
    WARM_THEN_SCRATCH = "warm_then_scratch"
    """A warm start was tried and was worse."""


class CaseReason(StrEnum):
    """Why a case came to its end without a model."""

    TOO_FEW_FRAMES = "too_few_frames"
    TOO_FEW_MATCHES = "too_few_matches"
    NO_PARALLAX = "no_parallax"
    NO_INITIAL_PAIR = "no_initial_pair"


@dataclass(frozen=True)
class CaseRow:
    """One row of ``cases.csv``; the fields are its columns, in order."""

    name: str
    """The thesis's name, e.g. ``seg_000_0000_0180``."""
    kind: CaseKind
    """Pass of the search."""
    start: int
    """First frame of its window."""
    end: int
    """One behind the last."""
    status: CaseStatus
    """How it ended."""
    reason: str | None
    """A `CaseReason`, of a case that failed the code of its error; None when it succeeded."""
    frames: int
    """Frames offered to the mapper."""
    models: int
    """Models that the mapper made; the best of them counts."""
    registered_images: int
    """Images of the best model; 0 without one."""
    points3D: int  # noqa: N815  (COLMAP's name, and the column's)
    """3D points of the best model."""
    mean_reprojection_error_px: float | None
    """Over the observations of the best model; None for a case that failed."""
    median_reprojection_error_px: float | None
    """The same, median."""
    seconds: float | None
    """Time that its task took; None while it is not known."""
    start_mode: StartMode | None
    """None for a case that failed."""
    selected: int
    """1 for the case whose model went on, else 0."""
    vetoed: int
    """1 for a case whose model a check speaks against, else 0."""

    @property
    def score(self) -> tuple[int, int]:
        """S(M) = (registered images, 3D points), compared in this order (thesis 3.3.3)."""
        return self.registered_images, self.points3D

    @property
    def succeeded(self) -> bool:
        """Whether it has a model."""
        return self.status == CaseStatus.SUCCEEDED

    def to_dict(self) -> dict[str, Any]:
        """Flat JSON form, keys in the order of the columns."""
        return asdict(self)

    @classmethod
    def from_facts(cls, facts: Mapping[str, Any], *, seconds: float | None, selected: bool) -> CaseRow:
        """From the facts of the case's task; ValueError for a word that is not known."""
        mode = facts.get("start_mode")
        return cls(
            name=str(facts["name"]),
            kind=CaseKind(facts["kind"]),
            start=facts["start"],
            end=facts["end"],
            status=CaseStatus(facts["status"]),
            reason=facts["reason"] or None,
            frames=facts["frames"],
            models=facts["models"],
            registered_images=facts["registered_images"],
            points3D=facts["points3D"],
            mean_reprojection_error_px=facts["mean_reprojection_error_px"],
            median_reprojection_error_px=facts["median_reprojection_error_px"],
            seconds=seconds,
            start_mode=None if mode is None else StartMode(mode),
            selected=int(selected),
            vetoed=int(bool(facts.get("vetoed"))),
        )


CASE_COLUMNS: tuple[str, ...] = tuple(CaseRow.__dataclass_fields__)
"""Columns of ``cases.csv``."""
