from __future__ import annotations

import pytest

from core.errors import StageFailed
from core.flags import Flag, Severity, worst


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


def test_worst_orders_by_severity() -> None:
    flags = [
        Flag("few_points", Severity.WARNING),
        Flag("no_parallax", Severity.ERROR),
        Flag("interval_clipped", Severity.INFO),
    ]
    assert worst(flags) == "error"
    assert worst([]) is None
