"""Confidence: the probability that a mapped detection is real and its place right.

A logistic model over a few parts that every placement has. The weights were fitted on rendered scenes of
the calibration family (`bladeatlas-bench scenes --family calibration`), none of which is in the suite that
results are reported on; docs/experiments/confidence.md has the reliability diagram. It is multiplied by how likely
the model itself is right, which a handful of scenes does not fit: `MODEL_RIGHT` is set by hand.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, log

Weights = Mapping[str, float]

MODEL_RIGHT = (1.0, 0.9, 0.5, 0.3)
"""Probability that a model is right by the number of warnings of its checks; the last for that many and more."""


@dataclass(frozen=True)
class Parts:
    """What speaks for and against a place."""

    visible: int
    """Other frames seen by the detector that could see the place."""
    support: int
    """Of these, the ones with a box over it."""
    same_label: int
    """Of these, the ones with the same label."""
    share: float
    """Of the detection's pixels on the chosen patch."""
    cosine: float
    """Of the angle of incidence."""
    lead: float
    """By how much the chosen patch leads over the next one; infinite without another."""
    sparse: float | None
    """Share of sparse points in the box whose depth agrees; None = too few."""
    depth: float | None
    """The same of the depth map."""
    cloud_spacings: float
    """Distance of the place from the fused cloud in point spacings."""
    score: float | None
    """The detector's own."""
    peers: int = 0
    """Further observations of the same defect."""
    offset: float = 0.0
    """Distance from the defect's fused place in radii of the detection's patch."""
    model_warnings: int = 0
    """Warnings of the checks about the model: where it is bent, everything agrees and is wrong together."""

    def features(self) -> dict[str, float]:
        """The numbers that the weights multiply, all of order one."""
        against = self.visible - self.support
        return {
            "constant": 1.0,
            "consensus": log((self.support + 0.5) / (against + 0.5)),
            "support": log(1.0 + self.support),
            "alone": float(self.support == 0 and self.visible > 0),
            "unseen": float(self.visible == 0),
            "label": self.same_label / self.support if self.support else 0.0,
            "share": self.share,
            "cosine": self.cosine,
            "lead": min(self.lead, 0.5),
            "sparse": 0.0 if self.sparse is None else self.sparse - 0.5,
            "depth": 0.0 if self.depth is None else self.depth - 0.5,
            "cloud": min(self.cloud_spacings, 10.0) / 10.0,
            "score": 0.0 if self.score is None else self.score - 0.5,
            "peers": log(1.0 + self.peers),
            "offset": min(self.offset, 3.0),
        }

    def to_dict(self) -> dict[str, float | int | None]:
        """JSON form: finite, rounded."""
        return {
            "views_visible": self.visible,
            "views_support": self.support,
            "views_same_label": self.same_label,
            "pixel_share": round(self.share, 4),
            "cosine": round(self.cosine, 4),
            "lead": None if self.lead == float("inf") else round(self.lead, 4),
            "sparse_agreement": None if self.sparse is None else round(self.sparse, 4),
            "depth_agreement": None if self.depth is None else round(self.depth, 4),
            "cloud_spacings": round(self.cloud_spacings, 3),
            "score": self.score,
            "peers": self.peers,
            "offset": round(self.offset, 4),
            "model_doubts": self.model_warnings,
        }


WEIGHTS: Weights = {
    "constant": -0.939,
    "consensus": 0.957,
    "support": 0.404,
    "alone": -0.294,
    "unseen": -0.136,
    "label": 0.885,
    "share": 0.0,
    "cosine": 0.0,
    "lead": 0.0,
    "sparse": 0.0,
    "depth": 0.821,
    "cloud": 0.0,
    "score": 0.0,
    "peers": 2.146,
    "offset": 0.0,
}


def confidence(parts: Parts, weights: Weights = WEIGHTS) -> float:
    """Probability in [0.01, 0.99] that the detection is real and its place within 10 % of the chord."""
    features = parts.features()
    score = sum(weights[name] * value for name, value in features.items())
    place = 1.0 / (1.0 + exp(-max(-30.0, min(30.0, score))))
    return min(0.99, max(0.01, place * model_right(parts.model_warnings)))


def model_right(warnings: int) -> float:
    """Probability that a model with so many warnings is right."""
    return MODEL_RIGHT[min(warnings, len(MODEL_RIGHT) - 1)]
