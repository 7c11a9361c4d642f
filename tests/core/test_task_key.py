"""Task keys: what is made is read back, and file names as well."""

from __future__ import annotations

import pytest

from core.task_key import chunk_key, file_stem, key_of, key_of_stem, part_of, parts_of, stage_of, submodel_of


@pytest.mark.parametrize(
    ("key", "parts"),
    [
        ("probe", ("probe", 0, "")),
        ("mesh@2", ("mesh", 2, "")),
        ("coarse/seg_000_0000_0180", ("coarse", 0, "seg_000_0000_0180")),
        ("depth@11/003", ("depth", 11, "003")),
        ("focal/085.0", ("focal", 0, "085.0")),
    ],
)
def test_a_key_is_read_as_it_was_made(key: str, parts: tuple[str, int, str]) -> None:
    assert (stage_of(key), submodel_of(key), part_of(key)) == parts
    assert key_of(*parts) == key
    assert key_of_stem(file_stem(key)) == key
    assert "/" not in file_stem(key)


def test_chunks_are_numbered_with_three_digits() -> None:
    assert chunk_key("features", 3) == "features/003"
    assert chunk_key("depth", 0, 1) == "depth@1/000"


def test_parts_are_those_of_one_stage_and_one_model_in_order() -> None:
    keys = ["depth/001", "depth", "depth/000", "depth@1/000", "depths/000", "mesh"]
    assert parts_of(keys, "depth") == ["depth/000", "depth/001"]
    assert parts_of(keys, "depth", 1) == ["depth@1/000"]
