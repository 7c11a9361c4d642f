"""Folders that cannot be written and disks that are full: one clear error, and it goes on when there is space."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from core.errors import BadInput, DiskFull
from core.settings import make_settings
from core.videos import Recording
from tests.worker.conftest import Workplace
from tests.worker.disks import fill, mounted
from tests.worker.fake_stages import GRAPH
from worker.local_run import run_inspection

pytestmark = pytest.mark.slow


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    with mounted(tmp_path / "disk", mebibytes=4) as folder:
        yield folder


@pytest.mark.parametrize("leave", [1_200_000, 1_500_000])
def test_a_disk_that_fills_up_is_one_clear_error_and_it_goes_on_later(
    place: Workplace, small_disk: Path, leave: int
) -> None:
    out = small_disk / "out"
    filler = fill(small_disk, leave)
    outcome = run_inspection([Recording(place.video)], out, make_settings(), graph=GRAPH, workers=2)
    assert outcome.state == "failed"
    assert isinstance(outcome.error, DiskFull)
    assert "no space left" in outcome.error.message
    assert not (out / "summary.json").exists() or (out / "summary.json").read_text().endswith("}\n")
    filler.unlink()
    again = run_inspection([Recording(place.video)], out, make_settings(), graph=GRAPH, workers=2)
    assert again.state == "succeeded"


def test_a_disk_that_is_full_from_the_start_is_one_clear_error(place: Workplace, small_disk: Path) -> None:
    fill(small_disk, 0)
    with pytest.raises(DiskFull):
        run_inspection([Recording(place.video)], small_disk / "out", make_settings(), graph=GRAPH)


def test_a_read_only_disk_is_bad_input(place: Workplace, small_disk: Path) -> None:
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    with pytest.raises(BadInput) as caught:
        run_inspection([Recording(place.video)], small_disk / "out", make_settings(), graph=GRAPH)
    assert caught.value.code == "unwritable_output"


@pytest.mark.parametrize("inside", ["", "out"])
def test_a_file_in_the_place_of_the_folder_is_bad_input(place: Workplace, tmp_path: Path, inside: str) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(BadInput) as caught:
        run_inspection([Recording(place.video)], tmp_path / "file" / inside, make_settings(), graph=GRAPH)
    assert caught.value.code == "unwritable_output"
