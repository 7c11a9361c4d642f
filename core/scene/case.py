"""The cases of the window search, and the rows of ``cases.csv``."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class CaseKind(StrEnum):
    """Which pass of the search a case belongs to; also the name of its stage."""

    COARSE = "coarse"
    REFINE = "refine"
    SECTION = "section"
    """Of the frames between places that a check found wrong, after every other case was rejected."""
    PERSPECTIVE = "perspective"
    """Of a perspective lens, after every case of the fisheye lens was rejected, the parts too."""


REDUCERS = ("reduce_perspective", "reduce_parts", "reduce_refine", "reduce_coarse")
"""Stages that choose among the cases, the one that has the last word first."""

GRAPHS = ("reverify", "prune", "graph")
"""Stages that write a view graph; what follows reads the first of them that is in its plan."""


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


class ConfirmedModel(StrEnum):
    """Which model of the winning case is gone on with."""

    CONFIRMED = "confirmed"
    """The one that was mapped again from scratch."""
    SEARCHED = "searched"
    """The one that the search found."""


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
    """Name of the case: its segment, first and last frame."""
    kind: CaseKind
    """`coarse`, `refine`, `section` or `perspective`."""
    start: int
    """First frame of its window."""
    end: int
    """Frame behind the last one of its window."""
    status: CaseStatus
    """`succeeded`, `no_model` or `failed`."""
    reason: str | None
    """Why it did not succeed, as a code; empty when it did."""
    frames: int
    """Frames of its window."""
    models: int
    """Models found, of which the best stands for the case."""
    registered_images: int
    """Registered images of the best model."""
    points3D: int  # noqa: N815  (COLMAP's name, and the column's)
    """Points of the best model."""
    mean_reprojection_error_px: float | None
    """Mean reprojection error of the best model, in pixels."""
    median_reprojection_error_px: float | None
    """Median reprojection error of the best model, in pixels."""
    seconds: float | None
    """Time that the case took."""
    start_mode: StartMode | None
    """How the case started: `scratch`, `warm` or `warm_then_scratch`."""
    selected: int
    """1 for the case whose model went on, else 0."""
    vetoed: int
    """1 where a check of severity `error` calls the model wrong: it wins only where `model.veto` is off."""

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


CASE_COLUMNS: tuple[str, ...] = tuple(CaseRow.__dataclass_fields__)
"""Columns of ``cases.csv``."""
