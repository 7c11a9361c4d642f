"""A run with fake stages: what is computed, what is reused, what is refused, how it ends."""

from __future__ import annotations

import json
import shutil
import threading
import time
from pathlib import Path
from typing import Any

import pytest

from core.errors import BadInput
from core.settings import make_settings
from core.videos import Recording
from tests.worker.conftest import Workplace, made_below
from tests.worker.fake_stages import GRAPH
from worker.local_run import Names, run_inspection

pytestmark = pytest.mark.slow

ALL = ["join", "last", "part/000", "part/001", "split"]
ANOTHER_LAST = {"timeline.radius_fraction": 0.05}
"""Options that `last` alone reads."""


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Workplace:
    """A workplace whose run has ended: five processes that the tests need not start once more each."""
    made = made_below(tmp_path_factory.mktemp("template"))
    assert made.run().state == "succeeded"
    return made


@pytest.fixture
def ended(template: Workplace, tmp_path: Path) -> Workplace:
    """A copy of a workplace whose run has ended; its journal counts from there."""
    shutil.copytree(template.root, tmp_path, dirs_exist_ok=True)
    copy = Workplace(tmp_path)
    assert copy.started() == ALL
    return copy


def test_a_run_computes_everything_once_and_the_next_nothing(place: Workplace) -> None:
    outcome = place.run()
    assert (outcome.state, outcome.computed, outcome.reused, outcome.error) == ("succeeded", 5, 0, None)
    assert place.started() == ALL
    again = place.run()
    assert (again.state, again.computed, again.reused) == ("succeeded", 0, 5)
    assert place.started() == []
    assert place.temporary() == []


def test_progress_never_falls_and_ends_at_one(place: Workplace) -> None:
    place.control(all={"sleep_s": 0.3})
    place.run()
    fractions = [event.fraction for event in place.events]
    assert fractions == sorted(fractions)
    assert (fractions[0], fractions[-1]) == (0.0, 1.0)
    kinds = [event.kind for event in place.events]
    assert kinds[0] == "opened"
    assert kinds[-2:] == ["published", "finished"]
    assert "progress" in kinds
    ended = [event for event in place.events if event.kind == "ended"]
    assert sorted(event.key for event in ended) == ALL
    assert [(e.done, e.total) for e in ended if e.stage == "part"][-1] == (2, 2)
    left = [event.eta_s for event in place.events if event.eta_s is not None]
    assert left[-1] == 0.0


def test_stage_outcomes_sum_up_their_tasks(place: Workplace) -> None:
    outcome = place.run()
    part = next(stage for stage in outcome.stages if stage.name == "part")
    assert (part.state, part.done, part.total, part.reused) == ("succeeded", 2, 2, 0)
    assert part.peak_rss_bytes > 1 << 20
    assert part.seconds > 0


def test_fanned_out_stages_get_one_thread_and_others_what_is_set(place: Workplace) -> None:
    place.run({"compute.threads": 3})
    lines = [line.split() for line in (place.video.parent / "journal.txt").read_text().splitlines()]
    threads = {line[1]: line[3] for line in lines if line[0] == "start"}
    assert (threads["split"], threads["part/000"]) == ("3", "1")


@pytest.mark.parametrize(
    ("options", "again"),
    [
        ({"timeline.radius_fraction": 0.05}, ["last"]),
        ({"mesh.poisson_trim": 5.0}, ["join", "last"]),
        # A split with another count has another digest, so every part is made anew from it.
        ({"matching.window": 1}, [key for key in ALL if key != "part/001"]),
    ],
)
def test_changed_parameters_recompute_only_what_they_touch(
    ended: Workplace, options: dict[str, float], again: list[str]
) -> None:
    ended.run(options)
    assert ended.started() == sorted(again)
    ended.run()
    assert ended.started() == []


def test_the_callers_names_stand_beside_the_result_and_cost_no_work(ended: Workplace) -> None:
    for label in ("stage 2", "stage 3"):
        ended.run(names=Names(label, "WO-1187", {"module": label}))
        summary = json.loads((ended.out / "summary.json").read_text())
        assert (summary["label"], summary["external_id"]) == (label, "WO-1187")
        assert summary["metadata"] == {"module": label}
    assert ended.started() == []


def test_from_stage_deletes_that_stage_and_all_that_follow(ended: Workplace) -> None:
    outcome = ended.run(from_stage="join")
    assert ended.started() == ["join", "last"]
    assert (outcome.computed, outcome.reused) == (2, 3)
    with pytest.raises(BadInput, match="unknown stage 'mesh'"):
        ended.run(from_stage="mesh")


def test_another_input_is_refused_and_forced(ended: Workplace) -> None:
    ended.video.write_bytes(b"another video")
    with pytest.raises(BadInput) as caught:
        ended.run()
    assert caught.value.code == "another_input"
    assert ended.started() == []
    assert ended.run(force=True).state == "succeeded"
    assert ended.started() == ALL


