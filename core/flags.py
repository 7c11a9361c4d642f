"""Flags: what a reader must know before trusting a result, from one documented list of codes.

A flag is a small fact. Stages put flags into their facts, the report collects them into `quality.json`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import NotRequired, TypedDict

from core.errors import StageFailed


class Severity(StrEnum):
    """How much a finding matters, the mildest first."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


class Verdict(StrEnum):
    """What the findings on a result mean for it."""

    OK = "ok"
    SUSPECT = "suspect"
    REFUSED = "refused"
    """There is no model that can be trusted."""


SEVERITIES: tuple[Severity, ...] = tuple(Severity)

FLAG_CODES: Mapping[str, str] = {
    "interval_clipped": "the preset's interval reached beyond the video and was cut to it",
    "truncated_video": "the video is damaged; only its decodable part was used",
    "times_repaired": "some frames of the video had no usable time of their own; one was filled in",
    "recording_joined": "the stamps of the video start again: it was joined from recordings, and the times go on",
    "video_stream_chosen": "the file holds several video streams; the one named was read",
    "damaged_pictures": "the decoder complains of some pictures; they give no keypoints",
    "times_made_up": "the file holds no times; they are made from a frame rate",
    "interlaced": "frames consist of two fields; they were deinterlaced (FFmpeg's bwdif), one picture per frame",
    "pixels_not_square": "the video's pixels are not square; its frames were resampled so that they are",
    "annotations_outside_video": "some time keys of the annotations lie outside the video; they have no frame",
    "annotations_partly_read": "the file of annotations holds shapes of kinds that are not read; they are left out",
    "annotation_times_inexact": "some time keys are no exact time of a frame; the nearest or the one shown was taken",
    "annotation_times_ambiguous": "the time keys fit several readings that mean other frames; the first was taken",
    "still_pixels_masked": "parts of the picture never move (burned-in text, dirt on the lens) and give no keypoints",
    "boxes_in_crop_frame": "boxes were scaled to the cropped image, as the thesis does; most places are wrong by it",
    "principal_point_at_crop_centre": "the principal point started at the crop's centre, as the thesis does",
    "picture_jumps": "neighbouring frames share far fewer matches than they should: a jump, perhaps by whole blades",
    "gap_spanned": "pairs beyond the sequence join the frames before a thin or broken stretch with those after it",
    "no_parallax": "the views hardly differ in place (static or only turning camera): no depth can be known",
    "bent_model": "the model's rotations disagree with those measured between pairs of images",
    "parts_after_veto": "every whole model was wrong; the result is a part of one, between the places that did not fit",
    "perspective_after_veto": "every model of a fisheye lens was wrong; the result is that of a perspective lens",
    "weak_join": "the model hangs together by few moving points at one place; its parts may not fit each other",
    "row_irregular": "blades or cameras do not go round evenly: the model is bent or joined wrongly; no row is told",
    "not_static": "typical pairs of images do not fit the model: the scene bends, or the model is wrong",
    "two_motions": "many pairs of images show a motion that is not the model's: something moves on its own",
    "planar_start": "a plane or a turn explains nearly all pairs of images: shape and lens have little hold",
    "few_points": "the model has few 3D points per registered image",
    "coverage_low": "few of the frames are registered in the model",
    "focal_uncertain": "few of the starts tried for the lens end at the focal length that was chosen",
    "lens_unknown": "no two starts tried for the lens agree, or all ran away: mapping began with a common focal length",
    "lens_unsettled": "the focal length still moves with the choice of tracks, or has left what the search for it said",
    "focal_lengths_differ": "the focal lengths across and down the image differ, which square pixels do not allow",
    "focal_implausible": "the focal length found gives a field of view that no borescope has",
    "distortion_implausible": "the lens distortion found folds the image: radius does not grow with angle",
    "high_reprojection_error": "the model fits its keypoints badly",
    "scale_unknown": "a scale was told that this model cannot use; its sizes are in units of the model",
    "scale_disagrees": "scales from several sources differ by more than their uncertainties say",
    "several_models": "several models that could not be joined hold defects: what two of them show is counted twice",
    "incomplete": "a stage after the model did not come to its end; what it and later ones make is missing",
    "no_surface": "there is a model but no surface: nothing has a place on it",
    "nothing_mapped": "the annotations have detections in the video, and none was placed on the surface",
}
"""Every code that can appear, with its meaning. A code that is not here cannot be raised."""


