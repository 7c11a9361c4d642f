"""Scores of scenes as a table: one row each, the median scene, and what the targets ask for over all."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isinf
from statistics import median

from bench.kept import Found, markdown_table
from bench.scenes.pooled import right_share
from bench.scenes.spec import Scene
from core.flags import Verdict

HEAD = (
    "scene",
    "verdict",
    "annotated frames registered",
    "mapped",
    "place median / 95 %, % of chord",
    "wrong",
    "right, of all placeable",
    "defects found / split / extra",
    "false boxes confident and lasting",
    "ECE",
    "AUROC",
    "s",
)


def chord_mm(scene: Scene) -> float:
    """Mean of root and tip chord."""
    return sum(scene.chord_mm) / 2


def rows(scenes: Sequence[Scene], found: Sequence[Found]) -> list[list[str]]:
    """Cells of the table without its head."""
    cells = [_row(scene, one) for scene, one in zip(scenes, found, strict=True)]
    return [*cells, _median(scenes, found)] if any(scene.expect == "mapped" for scene in scenes) else cells


def _row(scene: Scene, one: Found) -> list[str]:
    score = one["score"]
    place, defects, confidence = score["placement"], score["defects"], score["confidence"]
    verdict = str(one["verdict"]) + (f" ({', '.join(one['flags'])})" if one["flags"] else "")
    if scene.expect == "flagged":
        verdict += ": as expected" if one["verdict"] != Verdict.OK else ": **not seen**"
    return [
        scene.name,
        verdict,
        _percent(score["frames"]["registered_annotated_share"]),
        f"{_percent(place['mapped_share'])} of {place['placeable']}",
        f"{_of_chord(scene, place['position_median_mm'])} / {_of_chord(scene, place['position_p95_mm'])}",
        _percent(place["wrong_mapped_share"]),
        _percent(right_share(one)),
        f"{defects['found']} of {defects['expected']} / {defects['split']} / {defects['extra']}",
        _percent(place["false_boxes"]["mapped_confident_persistent_share"]),
        _number(confidence["ece"]),
        _number(confidence["auroc"]),
        "-" if one["seconds"] is None else f"{one['seconds']:.0f}",
    ]


def _median(scenes: Sequence[Scene], found: Sequence[Found]) -> list[str]:
    """Of the scenes that can be reconstructed."""
    chosen = [(s, one["score"]) for s, one in zip(scenes, found, strict=True) if s.expect == "mapped"]

    def middle(values: list[float | None]) -> float | None:
        """A scene without a figure is the worst, not none."""
        found = median([inf if value is None else value for value in values])
        return None if isinf(found) else found

    registered = median([score["frames"]["registered_annotated_share"] or 0.0 for _, score in chosen])
    mapped = median([score["placement"]["mapped_share"] or 0.0 for _, score in chosen])
    places = [
        middle([_share(scene, score["placement"][name]) for scene, score in chosen])
        for name in ("position_median_mm", "position_p95_mm")
    ]
    right = median([right_share({"score": score}) for _, score in chosen])
    wrong = middle([score["placement"]["wrong_mapped_share"] for _, score in chosen])
    expected = sum(score["defects"]["expected"] for _, score in chosen)
    sums = [sum(score["defects"][name] for _, score in chosen) for name in ("found", "split", "extra")]
    return [
        "**median scene**",
        "",
        _percent(registered),
        _percent(mapped),
        " / ".join("-" if value is None else f"{100 * value:.1f}" for value in places),
        _percent(wrong),
        _percent(right),
        f"{sums[0]} of {expected} / {sums[1]} / {sums[2]} in all",
        "",
        "",
        "",
        f"{sum(one['seconds'] or 0 for one in found) / 60:.0f} min",
    ]


def markdown(scenes: Sequence[Scene], found: Sequence[Found]) -> str:
    """The table as text."""
    return markdown_table(HEAD, rows(scenes, found))


def _share(scene: Scene, value: float | None) -> float | None:
    return None if value is None else value / chord_mm(scene)


def _of_chord(scene: Scene, value: float | None) -> str:
    return "-" if value is None else f"{100 * value / chord_mm(scene):.1f}"


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.1f} %"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"