def test_other_annotations_are_another_input_but_share_results(ended: Workplace, tmp_path: Path) -> None:
    notes = tmp_path / "notes.json"
    notes.write_text("{}")
    with pytest.raises(BadInput):
        ended.run(annotations=notes)
    ended.run(annotations=notes, force=True)
    assert ended.started() == ["last"]


def test_a_folder_may_have_any_name(place: Workplace, tmp_path: Path) -> None:
    strange = Workplace(tmp_path / "a::b ?#%20~ü")
    strange.video.parent.mkdir(parents=True)
    strange.video.write_bytes(place.video.read_bytes())
    assert strange.run().state == "succeeded"
    assert (strange.out / "summary.json").is_file()
    assert strange.run().computed == 0


def test_a_folder_of_pictures_is_the_same_video_until_one_of_them_changes(place: Workplace) -> None:
    """The toy stages cannot read it; what counts is which input the output folder belongs to."""
    place.video.unlink()
    place.video.mkdir()
    for number in range(3):
        (place.video / f"{number}.png").write_bytes(bytes([number]))
    (place.video / "notes.txt").write_text("no part of it")
    place.run()
    (place.video / "notes.txt").unlink()
    place.run()
    (place.video / "1.png").write_bytes(b"another picture")
    with pytest.raises(BadInput) as caught:
        place.run()
    assert caught.value.code == "another_input"


def test_a_folder_with_files_of_somebody_else_is_refused(place: Workplace) -> None:
    place.out.mkdir()
    (place.out / "summary.json").write_text("mine")
    with pytest.raises(BadInput) as caught:
        place.run()
    assert caught.value.code == "foreign_files"
    assert (place.out / "summary.json").read_text() == "mine"
    assert place.run(force=True).state == "succeeded"


def test_a_missing_video_is_bad_input(place: Workplace) -> None:
    place.video.unlink()
    with pytest.raises(BadInput):
        place.run()
    assert not place.out.exists()


def test_two_runs_in_one_folder_exclude_each_other(place: Workplace) -> None:
    place.control(split={"sleep_s": 1.0})
    first = threading.Thread(target=place.run)
    first.start()
    while not any(event.kind == "started" for event in place.events):
        time.sleep(0.02)
    with pytest.raises(BadInput) as caught:
        run_inspection([Recording(place.video)], place.out, make_settings(), graph=GRAPH)
    assert caught.value.code == "folder_in_use"
    first.join()
    assert place.events[-1].state == "succeeded"


def test_a_failed_part_is_tolerated_and_tried_again_next_time(place: Workplace) -> None:
    place.control(part__001={"raise": "stage"})
    outcome = place.run()
    assert outcome.state == "succeeded"
    assert facts(place, "join")["parts"] == 1
    place.started()
    place.control()
    place.run()
    assert place.started() == ["join", "last", "part/001"]
    assert facts(place, "join")["parts"] == 2


def facts(place: Workplace, stage: str) -> dict[str, float]:
    newest = max((place.out / ".bladeatlas/results" / stage).glob("*/result.json"), key=lambda p: p.stat().st_mtime_ns)
    found: dict[str, float] = json.loads(newest.read_text())["facts"]
    return found


@pytest.mark.parametrize(
    ("error", "code", "attempts"),
    [
        ("no_reconstruction", "no_reconstruction", 1),
        ("bug", "internal", 1),
        ("memory", "oom", 1),
    ],
)
def test_errors_end_a_run_with_their_code_after_their_attempts(
    place: Workplace, error: str, code: str, attempts: int
) -> None:
    place.control(split={"raise": error})
    outcome = place.run()
    assert (outcome.state, outcome.failed_stage) == ("failed", "split")
    assert outcome.error is not None
    assert outcome.error.code == code
    assert place.started() == ["split"] * attempts
    summary = json.loads((place.out / "summary.json").read_text())
    assert (summary["state"], summary["failed_stage"], summary["reason"]) == ("failed", "split", code)
    log = (place.out / ".bladeatlas/logs/split.log").read_text()
    assert "Traceback" in log


def test_a_task_that_dies_twice_works_the_third_time(place: Workplace) -> None:
    place.control(split={"die": 11, "times": 2})
    assert place.run().state == "succeeded"
    assert place.started().count("split") == 3
    retries = [event for event in place.events if event.kind == "retry"]
    assert len(retries) == 2
    assert "SIGSEGV" in retries[0].message


def test_a_part_that_always_kills_its_process_is_done_without(place: Workplace) -> None:
    place.control(part__001={"die": 9})
    outcome = place.run()
    assert outcome.state == "succeeded"
    assert place.started().count("part/001") == 3
    assert facts(place, "join")["parts"] == 1


