from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pycolmap
import pytest

from core import viewgraph
from core.errors import StageFailed
from core.matched_pair import MatchedPair
from core.settings import make_settings
from core.verification import Verifier
from core.viewgraph import (
    PairTable,
    graph_counts,
    join_tables,
    make_table,
    open_database,
    read_table,
    table_counts,
    write_database,
    write_table,
)
from core.windows import sequential_pairs
from tests.core.making_views import bumpy_points, fisheye, pose, true_matches, view

N_VIEWS = 6


@pytest.fixture(scope="module")
def scene() -> tuple[list[np.ndarray], list[PairTable]]:
    """Keypoints of the views, and the table of their pairs in two parts."""
    points = bumpy_points(300)
    views = [view(points, pose(i), seed=i) for i in range(N_VIEWS)]
    verifier = Verifier(fisheye(), make_settings().verification)

    def table(pairs: list[tuple[int, int]]) -> PairTable:
        matched = []
        for a, b in pairs:
            matches = true_matches(views[a][1], views[b][1])
            matched.append(MatchedPair(0, len(matches), verifier.verify(views[a][0], views[b][0], matches)))
        return make_table(pairs, matched)

    pairs = sequential_pairs(N_VIEWS, 3)
    return [keypoints for keypoints, _ in views], [table(pairs[7:]), table(pairs[:7])]


def test_joined_tables_are_sorted_and_keep_their_rows(scene: tuple[list[np.ndarray], list[PairTable]]) -> None:
    late, early = scene[1]
    joined = join_tables([late, early])
    assert joined.pairs.tolist() == [list(pair) for pair in sequential_pairs(N_VIEWS, 3)]
    row = joined.pairs.tolist().index(late.pairs[0].tolist())
    mine = joined.inliers[joined.offsets[row] : joined.offsets[row + 1]]
    np.testing.assert_array_equal(mine, late.inliers[: late.offsets[1]])
    np.testing.assert_array_equal(joined.translation[row], late.translation[0])
    assert joined.n_inliers.sum() == len(joined.inliers)
    with pytest.raises(StageFailed, match="twice"):
        join_tables([late, early, late])


def test_tables_round_trip_with_the_same_bytes(scene: tuple[list[np.ndarray], list[PairTable]], tmp_path: Path) -> None:
    table = join_tables(scene[1])
    write_table(tmp_path / "a.npz", table)
    write_table(tmp_path / "b.npz", read_table(tmp_path / "a.npz"))
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    with pytest.raises(StageFailed):
        read_table(tmp_path / "none.npz")


def test_no_pairs_are_an_empty_graph(tmp_path: Path) -> None:
    table = join_tables([])
    assert graph_counts(table, 3) == {
        "n_pairs": 0,
        "n_verified": 0,
        "largest_component": 1,
        "median_triangulation_angle_deg": 0.0,
    }
    assert table_counts(table) == {"n_pairs": 0, "n_verified": 0, "n_lightglue": 0, "n_inliers": 0}
    write_table(tmp_path / "pairs.npz", table)
    assert len(read_table(tmp_path / "pairs.npz").pairs) == 0


def test_facts_count_the_component_of_verified_pairs(scene: tuple[list[np.ndarray], list[PairTable]]) -> None:
    facts = graph_counts(join_tables(scene[1]), N_VIEWS + 2)
    assert facts["n_verified"] == facts["n_pairs"] == 12
    assert facts["largest_component"] == N_VIEWS
    assert 1 < facts["median_triangulation_angle_deg"] < 10


def test_the_mapper_reconstructs_from_the_database(
    scene: tuple[list[np.ndarray], list[PairTable]], tmp_path: Path
) -> None:
    keypoints, tables = scene
    database = tmp_path / "database.db"
    write_database(database, fisheye(), keypoints, join_tables(tables))
    with pycolmap.Database.open(database) as stored:
        assert stored.num_images() == stored.num_frames() == N_VIEWS
        assert stored.num_verified_image_pairs() == 12
        assert stored.read_all_cameras()[0].has_prior_focal_length
        assert stored.read_image(3).name == "0002.jpg"
        np.testing.assert_allclose(stored.read_keypoints(3)[:, :2], keypoints[2])
    options = pycolmap.IncrementalPipelineOptions(num_threads=1, random_seed=0)
    options.mapper.init_min_tri_angle = 4
    (tmp_path / "model").mkdir()
    models = pycolmap.incremental_mapping(database, tmp_path, tmp_path / "model", options)
    model = models[0]
    assert model.num_reg_images() == N_VIEWS
    assert model.compute_mean_reprojection_error() < 0.5
    centres = np.array([model.image(i + 1).projection_center() for i in range(N_VIEWS)])
    truth = np.array([pose(i).inverse().translation for i in range(N_VIEWS)])
    path, true_path = (np.linalg.norm(np.diff(c, axis=0), axis=1) for c in (centres, truth))
    np.testing.assert_allclose(path / path.sum(), true_path / true_path.sum(), atol=0.02)


def test_the_database_has_the_same_bytes(scene: tuple[list[np.ndarray], list[PairTable]], tmp_path: Path) -> None:
    keypoints, tables = scene
    for name in ("a.db", "b.db"):
        write_database(tmp_path / name, fisheye(), keypoints, join_tables(tables))
    assert (tmp_path / "a.db").read_bytes() == (tmp_path / "b.db").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.db", "b.db"]


LOCKING = """
import sqlite3, sys
other = sqlite3.connect(sys.argv[1], isolation_level=None)
other.execute("PRAGMA journal_mode=DELETE")
other.execute("BEGIN EXCLUSIVE")
print("locked", flush=True)
sys.stdin.read()
"""
"""A process that keeps all others out of a database until its input ends, as the last reader does while it closes."""


@pytest.fixture
def locked(
    scene: tuple[list[np.ndarray], list[PairTable]], tmp_path: Path
) -> Iterator[tuple[Path, subprocess.Popen[str]]]:
    """A database, and the process that locks it."""
    path = tmp_path / "database.db"
    keypoints, tables = scene
    write_database(path, fisheye(), keypoints, join_tables(tables))
    command = [sys.executable, "-c", LOCKING, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == "locked\n"
        with pytest.raises(RuntimeError), pycolmap.Database.open(path):
            pass
        yield path, other
        other.kill()


def test_a_database_that_another_reader_locks_is_waited_for(locked: tuple[Path, subprocess.Popen[str]]) -> None:
    path, other = locked

    def close() -> None:
        time.sleep(0.3)
        assert other.stdin is not None
        other.stdin.close()

    closing = threading.Thread(target=close)
    closing.start()
    with open_database(path) as database:
        assert database.num_images() == N_VIEWS
    closing.join()


def test_a_database_that_stays_locked_is_told(
    locked: tuple[Path, subprocess.Popen[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    path, _ = locked
    monkeypatch.setattr(viewgraph, "OPENING_S", 0.1)
    with pytest.raises(StageFailed, match="cannot be opened") as failed, open_database(path):
        pass
    assert failed.value.where == "database.db"
