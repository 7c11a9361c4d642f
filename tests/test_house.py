"""What holds the whole repository together: documents that agree with files, and house rules."""

from __future__ import annotations

import ast
import re
import subprocess
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml
from markdown.extensions.toc import slugify

from core.settings import PRESET_NAMES
from scripts import reference_pages
from tests import conftest

ROOT = Path(__file__).parents[1]
MAX_LINES = 400
PACKAGES = ("core", "store", "worker", "api", "cli", "bench")
TEXT = {".py", ".md", ".toml", ".yml", ".yaml", ".sh", ".ini", ".cfg", ".lock", ".html", ".css", ".js", ".mako", ""}
MACHINE_PATHS = re.compile(r"(?<![\w.])/(?:work|root|opt|home/\w+|tmp/\w+)/")
HOSTS = re.compile(r"https?://[\w.-]*(?:pypi|pythonhosted|debian|npmjs)[\w.-]*", re.IGNORECASE)
UNFINISHED = re.compile(
    r"\b(?:TO" + r"DO|FIX" + r"ME|XXX|HACK)\b|\bfor " + r"now\b|\bplace" + r"holder\b", re.IGNORECASE
)
CO_AUTHOR = re.compile("co-" + "authored-by", re.IGNORECASE)


def tracked() -> list[Path]:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    names = [name for name in listed.stdout.decode().split("\0") if name]
    if not names:
        pytest.skip("not a git checkout")
    return [ROOT / name for name in names if (ROOT / name).is_file()]


def texts() -> list[tuple[Path, str]]:
    return [(path, path.read_text(encoding="utf-8")) for path in tracked() if path.suffix in TEXT]


def readme_test_command() -> str:
    block = re.search(
        r"<!-- test command -->\n```\w*\n(.*?)\n```\n<!-- end -->", (ROOT / "README.md").read_text(), re.DOTALL
    )
    assert block, "README.md marks its test command"
    return block.group(1)


def test_ci_runs_the_command_of_the_readme() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    reading = re.search(r"^command=\$\((.*)\)$", script, re.MULTILINE)
    assert reading, ".ci/run reads its command from README.md"
    found = subprocess.run(["bash", "-c", reading.group(1)], cwd=ROOT, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == readme_test_command() == "make test"
    assert 'exec bash -euo pipefail -c "$command"' in script
    assert "BLADEATLAS_REQUIRE_SERVICES=1" in script
    assert "missing+=(ffmpeg)" in script, "without it every test of the tool fails there"


@pytest.mark.parametrize(("required", "outcome"), [("0", pytest.skip.Exception), ("1", pytest.fail.Exception)])
def test_an_absent_tool_is_a_counted_skip_and_in_ci_a_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, required: str, outcome: type[BaseException]
) -> None:
    (tmp_path / "ffmpeg").touch(mode=0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("BLADEATLAS_REQUIRE_SERVICES", required)
    skipped: Counter[str] = Counter()
    marks = {"tool": [pytest.mark.tool("ffmpeg").mark]}
    config = SimpleNamespace(stash={conftest._SKIPPED: skipped})
    item: Any = SimpleNamespace(iter_markers=lambda kind: marks.get(kind, []), config=config)
    with pytest.raises(outcome, match="ffprobe not found"):
        conftest.pytest_runtest_setup(item)
    assert ("absent: ffmpeg (1)" in conftest.skipped_line(skipped)) == (required == "0")


@pytest.mark.parametrize("name", [".ci/run", "scripts/setup.sh", "scripts/secrets.sh", "scripts/web.sh"])
def test_scripts_can_be_run(name: str) -> None:
    path = ROOT / name
    assert path.stat().st_mode & 0o111
    subprocess.run(["bash", "-n", str(path)], check=True)


def test_no_file_is_too_long() -> None:
    long = {
        path.name: text.count("\n") for path, text in texts() if path.suffix == ".py" and text.count("\n") > MAX_LINES
    }
    assert not long


@pytest.mark.parametrize(
    "pattern", [MACHINE_PATHS, HOSTS, UNFINISHED, CO_AUTHOR], ids=["paths", "hosts", "open", "author"]
)
def test_no_file_says(pattern: re.Pattern[str]) -> None:
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()[:80]}"
        for path, text in texts()
        for number, line in enumerate(text.splitlines(), 1)
        if pattern.search(line) and path != Path(__file__) and path.name != "LICENSE"
    ]
    assert not found


