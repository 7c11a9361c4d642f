import pytest

from core.errors import StageFailed
from core.flags import Flag, worst


def test_a_flag_survives_the_way_through_json():
    flag = Flag("bent_model", "error", 3.25, 2.0, "frames 0-60")
    assert Flag.from_dict(flag.to_dict()) == flag
    assert flag.to_dict() == {
        "code": "bent_model",
        "severity": "error",
        "value": 3.25,
        "threshold": 2.0,
        "where": "frames 0-60",
    }


@pytest.mark.parametrize(("code", "severity"), [("never_heard_of", "error"), ("bent_model", "fatal")])
def test_unknown_codes_and_severities_are_refused(code, severity):
    with pytest.raises(StageFailed):
        Flag(code, severity)


def test_worst_orders_by_severity():
    flags = [Flag("few_points", "warning"), Flag("no_parallax", "error"), Flag("interval_clipped", "info")]
    assert worst(flags) == "error"
    assert worst([]) is None
