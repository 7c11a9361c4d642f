"""What the final bundle adjustment did to a model: one frozen type for each part of it, as `extend` tells them."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum


class LensDecision(StrEnum):
    """What was decided on free parameters of the lens, or why nothing was."""

    KEPT = "kept"
    """The free principal point is used."""
    SIGNIFICANT = "significant"
    """The tracks ask for a radial term."""
    INSIGNIFICANT = "insignificant"
    """The tracks ask for the parameter by no more than their scatter."""
    UNCERTAIN = "uncertain"
    """The tracks do not determine the principal point well."""
    IMPLAUSIBLE = "implausible"
    """The free principal point is too far from its start to be believed."""
    NO_GAIN = "no_gain"
    """The error did not fall by freeing the principal point."""
    OFF = "off"
    """Nobody asked."""
    FEW_IMAGES = "few_images"
    """The model has too few images for a trial."""
    NO_COVARIANCE = "no_covariance"
    """The trial gave no covariance of the lens."""


@dataclass(frozen=True, kw_only=True)
class PrincipalPoint:
    """What freeing the principal point gave."""

    decision: LensDecision
    sigma_px: tuple[float, float] | None = None
    """Posterior standard deviations of cx and cy, scaled by the residuals and by the correlation within tracks."""
    shift_px: tuple[float, float] | None = None
    """From the start to the free estimate."""

    @property
    def refined(self) -> bool:
        """Whether the free estimate is used."""
        return self.decision == LensDecision.KEPT


@dataclass(frozen=True, kw_only=True)
class RadialTerms:
    """How many radial terms the lens keeps, and what the tracks say of each."""

    decision: LensDecision
    number: int
    """How many the lens keeps: 0, 1 or 2."""
    first: float | None = None
    """Deviation of the first from 0 where the second is held at 0 or is not part of the model, in sigmas."""
    second: float | None = None
    """Deviation of the second from 0 beside the first, in sigmas."""


@dataclass(frozen=True, kw_only=True)
class Alignment:
    """What happened to the observations that are not their track's reference."""

    observations: int
    aligned: int
    median_shift_px: float


@dataclass(frozen=True, kw_only=True)
class Trimming:
    """What the choice of tracks did to a model."""

    rounds: int
    kept: int
    """Tracks that the cameras follow from."""
    median_error_px: float
    """Of the better part of the tracks before the last round, and the scale of its loss."""
    focal_before_px: float
    """Before the last turn in which tracks were chosen."""
    focal_after_px: float
    shift: float = field(init=False)
    """Relative change of the focal length by the last choice of tracks."""

    def __post_init__(self) -> None:
        """Derive the shift, which the facts name beside the two focal lengths that it follows from."""
        object.__setattr__(self, "shift", self.focal_after_px / self.focal_before_px - 1.0)


@dataclass(frozen=True, kw_only=True)
class Adjustment:
    """What the final adjustment did, in parts."""

    rounds: int
    stable: bool
    """Whether the last round changed next to nothing."""
    error_before_px: float
    error_after_px: float
    principal_point: PrincipalPoint
    radial_terms: RadialTerms
    alignment: Alignment | None
    """Of the first alignment; None when keypoints stay where they were detected."""
    trimming: Trimming | None
    """None when all tracks have a say."""
