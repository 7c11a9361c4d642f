"""Products of the search and of the final model: cases, the choice among them, and what was made of the winner."""

from __future__ import annotations

from dataclasses import dataclass, field

from core.flags import Flag
from core.json_files import JsonObject
from core.products.adjustment import Adjustment
from core.products.contract import OMITTED, Product
from core.products.front import CameraProduct, GraphProduct
from core.scene.case import CaseKind, CaseRow, CaseStatus, ConfirmedModel, StartMode


@dataclass(frozen=True, kw_only=True)
class CaseProduct(Product):
    """A case of the search: its row of ``cases.csv`` without what the run says of it, and the checks of its model."""

    name: str
    kind: CaseKind
    start: int
    end: int
    status: CaseStatus
    reason: str
    """Why there is no model, as a code; empty with one."""
    frames: int
    models: int
    registered_images: int
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)
    mean_reprojection_error_px: float | None
    median_reprojection_error_px: float | None
    start_mode: StartMode | None
    checks: tuple[Flag, ...] = ()
    vetoed: int = 0
    """1 where a check of severity `error` rejects its model."""

    def row(self, *, seconds: float | None, selected: bool) -> CaseRow:
        """The row of ``cases.csv``."""
        return CaseRow(
            name=self.name,
            kind=self.kind,
            start=self.start,
            end=self.end,
            status=self.status,
            reason=self.reason or None,
            frames=self.frames,
            models=self.models,
            registered_images=self.registered_images,
            points3D=self.points3D,
            mean_reprojection_error_px=self.mean_reprojection_error_px,
            median_reprojection_error_px=self.median_reprojection_error_px,
            seconds=seconds,
            start_mode=self.start_mode,
            selected=int(selected),
            vetoed=self.vetoed,
        )


@dataclass(frozen=True, kw_only=True)
class Ranked:
    """A case that has a model, in the order of a reducer."""

    name: str
    verified_detections: int | None = field(default=None, metadata=OMITTED)
    """None where detections were not asked for."""
    registered_images: int
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)


@dataclass(frozen=True, kw_only=True)
class ReducerProduct(Product):
    """What every reducer tells."""

    best: str
    """Name of the case that it goes on with; empty where none passed."""


@dataclass(frozen=True, kw_only=True)
class ChoiceProduct(ReducerProduct):
    """The case that a reducer goes on with."""

    start: int
    end: int
    kind: CaseKind
    registered_images: int
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)
    start_mode: StartMode | None
    ranking: tuple[Ranked, ...]
    """Best first."""


@dataclass(frozen=True, kw_only=True)
class RefinedProduct(ChoiceProduct):
    """The choice of `reduce_refine`, which may be of cases that are all rejected."""

    vetoed: bool = False
    """Whether the winner is rejected, which up to 0.2.0 was no choice but an error."""
    codes: str = ""
    """Of the findings of severity `error` of its model, joined."""


@dataclass(frozen=True, kw_only=True)
class PassedProduct(ChoiceProduct):
    """A case that the checks let pass after every earlier one was rejected."""

    flags: tuple[Flag, ...]


@dataclass(frozen=True, kw_only=True)
class NoPartProduct(ReducerProduct):
    """What `reduce_parts` hands on where the checks let no part pass and another lens is tried next: no best case."""

    best: str = ""
    why: str
    """As a sentence without its full stop."""


@dataclass(frozen=True, kw_only=True)
class BestCase(ReducerProduct):
    """The case of any reducer, as far as its task key needs it."""

    kind: CaseKind = CaseKind.COARSE


@dataclass(frozen=True, kw_only=True)
class RankedCases(ReducerProduct):
    """The ranking of a reducer, which one that found nothing does not have."""

    ranking: tuple[Ranked, ...] = ()


@dataclass(frozen=True, kw_only=True)
class PruneProduct(GraphProduct):
    """The view graph without what a rejected model and the triplets speak against."""

    doubted: int
    """Verified pairs taken out."""
    cuts: tuple[tuple[int, int], ...]
    """As (last frame before, first frame after)."""
    parts: tuple[tuple[int, int], ...]
    """Half-open intervals of frames."""


@dataclass(frozen=True, kw_only=True)
class ReverifyProduct(GraphProduct, CameraProduct):
    """The lens of the perspective starts, and counts of the graph that it verifies."""


@dataclass(frozen=True, kw_only=True)
class ConfirmProduct(Product):
    """The model that is gone on with."""

    name: str
    """Of its case."""
    registered_images: int
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)
    mean_reprojection_error_px: float
    median_reprojection_error_px: float
    start_mode: StartMode | None
    kept: ConfirmedModel


@dataclass(frozen=True, kw_only=True)
class ExtendProduct(Product):
    """The final model, and what speaks against it."""

    registered_images: int
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)
    mean_reprojection_error_px: float
    median_reprojection_error_px: float
    track_length: float
    lens_model: str | None = field(default=None, metadata=OMITTED)
    """None in results of 0.2.0 and before, whose lenses are all fisheyes."""
    lens_params: tuple[float, ...] | None = field(default=None, metadata=OMITTED)
    focal_px: float
    principal_point_px: tuple[float, float]
    principal_point_refined: bool
    adjustment: Adjustment | None
    """None without a final adjustment."""
    checks: tuple[Flag, ...]
    joined: tuple[JsonObject, ...]
    """What became of each submodel left over (`core.sparse.joining.Attempt`)."""
    loose_frames: tuple[int, ...]
    """Weakly connected images that were taken off."""


@dataclass(frozen=True, kw_only=True)
class SubmodelsProduct(Product):
    """The further models."""

    n_pieces: int
    registered_images: tuple[int, ...]
    """Of each."""
    registered_first: int
    """Of the run's own model."""
