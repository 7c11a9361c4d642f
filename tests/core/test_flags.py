from __future__ import annotations

import pytest

from core.errors import StageFailed
from core.flags import Flag, Severity, between_frames, frames_between, worst


def test_a_flag_survives_the_way_through_json() -> None:
    flag = Flag("bent_model", Severity.ERROR, 3.25, 2.0, "frames 0-60")
    assert Flag.from_dict(flag.to_dict()) == flag
    assert flag.to_dict() == {
        "code": "bent_model",
        "severity": "error",
        "value": 3.25,
        "threshold": 2.0,
        "where": "frames 0-60",
    }


@pytest.mark.parametrize(("code", "severity"), [("never_heard_of", "error"), ("bent_model", "fatal")])
def test_unknown_codes_and_severities_are_refused(code: str, severity: str) -> None:
    with pytest.raises(StageFailed):
        Flag.from_dict({"code": code, "severity": severity})


def test_frames_are_read_from_the_place_that_names_them() -> None:
    assert between_frames(7, 12) == "between frames 7 and 12", "what published results hold"
    assert frames_between(between_frames(7, 12)) == (7, 12)
    assert frames_between(Flag("weak_join", Severity.ERROR, where=between_frames(7, 8)).of_model(2).where) == (7, 8)
    assert frames_between("frames 0-60") is None


def test_worst_orders_by_severity() -> None:
    flags = [
        Flag("few_points", Severity.WARNING),
        Flag("no_parallax", Severity.ERROR),
        Flag("interval_clipped", Severity.INFO),
    ]
    assert worst(flags) == "error"
    assert worst([]) is None
