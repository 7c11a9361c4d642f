"""Results whose truth is in an object store: made on one machine, used on another, gone when they are removed."""

from __future__ import annotations

from pathlib import Path

import pytest

from core.errors import ResourceError
from core.fingerprint import digest_of
from store.files import ArtifactStore, LocalInputs, input_key
from store.records import InputFiles
from tests.store.object_store import new_bucket, options
from worker.mirror import MirroredResults
from worker.results import Manifest, seal

NAME = digest_of("a task")


@pytest.fixture
def store(s3: str) -> ArtifactStore:
    return ArtifactStore(new_bucket(s3), **options(s3))


def machine(tmp_path: Path, name: str, store: ArtifactStore) -> MirroredResults:
    return MirroredResults(tmp_path / name, store)


def make(results: MirroredResults, text: str = "points") -> Manifest:
    folder = results.begin("join", NAME)
    (folder / "model").mkdir()
    (folder / "model" / "points.bin").write_text(text)
    seal(folder, fingerprint=NAME, key="join", version=2, facts={"n": 1}, seconds=1.0, rss=5)
    return results.commit(folder, "join", NAME)


def test_a_result_of_one_machine_is_found_and_read_on_another(tmp_path: Path, store: ArtifactStore) -> None:
    made = make(machine(tmp_path, "one", store))
    assert store.list("results") == [f"results/join/{NAME}/model/points.bin", f"results/join/{NAME}/result.json"]
    other = machine(tmp_path, "two", store)
    assert other.have(f"join/{NAME}")
    assert (other.path(f"join/{NAME}") / "model/points.bin").read_text() == "points"
    assert machine(tmp_path, "three", store).find("join", NAME) == made
    assert not other.have(f"join/{digest_of('another')}")
    assert other.temporary() == []


def test_an_upload_that_was_cut_off_is_done_again(tmp_path: Path, store: ArtifactStore) -> None:
    results = machine(tmp_path, "one", store)
    make(results)
    for path in (tmp_path / "one/join").glob(".mirrored-*"):
        path.unlink()
    store.remove(f"results/join/{NAME}/result.json")
    assert not machine(tmp_path, "two", store).have(f"join/{NAME}")
    assert results.find("join", NAME) is not None
    assert machine(tmp_path, "two", store).have(f"join/{NAME}")


def test_a_damaged_object_is_never_taken_for_the_result(tmp_path: Path, store: ArtifactStore) -> None:
    make(machine(tmp_path, "one", store))
    wrong = tmp_path / "wrong"
    wrong.write_text("pointz")
    store.put(f"results/join/{NAME}/model/points.bin", wrong)
    other = machine(tmp_path, "two", store)
    with pytest.raises(ResourceError) as caught:
        other.have(f"join/{NAME}")
    assert caught.value.code == "damaged_file"
    assert other.temporary() == []
    assert not other.path(f"join/{NAME}").exists()


def test_what_was_removed_by_one_does_not_come_back_from_another(tmp_path: Path, store: ArtifactStore) -> None:
    one, two = machine(tmp_path, "one", store), machine(tmp_path, "two", store)
    make(one)
    assert two.have(f"join/{NAME}")
    one.remove("join", NAME)
    assert store.list("results") == []
    assert two.find("join", NAME) is None
    assert one.find("join", NAME) is None
    assert store.list("results") == []


def test_local_copies_are_evicted_and_fetched_again(tmp_path: Path, store: ArtifactStore) -> None:
    results = machine(tmp_path, "one", store)
    make(results)
    assert results.evict({f"join/{NAME}"}, 0.0) == 0
    assert results.evict(set(), 3600.0) == 0
    assert results.evict(set(), 0.0) == 1
    assert not results.path(f"join/{NAME}").exists()
    assert results.have(f"join/{NAME}")


def test_results_that_no_row_names_are_found_here_and_in_the_store(tmp_path: Path, store: ArtifactStore) -> None:
    results = machine(tmp_path, "one", store)
    make(results)
    assert results.unknown(lambda: {NAME}, 0.0) == []
    results.evict(set(), 0.0)
    assert results.unknown(set, 0.0) == [f"join/{NAME}"]
    results.remove("join", NAME)
    assert store.list() == []


def test_inputs_are_downloaded_once_checked_and_evicted(tmp_path: Path, store: ArtifactStore) -> None:
    source = tmp_path / "video.mp4"
    source.write_bytes(b"a video")
    sha256 = store.put("upload", source).sha256
    key = input_key(sha256, "video")
    store.put(key, source)
    inputs = LocalInputs(store, tmp_path / "cache")
    files = InputFiles(key, sha256, None, None)
    assert not inputs.recording(files, video=False, annotations=True).video.exists()
    path = inputs.recording(files, video=True, annotations=True).video
    assert inputs.recording(files, video=True, annotations=True).annotations is None
    assert path.read_bytes() == b"a video"
    store.remove(key)
    assert inputs.recording(files, video=True, annotations=False).video == path
    assert inputs.evict({sha256}, 0.0) == 0
    assert inputs.evict(set(), 0.0) == 1
    with pytest.raises(FileNotFoundError):
        inputs.recording(files, video=True, annotations=False)
    assert list((tmp_path / "cache").iterdir()) == []
