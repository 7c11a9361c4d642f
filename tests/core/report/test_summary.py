from __future__ import annotations

from dataclasses import replace

import pytest

from core.report.build import build_report
from core.report.summary import run_fingerprint, stage_state
from core.settings import make_settings
from core.stage_specs import STAGES
from core.states import TaskState
from tests.core.making_record import failed_record, full_record


def test_stages_are_summed_over_tasks() -> None:
    stages = {stage["name"]: stage for stage in build_report(full_record()).summary["stages"]}
    assert list(stages) == list(STAGES)
    assert (stages["features"]["seconds"], stages["features"]["peak_rss_bytes"]) == (3.0, 99)
    assert stages["coarse"]["tasks"] == 3
    assert stages["confirm"]["state"] == "waiting"


@pytest.mark.parametrize(
    ("states", "state"),
    [
        ([], "waiting"),
        (["succeeded", "waiting"], "waiting"),
        (["succeeded", "failed"], "succeeded"),
        (["failed", "skipped"], "failed"),
        (["skipped"], "skipped"),
        (["succeeded", "cancelled"], "cancelled"),
    ],
)
def test_state_of_a_stage(states: list[str], state: str) -> None:
    assert stage_state([TaskState(one) for one in states]) == state


def test_says_what_ran_with_what() -> None:
    summary = build_report(full_record("draft")).summary
    assert summary["parameters"]["preset"] == "draft"
    assert summary["parameters"]["features"]["max_keypoints"] == 2048
    assert summary["scale"] == {"unit": "model", "value": None, "sigma": None, "source": None}
    assert (summary["inputs"]["video"], summary["versions"]["bladeatlas"]) == ("aa", "0.1.0")
    assert (summary["failed_stage"], summary["reason"]) == (None, None)
    assert summary["headline"]["mapped"] == 3
    assert summary["headline"]["registered_images"] == 4


def test_fingerprint_names_inputs_and_method_not_work() -> None:
    base = full_record()
    same = [
        replace(base, settings=make_settings("default", {"compute.threads": 7})),
        failed_record(),
    ]
    other = [
        replace(base, inputs={"video": "cc"}),
        replace(base, settings=make_settings("default", {"matching.window": 7})),
    ]
    assert {run_fingerprint(record) for record in same} == {run_fingerprint(base)}
    assert run_fingerprint(base) not in {run_fingerprint(record) for record in other}
