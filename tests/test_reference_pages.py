"""The pages that are made from the code hold everything that the code declares."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from core.outputs import OUTPUTS, TABLES
from core.settings import option_names
from scripts import reference_pages
from store.settings import DeploymentSettings

DOCS = Path(__file__).parents[1] / "docs"


def test_every_option_has_a_row_and_every_group_a_sentence() -> None:
    page = reference_pages.settings_page()
    assert re.findall(r"^\| `([\w.]+)` \|", page, re.MULTILINE) == list(option_names())
    groups = re.findall(r"^## \w+\n\n\n?(.*)$", page, re.MULTILINE)
    assert sum(text.endswith(".") for text in groups) == len(groups) - 1, "all but the seed, which is in no group"


def test_every_variable_has_a_row() -> None:
    named = re.findall(r"^\| `BLADEATLAS_(\w+)` \|", reference_pages.environment_page(), re.MULTILINE)
    assert [name.lower() for name in named] == list(DeploymentSettings.model_fields)


def test_every_command_is_there_with_its_arguments() -> None:
    page = reference_pages.command_page()
    for command in ("bladeatlas run", "bladeatlas keys create", "bladeatlas submit", "bladeatlas-bench accuracy"):
        assert f"### {command}\n" in page
    assert "| `--out DIR` | result folder, made when missing (required) |" in page
    assert "| `--preset default|thesis|draft` |" in page


def test_every_call_is_there_and_every_link_has_its_object() -> None:
    page, document = reference_pages.http_page(), reference_pages.openapi_document()
    for path, methods in document["paths"].items():
        for method in methods:
            assert f"{method.upper()} {path}\n" in page
    objects = {name.lower() for name in re.findall(r"^### (\w+)$", page, re.MULTILINE)}
    assert set(re.findall(r"\]\(#(\w+)\)", page)) <= objects


def test_every_published_file_is_documented() -> None:
    text = (DOCS / "outputs.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`([\w/*.]+?)/?`", text))
    # "`mapping/timeline.csv`, `.json`" names two files.
    named |= {f"{stem}.{other}" for stem, other in re.findall(r"`([\w/]+)\.\w+`, `\.(\w+)`", text)}
    named |= {path.rpartition("/")[0] for path in named}
    assert {*TABLES, *(output.path for output in OUTPUTS)} <= named


def test_a_block_of_the_readme_is_found_by_its_name() -> None:
    assert "curl -sSf" in reference_pages.readme_block("walk-through")
    with pytest.raises(ValueError, match="no block 'missing'"):
        reference_pages.readme_block("missing")