class FlagFields(TypedDict):
    """The form of a flag in facts and in `quality.json`."""

    code: str
    severity: str
    value: NotRequired[float | None]
    threshold: NotRequired[float | None]
    where: NotRequired[str]


@dataclass(frozen=True)
class Flag:
    """One finding of a check.

    `value` was measured and is compared with `threshold` (same unit, that of the check); both are None
    where the finding is not a number. `where` names what is meant, e.g. ``frames 120-180``.
    """

    code: str
    severity: Severity
    value: float | None = None
    threshold: float | None = None
    where: str = ""

    def __post_init__(self) -> None:
        if self.code not in FLAG_CODES or self.severity not in SEVERITIES:
            raise StageFailed(f"unknown flag {self.severity}:{self.code}", where="flags")

    @property
    def meaning(self) -> str:
        """One clause for people."""
        return FLAG_CODES[self.code]

    def of_model(self, number: int) -> Flag:
        """The flag as that of one of several models; that of the first names none."""
        return replace(self, where=f"model {number}, {self.where}") if number else self

    def to_dict(self) -> FlagFields:
        """The form of `quality.json`: code, severity, value, threshold, where; numbers rounded to 6 digits."""
        return {
            "code": self.code,
            "severity": self.severity,
            "value": _rounded(self.value),
            "threshold": _rounded(self.threshold),
            "where": self.where,
        }

    def explained(self) -> dict[str, object]:
        """The form of `to_dict`, and what the code means."""
        return {**self.to_dict(), "meaning": self.meaning}

    @classmethod
    def from_dict(cls, row: FlagFields) -> Flag:
        """Rebuild from `to_dict`; unknown codes and severities raise `StageFailed`."""
        return cls(
            row["code"], _severity(row["severity"]), row.get("value"), row.get("threshold"), row.get("where", "")
        )


_BETWEEN = re.compile(r"between frames (\d+) and (\d+)")


def between_frames(before: int, after: int) -> str:
    """The `where` of a flag on what lies between two frames; `frames_between` reads it back."""
    return f"between frames {before} and {after}"


def frames_between(where: str) -> tuple[int, int] | None:
    """The two frames that the `where` of a published flag names; None where it names another place."""
    found = _BETWEEN.search(where)
    return None if found is None else (int(found[1]), int(found[2]))


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.6g}")


def _severity(value: str) -> Severity:
    try:
        return Severity(value)
    except ValueError:
        raise StageFailed(f"unknown severity {value}", where="flags") from None


def worst(flags: Sequence[Flag]) -> Severity | None:
    """The highest severity among `flags`; None without flags."""
    return max((flag.severity for flag in flags), key=SEVERITIES.index, default=None)


def in_order(flags: Iterable[Flag]) -> list[Flag]:
    """The flags worst first, then by code and place, none twice: of equal ones the first."""
    unique: dict[tuple[str, str], Flag] = {}
    for flag in flags:
        unique.setdefault((flag.code, flag.where), flag)
    return sorted(unique.values(), key=lambda flag: (-SEVERITIES.index(flag.severity), flag.code, flag.where))


def verdict_by(flags: Iterable[Flag]) -> Verdict:
    """The verdict on a result with a model: `suspect` with any warning or error, else `ok`."""
    return Verdict.SUSPECT if any(flag.severity != Severity.INFO for flag in flags) else Verdict.OK


def error_codes(checks: Iterable[Flag]) -> str:
    """Codes of the findings of severity `error` in their published form, sorted and joined: why a model is rejected."""
    return ", ".join(sorted({check.code for check in checks if check.severity == Severity.ERROR}))
