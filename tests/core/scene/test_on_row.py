"""Names of blades in the tables, made and read."""

from __future__ import annotations

import pytest

from core.json_files import JsonObject
from core.scene.on_row import blade_name, blade_number

ON_FIRST: JsonObject = {"names": {"1": "4", "2": "5"}}


@pytest.mark.parametrize(
    ("number", "model", "on_first", "name"),
    [
        (4, 0, None, "4"),
        (1, 2, ON_FIRST, "4"),
        (3, 2, ON_FIRST, "2-B3"),
        (4, 2, {"names": {}}, "2-B4"),
        (4, 2, None, "2-B4"),
    ],
    ids=["of the first model", "on its row", "before its number 1", "not known to lie on it", "of an older result"],
)
def test_a_name_is_read_as_it_was_made(number: int, model: int, on_first: JsonObject | None, name: str) -> None:
    assert blade_name(number, model, on_first) == name
    assert blade_number(name, on_first) == number


@pytest.mark.parametrize("name", ["", "B4", "2-B", "none"])
def test_what_is_no_name_is_not_read(name: str) -> None:
    with pytest.raises(ValueError, match="invalid literal"):
        blade_number(name, ON_FIRST)