def test_the_patterns_find_what_they_are_for() -> None:
    assert MACHINE_PATHS.search('open("/work' + '/x")')
    assert not MACHINE_PATHS.search("lies below docs/work/x")
    assert UNFINISHED.search("# TO" + "DO later")
    assert HOSTS.search("https://files.python" + "hosted.org/x")


def test_links_of_documents_resolve() -> None:
    """Pages that are made when the site is built count as there; the headings within docs/ are checked by mkdocs."""
    made = {ROOT / "docs" / name for name in reference_pages.PAGES}
    broken = []
    for path, text in texts():
        if path.suffix != ".md":
            continue
        for target, heading in re.findall(r"\]\(([^)#\s]*)(?:#([^)]*))?\)", text):
            found = (path.parent / target).resolve() if target else path
            if "://" in target or (found in made and (ROOT / "docs") in path.parents):
                continue
            if not found.exists() or (heading and heading not in headings(found)):
                broken.append(f"{path.relative_to(ROOT)} -> {target}#{heading}")
    assert not broken


def headings(path: Path) -> set[str]:
    """Names by which links reach the headings of a document."""
    return {slugify(line.lstrip("# "), "-") for line in path.read_text("utf-8").splitlines() if line.startswith("#")}


def test_the_site_loads_nothing_from_elsewhere_and_fails_on_a_broken_link() -> None:
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert not re.search(r"https?://", text)
    site = yaml.safe_load(text)
    assert site["theme"]["font"] is False
    assert "analytics" not in site["extra"]
    assert site["hooks"] == ["scripts/reference_pages.py"]
    assert set(site["validation"].values()) == {"warn"}
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "mkdocs build --strict" in makefile
    assert re.findall(r"^(?:check|test): lint (docs) ##", makefile, re.MULTILINE) == ["docs", "docs"]


def test_readme_is_short_and_its_limits_begin_with_the_missing_video() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert readme.count("\n") <= 120
    assert "## Limits\n- **No real video of turbine blades has been available.**" in readme


def test_templates_are_part_of_the_package() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    declared = project["tool"]["setuptools"]["package-data"]
    shipped = {
        path
        for package, patterns in declared.items()
        for pattern in patterns
        for path in ROOT.glob(f"{package.replace('.', '/')}/{pattern}")
    }
    templates = {path for path in tracked() if path.parent.name == "templates"}
    assert len(templates) >= 4
    assert templates <= shipped


def test_html_is_written_by_templates_only() -> None:
    found = [
        path.name
        for path, text in texts()
        if path.suffix == ".py" and path.relative_to(ROOT).parts[0] in PACKAGES and re.search(r"</\w+>", text)
    ]
    assert not found


def test_readme_names_every_preset_and_exit_code() -> None:
    readme = (ROOT / "README.md").read_text()
    for preset in PRESET_NAMES:
        assert f"`{preset}`" in readme or f"--preset {preset}" in readme
    for code in ("0 done", "1 internal error", "2 bad input", "3 no reconstruction", "4 partial", "130 interrupted"):
        assert code in readme


GEOMETRY = {
    "camera centre": "pose.py",
    "transform of points": "pose.py",
    "overlap of boxes": "boxes.py",
    "points in a box": "boxes.py",
    "nearest of sorted values": "nearest.py",
    "fisheye polynomial": "fisheye.py",
}
"""What is written once, and the file of `core/geometry` that holds it."""


def test_geometry_is_written_once() -> None:
    found: dict[str, set[str]] = {}
    for path in tracked():
        name = path.relative_to(ROOT)
        if path.suffix == ".py" and name.parts[0] in {"core", "bench"}:
            for concept in geometry_in(path.read_text(encoding="utf-8")):
                found.setdefault(concept, set()).add(str(name))
    assert found == {concept: {f"core/geometry/{file}"} for concept, file in GEOMETRY.items()}


@pytest.mark.parametrize(
    ("concept", "code"),
    [
        ("camera centre", "c = -pose[:, :3].T @ pose[:, 3]"),
        ("camera centre", "c = -np.einsum('fji,fj->fi', R, t)"),
        ("transform of points", "x = points @ pose.R.T + pose.t"),
        ("overlap of boxes", "iou = w * h / (sum(areas) - w * h)"),
        ("overlap of boxes", "iou = common / (a + b - common)"),
        ("points in a box", "i = (xy[:, 0] >= x1) & (xy[:, 0] <= x2) & (xy[:, 1] >= y1) & (xy[:, 1] <= y2)"),
        ("points in a box", "i = (x >= x1) & (x <= x2) & (y >= y1) & (y <= y2)"),
        ("points in a box", "i = (xy > 0).all(axis=1) & (xy[:, 0] < w) & (xy[:, 1] < h)"),
        ("points in a box", "i = ((xy >= low) & (xy <= high)).all(axis=-1)"),
        ("nearest of sorted values", "k = a if value - times[a] <= times[b] - value else b"),
        ("nearest of sorted values", "k = np.abs(self.times_s - time_s).argmin()"),
        ("fisheye polynomial", "r = theta * (1 + t * (k1 + t * (k2 + t * (k3 + t * k4))))"),
        ("fisheye polynomial", "scale = scale + k * square**power"),
    ],
)
def test_geometry_is_recognised_where_it_is_written_again(concept: str, code: str) -> None:
    assert geometry_in(code) == {concept}