@pytest.mark.parametrize(
    ("wish", "code", "message"),
    [
        ({"raise": "disk"}, "disk_full", "No space left"),
        ({"reads": "mesh"}, "internal", "UndeclaredOption: the stage does not declare that it reads Settings.mesh"),
    ],
)
def test_a_full_disk_or_a_mistake_in_the_code_of_an_optional_part_stops_the_run(
    place: Workplace, wish: dict[str, Any], code: str, message: str
) -> None:
    place.control(part__001=wish)
    outcome = place.run()
    assert (outcome.state, outcome.failed_stage) == ("failed", "part")
    assert outcome.error is not None
    assert outcome.error.code == code
    assert message.lower() in outcome.error.message.lower()
    assert "join" not in place.started()


def test_what_a_library_cannot_do_in_an_optional_part_costs_that_part_alone(place: Workplace) -> None:
    place.control(part__001={"raise": "library"})
    outcome = place.run()
    assert outcome.state == "succeeded"
    assert "join" in place.started()


def test_a_failure_with_something_to_serve_is_partial(ended: Workplace) -> None:
    ended.control(last={"raise": "stage"})
    outcome = ended.run(ANOTHER_LAST)
    assert (outcome.state, outcome.failed_stage) == ("partial", "last")


def test_a_task_above_its_memory_limit_is_ended_as_oom(place: Workplace, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BLADEATLAS_TASK_MEMORY_BYTES", str(300 << 20))
    place.control(part__001={"megabytes": 500})
    outcome = place.run()
    assert outcome.state == "succeeded"
    assert place.started().count("part/001") == 1
    failed = [event for event in place.events if event.kind == "ended" and event.state == "failed"]
    assert [(event.key, "300 MiB" in event.message) for event in failed] == [("part/001", True)]


def test_a_task_above_its_time_limit_is_ended_as_timeout(ended: Workplace, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BLADEATLAS_TASK_SECONDS", "2.5")
    ended.control(last={"sleep_s": 30, "deaf": True})
    outcome = ended.run(ANOTHER_LAST)
    assert (outcome.state, outcome.failed_stage) == ("partial", "last")
    assert outcome.error is not None
    assert (outcome.error.code, outcome.error.message) == ("timeout", "the task ran longer than its limit of 2.5 s")
    # On a busy machine the limit passes while the process still loads its modules; it is not tried again either way.
    assert ended.started() in ([], ["last"])
    assert not [event for event in ended.events if event.kind == "retry"]


@pytest.mark.parametrize(
    ("variable", "value", "wish", "code", "words"),
    [
        ("TASK_ADDRESS_BYTES", 2 << 30, {"megabytes": 4000}, "oom", "2048 MiB of addresses (task_address_bytes)"),
        ("TASK_ADDRESS_BYTES", 2 << 30, {"native_megabytes": 4000}, "oom", "2048 MiB of addresses"),
        ("TASK_CPU_SECONDS", 2, {"burn": True}, "timeout", "processor time"),
        ("TASK_FILE_BYTES", 1 << 20, {"file_megabytes": 2}, "file_too_large", "task_file_bytes"),
    ],
)
def test_a_task_beyond_a_limit_of_the_kernel_fails_once_and_says_which(
    ended: Workplace,
    monkeypatch: pytest.MonkeyPatch,
    variable: str,
    value: int,
    wish: dict[str, Any],
    code: str,
    words: str,
) -> None:
    monkeypatch.setenv(f"BLADEATLAS_{variable}", str(value))
    ended.control(last=wish)
    outcome = ended.run(ANOTHER_LAST)
    assert (outcome.state, outcome.failed_stage) == ("partial", "last")
    assert outcome.error is not None
    assert outcome.error.code == code
    assert words in outcome.error.message
    assert ended.started() == ["last"]


def test_results_whose_files_vanished_are_made_again(ended: Workplace) -> None:
    victim = next((ended.out / ".bladeatlas/results/part").glob("*/model/points.bin"))
    victim.write_bytes(victim.read_bytes()[:-1])
    ended.run()
    assert len(ended.started()) == 1


def test_a_lost_plan_is_rebuilt_from_the_results_on_disk(ended: Workplace) -> None:
    for path in (ended.out / ".bladeatlas").glob("plan.db*"):
        path.unlink()
    assert ended.run(force=True).reused == 5
    assert ended.started() == []


def test_old_results_are_cleaned_up_but_for_the_previous_parameters(ended: Workplace) -> None:
    for radius in (0.03, 0.04, 0.05):
        ended.run({"timeline.radius_fraction": radius})
    results = ended.out / ".bladeatlas" / "results"
    assert ended.started() == ["last"] * 3
    assert len(list(results.glob("last/*"))) == 2
    assert len(list(results.glob("part/*"))) == 2
