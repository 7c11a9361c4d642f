"""Mutants are the changes that they say, at one place, and the tests that reach a line are found."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.mutate.areas import AREAS
from bench.mutate.command import draw
from bench.mutate.mutants import mutants_of
from bench.mutate.reach import Reach, static_lines

ROOT = Path(__file__).parents[2]


def changes(line: str) -> set[str]:
    source = f"def f(a, b):\n    {line}\n".encode()
    return {mutant.apply(source).decode().splitlines()[1].strip() for mutant in mutants_of("f.py", source)}


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("return a < b", {"return a <= b", "return a >= b", "return None"}),
        ("return a not in b", {"return a in b", "return None"}),
        ("c = a + b", {"c = a - b"}),
        ("c = (a) ** (b)", {"c = (a) * (b)"}),
        ("c = a and b", {"c = a or b"}),
        ("c = not a", {"c = a"}),
        ("c = -a", {"c = a"}),
        ("c = 2.0", {"c = 2.9"}),
        ("c = 7", {"c = 8"}),
        ("c = True", {"c = False"}),
        ("c: int | str = a", set()),
        ("c = 'text', f'{a + b}'", set()),
        ("c = a(1, b=b)", {"c = a(2, b=b)", "c = a(1)"}),
        ("c = min(a, b)", {"c = max(a, b)", "c = min(a)"}),
        ("c = [x for x in a if b.y]", {"c = [x for x in a if (not b.y)]"}),
        ("a.b()", {"pass"}),
        ("a -= b", {"a += b"}),
    ],
)
def test_each_change_is_made_at_its_place(line: str, expected: set[str]) -> None:
    assert changes(line) == expected


def test_a_mutant_says_where_it_is() -> None:
    source = "é = 'é'\nif (\n    é is None\n):\n    é = 1\n".encode()
    (identity, number) = mutants_of("some.py", source)
    assert identity.describe(source) == "some.py:3\n    - é is None\n    + é is not None"
    assert ((identity.first, identity.last), (number.first, number.last)) == ((2, 4), (5, 5))


def test_lines_that_coverage_cannot_see_belong_to_every_test() -> None:
    plain = b"A = 1\ndef f(a=1):\n    return a\n"
    source = plain + b"@compiled\ndef g():\n    return 2\ndef h():\n    return 3\nH = compiled(h)\n"
    assert static_lines(source) == {1, 2, 4, 5, 6, 7, 8, 9, 10}
    reached = {("m.py", 3): ["tests/a.py::x", "tests/b.py", "tests/b.py::y"]}
    reach = Reach(reached, {"m.py": static_lines(source)}, {"tests/a.py": 1.0, "tests/b.py": 2.0}, ["tests"])
    assert reach.tests_for("m.py", 3, 3) == ["tests/a.py::x", "tests/b.py"]
    assert reach.tests_for("m.py", 1, 1) == ["tests"]
    assert reach.time_of(["tests"]) == reach.time_of(["tests/a.py::x", "tests/b.py"]) == 3.0
    assert reach.time_of(["tests/a.py::x"]) == 1.0


def test_areas_name_what_is_there() -> None:
    for area in AREAS.values():
        assert all((ROOT / path).exists() for path in (*area.modules, *area.tests))


def test_the_draw_is_the_same_each_time() -> None:
    area = AREAS["scene"]
    drawn = draw(ROOT, area, 60, 0)
    assert len(set(drawn)) == 60
    assert drawn == draw(ROOT, area, 60, 0)
    assert drawn != draw(ROOT, area, 60, 1)