def geometry_in(source: str) -> set[str]:
    return {concept for node in ast.walk(ast.parse(source)) for concept in _concepts(node)}


def _concepts(node: ast.AST) -> Iterator[str]:
    match node:
        case ast.BinOp(ast.UnaryOp(ast.USub(), ast.Attribute(attr="T")), ast.MatMult()):
            yield "camera centre"
        case ast.UnaryOp(ast.USub(), ast.Call(ast.Attribute(attr="einsum"), [ast.Constant("fji,fj->fi"), *_])):
            yield "camera centre"
        case ast.BinOp(ast.BinOp(_, ast.MatMult(), ast.Attribute(attr="T")), ast.Add()):
            yield "transform of points"
        case ast.BinOp(part, ast.Div(), ast.BinOp(_, ast.Sub(), again)) if ast.dump(part) == ast.dump(again):
            yield "overlap of boxes"
        case ast.BinOp(_, ast.BitAnd()) | ast.Call(ast.Attribute(ast.BinOp(), "all")) if _bounds_a_point(node):
            yield "points in a box"
        case ast.Compare(ast.BinOp(a, ast.Sub(), _), [ast.LtE()], [ast.BinOp(ast.Subscript(), ast.Sub(), b)]):
            if ast.dump(a) == ast.dump(b):
                yield "nearest of sorted values"
        case ast.Call(ast.Attribute(ast.Call(ast.Attribute(attr="abs"), [ast.BinOp(a, ast.Sub())]), "argmin")):
            if "time" in ast.unparse(a):
                yield "nearest of sorted values"
        case ast.BinOp(_, ast.Mult(), _) if _horner_depth(node) >= 3:
            yield "fisheye polynomial"
        case ast.BinOp(_, ast.Add(), ast.BinOp(_, ast.Mult(), ast.BinOp(_, ast.Pow(), ast.Name()))):
            yield "fisheye polynomial"


def _bounds_a_point(node: ast.AST) -> bool:
    """Whether comparisons bound the same points from both sides alike: by columns, all at once, or as x and y.

    A half-open range, as of array indices, is no box, and an interval of one number is none.
    """
    bounds: dict[str, set[str]] = {}
    planar = ".all(" in ast.unparse(node)
    for one in ast.walk(node):
        if isinstance(one, ast.Compare) and len(one.ops) == 1:
            left = ast.unparse(one.left)
            base = re.sub(r"\[(:|\.\.\.), [01]\]$", "", left)
            planar |= base != left
            bounds.setdefault(base, set()).add(type(one.ops[0]).__name__)
    bounded = sum(kinds >= {"GtE", "LtE"} or kinds >= {"Gt", "Lt"} for kinds in bounds.values())
    return bounded >= (1 if planar else 2)


def _horner_depth(node: ast.AST) -> int:
    """How many products of a polynomial are nested in each other: x * (a + x * (b + ...))."""
    match node:
        case ast.BinOp(_, ast.Mult(), ast.BinOp(_, ast.Add(), inner)):
            return 1 + _horner_depth(inner)
    return int(isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult))


def test_the_newest_version_in_the_changelog_is_that_of_the_package() -> None:
    versions = re.findall(
        r"^## (\d+\.\d+\.\d+) - \d{4}-\d{2}-\d{2}$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE
    )
    declared = re.search(r'^version = "(.*)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    assert declared is not None
    assert versions[0] == declared.group(1)
    assert sorted(versions, key=lambda text: [int(part) for part in text.split(".")], reverse=True) == versions


def test_the_folder_of_small_inputs_is_named_in_one_place() -> None:
    named = [path for path, text in texts() if re.search(r"[\"']data[\"'] / [\"']inputs[\"']", text)]
    assert named == [ROOT / "tests" / "inputs.py"]
