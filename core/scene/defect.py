"""Physical defects: the views that see them, the visits that show them, and their records."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass

from core.json_files import JsonObject
from core.scene.on_row import NOT_ON_A_ROW, RowColumns
from core.scene.size import LengthUnit, Size


@dataclass(frozen=True)
class Sighting:
    """One view that could see a place."""

    frame_index: int
    quality: float
    """cos(angle of incidence) / squared distance, relative to the best view of the place, in [0, 1]."""
    at: tuple[float, float] | None = None
    """Where the place appears, normalised on the source frame; None = not asked."""
    detected: bool = False
    """Whether the defect was detected in that frame."""

    def to_dict(self) -> JsonObject:
        """JSON form; the quality with four digits, the place with five."""
        row = {"frame_index": self.frame_index, "quality": round(self.quality, 4), "detected": self.detected}
        if self.at is not None:
            row["x"], row["y"] = (round(value, 5) for value in self.at)
        return row

    @classmethod
    def from_dict(cls, row: JsonObject) -> Sighting:
        """From the JSON form."""
        at = (row["x"], row["y"]) if "x" in row else None
        return cls(row["frame_index"], row["quality"], at, row["detected"])


@dataclass(frozen=True)
class EventRow:
    """One row of ``mapping/timeline.csv``: a visit to a defect. The fields are its columns, in order."""

    event_id: int
    """Number of the event, by its start."""
    defect_id: int
    """Record of defects.json that it is a visit to."""
    label: str
    """Most frequent label of its detections."""
    start_s: float
    """Time of its first detection, in seconds from the first frame of its video."""
    end_s: float
    """Time of its last detection, in seconds from the first frame of its video."""
    n_detections: int
    """Its detections."""
    n_frames: int
    """Frames that show them."""
    x: float
    """First coordinate of the mean place of its detections, in the world frame of the defect's model."""
    y: float
    """Second coordinate of the mean place."""
    z: float
    """Third coordinate of the mean place."""
    radius: float
    """Largest distance of one of its detections from the mean place, in units of the model."""
    confidence: float | None
    """Probability that the defect is real and its place right."""
    video: int = 0
    """Number of the video that shows it, from 0 in the order given."""
    blade: str | None = None
    """Blade that the defect lies on, where the row of blades is known."""

    def to_dict(self) -> JsonObject:
        """Flat JSON form, keys in the order of the columns."""
        return asdict(self)

    @classmethod
    def from_dict(cls, row: JsonObject) -> EventRow:
        """From the JSON form."""
        return cls(**row)


TIMELINE_COLUMNS: tuple[str, ...] = tuple(EventRow.__dataclass_fields__)
"""Columns of ``mapping/timeline.csv``."""


MODEL_UNIT = LengthUnit.MODEL
"""Unit of lengths while no scale is known: that of the model's coordinates."""


@dataclass(frozen=True)
class Extent:
    """Size of a defect."""

    value: float | None
    """None = unknown."""
    unit: str
    sigma: float | None
    """Standard deviation; None for too few detections."""


@dataclass(frozen=True)
class Persistence:
    """In how many of the views that could see a defect it was detected."""

    k: int
    """Frames with a detection."""
    n: int
    """Frames that could show it, those included."""

    @property
    def share(self) -> float:
        """k / n."""
        return self.k / self.n

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return {"k": self.k, "n": self.n, "share": self.share}


@dataclass(frozen=True)
class Confidence:
    """How sure a defect is, and what that is made of."""

    value: float
    parts: JsonObject
    """By name; medians over its observations."""


def least_defects(models: Iterable[int]) -> int:
    """Defects that there are at least, given the model of every record.

    Nothing says how two models lie to each other, so one defect may have a record in each: only those of one model are
    told apart.
    """
    return max(Counter(models).values(), default=0)


_ONLY_BY_CASTING = ("centroid_sigma", "normal", "approximate_detections", "evidence")


@dataclass(frozen=True)
class DefectRecord:
    """One record of ``mapping/defects.json``; the fields are its keys, in order.

    Those with the default None are left out of the file by rules that do not know them.
    """

    id: int
    label: str
    labels: Mapping[str, int]
    """Detections by label."""
    model: int
    centroid: tuple[float, float, float]
    """In the world frame of `model`."""
    extent: Extent | None
    confidence: Confidence | None
    persistence: Persistence
    events: tuple[int, ...]
    detections: tuple[int, ...]
    frames: tuple[Sighting, ...]
    """Registered views that could see it, best first."""
    faces: tuple[int, ...]
    """Of the coloured mesh."""
    blade: str | None = None
    centroid_sigma: float | None = None
    """Standard deviation of the place, scene units."""
    normal: tuple[float, float, float] | None = None
    """Unit normal towards the cameras."""
    approximate_detections: tuple[int, ...] | None = None
    """Detections whose estimated place falls on it."""
    evidence: str | None = None
    """Published path of its picture."""
    size: Size | None = None
    """How large it is on the surface."""
    on_row: RowColumns = NOT_ON_A_ROW
    """Where on its blade it lies."""

    def to_dict(self) -> JsonObject:
        """JSON form, keys in the order that readers know."""
        row: JsonObject = {
            "id": self.id,
            "label": self.label,
            "labels": dict(self.labels),
            "model": self.model,
            "centroid": list(self.centroid),
            "centroid_sigma": self.centroid_sigma,
            "normal": None if self.normal is None else list(self.normal),
            "extent": None if self.extent is None else asdict(self.extent),
            "confidence": None if self.confidence is None else asdict(self.confidence),
            "persistence": self.persistence.to_dict(),
            "events": list(self.events),
            "detections": list(self.detections),
            "approximate_detections": None
            if self.approximate_detections is None
            else list(self.approximate_detections),
            "frames": [sighting.to_dict() for sighting in self.frames],
            "evidence": self.evidence,
            "faces": list(self.faces),
            "blade": self.blade,
        }
        found = {name: value for name, value in row.items() if value is not None or name not in _ONLY_BY_CASTING}
        if self.size is not None:
            found |= self.size.to_dict()
        found |= asdict(self.on_row)
        if self.on_row.root_distance is not None:
            found["length_unit"] = MODEL_UNIT if self.size is None else self.size.unit
        return found

    @classmethod
    def from_dict(cls, row: JsonObject) -> DefectRecord:
        """From the JSON form."""
        confidence, estimated = row["confidence"], row.get("approximate_detections")
        seen = row["persistence"]
        return cls(
            id=row["id"],
            label=row["label"],
            labels=dict(row["labels"]),
            model=row["model"],
            centroid=_three(row["centroid"]),
            extent=None if row["extent"] is None else Extent(**row["extent"]),
            confidence=None if confidence is None else Confidence(**confidence),
            persistence=Persistence(seen["k"], seen["n"]),
            events=tuple(row["events"]),
            detections=tuple(row["detections"]),
            frames=tuple(Sighting.from_dict(one) for one in row["frames"]),
            faces=tuple(row["faces"]),
            blade=row["blade"],
            centroid_sigma=row.get("centroid_sigma"),
            normal=None if row.get("normal") is None else _three(row["normal"]),
            approximate_detections=None if estimated is None else tuple(estimated),
            evidence=row.get("evidence"),
            size=Size.from_dict(row) if "size_sigma" in row else None,
            on_row=RowColumns.from_dict(row),
        )


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = values
    return x, y, z
