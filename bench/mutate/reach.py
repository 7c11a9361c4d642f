"""Which tests run which lines of an area, by a run of its tests under `coverage`."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from core.errors import BadInput

PLUGIN = """\
import coverage
import pytest


def note(item, when):
    tracer = coverage.Coverage.current()
    if tracer is not None:
        tracer.switch_context(f"{item.nodeid}|{when}")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    note(item, "setup")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_call(item):
    note(item, "call")
"""
"""Names in coverage's data the test that runs. Setting up is told apart: what it makes serves later tests too."""
TRACERS = ("ctrace", "pytrace")
"""What coverage traces lines with, the faster one first; extension libraries of an area may crash under either."""


@dataclass(frozen=True)
class Reach:
    """What the tests of an area run."""

    tests_of: Mapping[tuple[str, int], Sequence[str]]
    """Tests by module and line, as arguments of pytest."""
    everywhere: Mapping[str, frozenset[int]]
    """Lines of modules that any test may depend on: they run at import, or as machine code that coverage cannot see."""
    seconds: Mapping[str, float]
    """Time of each file of tests."""
    tests: Sequence[str]
    """All tests of the area, as arguments of pytest."""

    def tests_for(self, module: str, first: int, last: int) -> Sequence[str]:
        """The tests to run on a change of these lines; none when no test runs them."""
        lines = range(first, last + 1)
        if not self.everywhere[module].isdisjoint(lines):
            return self.tests
        found = {test for line in lines for test in self.tests_of.get((module, line), ())}
        files = {test for test in found if "::" not in test}
        return sorted(test for test in found if test in files or test.split("::")[0] not in files)

    def time_of(self, tests: Sequence[str]) -> float:
        """Seconds of the files of these tests."""
        return sum(
            seconds
            for file, seconds in self.seconds.items()
            if any(file.startswith(test.split("::")[0]) for test in tests)
        )


def environment(root: Path) -> dict[str, str]:
    """Variables under which the code of `root` is imported, and none that is installed.

    Plugins of pytest that happen to be installed take longer to load than most tests to run, and so does compiling
    what has not changed.
    """
    imports = os.pathsep.join([str(root), *_beside()])
    # What a caller adds to every call of pytest would change what these runs print.
    quick = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTHONDONTWRITEBYTECODE": "", "PYTEST_ADDOPTS": ""}
    return {**os.environ, **quick, "PYTHONPATH": imports}


def _beside() -> list[str]:
    """What PYTHONPATH holds beyond the repository."""
    entries = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return [entry for entry in entries if entry and not (Path(entry) / "bench" / "mutate").is_dir()]


def pytest_arguments(tests: Sequence[str]) -> list[str]:
    """Arguments of pytest to stop at the first failure; with the same examples each time, which may be slow."""
    plugins = ["-p", "no:cacheprovider", "-p", "hypothesispytest", "--hypothesis-profile=ci"]
    return ["-x", "-q", "--no-header", "--tb=no", *plugins, *tests]


def measure(root: Path, modules: Sequence[str], tests: Sequence[str]) -> Reach:
    """Run the tests once under coverage; when its tracers crash them, without, and every test counts for every line.

    Raises:
        BadInput: a test fails without any change.
    """
    (root / "reach_plugin.py").write_text(PLUGIN)
    (root / "reach.ini").write_text(f"[run]\ndata_file = {root / 'reach.data'}\ninclude = {','.join(modules)}\n")
    cover = [sys.executable, "-m", "coverage"]
    traced = [*cover, "run", "--rcfile=reach.ini", "-m", "pytest", "-p", "reach_plugin"]
    for tracer in TRACERS:
        ended = _run(root, traced, tests, {"COVERAGE_CORE": tracer})
        if ended.returncode >= 0:
            break
    crashed = ended.returncode < 0
    if crashed:
        ended = _run(root, [sys.executable, "-m", "pytest"], tests, {})
    if ended.returncode != 0:
        raise BadInput(f"the tests fail without any change:\n{ended.stdout[-2000:]}{ended.stderr[-2000:]}")
    sources = {module: (root / module).read_bytes() for module in modules}
    if crashed:
        every = {module: frozenset(range(1, source.count(b"\n") + 2)) for module, source in sources.items()}
        return Reach({}, every, _seconds(ended.stdout), tests)
    subprocess.run(
        [*cover, "json", "--rcfile=reach.ini", "--show-contexts", "-q", "-o", "reach.json"],
        cwd=root, env=environment(root), check=True,
    )  # fmt: skip
    report = json.loads((root / "reach.json").read_text())
    lines = {module: static_lines(source) for module, source in sources.items()}
    return Reach(_tests_of(report), lines, _seconds(ended.stdout), tests)


def _run(
    root: Path, command: Sequence[str], tests: Sequence[str], variables: Mapping[str, str]
) -> subprocess.CompletedProcess[str]:
    """The tests, with the time of each; the code is negative when a signal ended them."""
    return subprocess.run(
        [*command, "--durations=0", "-vv", *pytest_arguments(tests)],
        cwd=root, env={**environment(root), **variables}, capture_output=True, text=True, check=False,
    )  # fmt: skip


def _tests_of(report: Mapping[str, object]) -> dict[tuple[str, int], list[str]]:
    found: dict[tuple[str, int], list[str]] = {}
    files: Mapping[str, Mapping[str, Mapping[str, Sequence[str]]]] = report["files"]  # type: ignore[assignment]
    for module, file in files.items():
        for line, contexts in file["contexts"].items():
            found[module, int(line)] = sorted({_argument(context) for context in contexts if context})
    return found


def _argument(context: str) -> str:
    node, when = context.rsplit("|", 1)
    return node.split("::")[0] if when == "setup" else node.split("[")[0]


def _seconds(output: str) -> dict[str, float]:
    seconds: dict[str, float] = {}
    for line in output.splitlines():
        parts = line.split(maxsplit=2)
        if len(parts) == 3 and parts[1] in ("call", "setup", "teardown") and parts[0].endswith("s"):
            file = parts[2].split("::")[0]
            seconds[file] = seconds.get(file, 0.0) + float(parts[0][:-1])
    return seconds


def static_lines(source: bytes) -> frozenset[int]:
    """Lines outside functions, and those of functions that are compiled."""
    tree = ast.parse(source)
    functions = [node for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]
    compiled = {
        argument.id
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "compiled"
        for argument in call.args
        if isinstance(argument, ast.Name)
    }
    lines = set(range(1, source.count(b"\n") + 2))
    for function in functions:
        by_name = any(isinstance(one, ast.Name) and one.id == "compiled" for one in function.decorator_list)
        if not by_name and function.name not in compiled:
            lines -= set(range(function.body[0].lineno, (function.end_lineno or function.lineno) + 1))
    return frozenset(lines)
