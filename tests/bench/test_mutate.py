"""Mutants are the changes that they say, at one place, and the tests that reach a line are found."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from bench.mutate.areas import AREAS, Area
from bench.mutate.command import Fate, draw, judge
from bench.mutate.mutants import mutants_of
from bench.mutate.reach import Reach, measure, static_lines

pytestmark = pytest.mark.slow

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


CODE = """\
def half(a):
    return a / 2


def unused(a):
    return a * 3
"""
CRASH = """\
import os, signal, sys, time

from code_under_test import half

if type(getattr(sys.gettrace(), "__self__", sys.gettrace())).__name__ in {tracers}:
    os.kill(os.getpid(), signal.SIGSEGV)


def test_half():
    time.sleep(0.02)
    if half(6) == 12:
        os.kill(os.getpid(), signal.SIGSEGV)
    assert half(6) == 3
"""


def repository(root: Path, *tracers: str) -> Path:
    """A repository whose tests crash under these tracers of lines, and when half of 6 is 12."""
    (root / "bench" / "mutate").mkdir(parents=True)
    (root / "code_under_test.py").write_text(CODE)
    (root / "test_it.py").write_text(CRASH.replace("{tracers}", repr(tracers)))
    subprocess.run(["git", "init", "-q"], cwd=root, check=True)
    return root


@pytest.mark.parametrize(
    ("tracers", "called"),
    [((), ["test_it.py::test_half"]), (("CTracer",), ["test_it.py::test_half"]), (("CTracer", "PyTracer"), None)],
)
def test_tests_that_crash_under_a_tracer_are_measured_without_it(
    tmp_path: Path, tracers: tuple[str, ...], called: list[str] | None
) -> None:
    reach = measure(repository(tmp_path, *tracers), ["code_under_test.py"], ["test_it.py"])
    assert reach.tests_for("code_under_test.py", 2, 2) == (called or ["test_it.py"])
    assert reach.tests_for("code_under_test.py", 6, 6) == ([] if called else ["test_it.py"])
    assert list(reach.seconds) == ["test_it.py"]


def test_a_mutant_that_crashes_its_tests_is_killed(tmp_path: Path) -> None:
    root = repository(tmp_path / "root")
    area = Area(("code_under_test.py",), ("test_it.py",))
    verdicts = judge(root, tmp_path / "work", area, draw(root, area, 60, 0), 60.0)
    fates = {verdict.text.split("+ ")[1]: verdict.fate for verdict in verdicts}
    assert fates["return a * 2"] == Fate.KILLED, "ended by a signal"
    assert fates["return a / 3"] == Fate.KILLED
    assert fates["return a * 4"] == Fate.UNREACHED
