"""`bladeatlas report`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cli.main import main
from core.inspection_report.forms import Form
from core.inspection_report.source import files_below
from tests.core.inspection_report.making_reports import text_of
from tests.core.making_results import RESULTS

RESULT = str(RESULTS / "two_models")


def test_all_forms_are_written_or_those_that_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", RESULT, "--out", str(tmp_path / "all"), "--reviewer", "Ada", "--date", "2026-05-04"]) == 0
    assert capsys.readouterr().out.split() == [str(tmp_path / "all" / f"report.{form}") for form in Form]
    assert sorted(path.name for path in (tmp_path / "all").iterdir()) == sorted(f"report.{form}" for form in Form)
    text = text_of((tmp_path / "all" / "report.pdf").read_bytes())
    assert "Ada" in text
    assert "2026-05-04" in text
    assert main(["report", RESULT, "--out", str(tmp_path / "one"), "--form", "csv", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"files": [str(tmp_path / "one" / "report.csv")]}
    assert [path.name for path in (tmp_path / "one").iterdir()] == ["report.csv"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--form", "docx"], "'docx' is no form of the report; there are pdf, html, csv, json"),
        (["--date", "4 May"], "'4 May' is no day"),
        (["--style", "absent"], "the style 'absent' is no folder"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], said: str
) -> None:
    assert main(["report", RESULT, "--out", str(tmp_path / "out"), *more]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_a_folder_that_is_no_result_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "is it a finished result?" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert main(["report", RESULT, "--out", str(tmp_path / "file")]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_a_link_that_leads_out_of_the_result_is_no_file_of_it(tmp_path: Path) -> None:
    (tmp_path / "result").mkdir()
    (tmp_path / "secret").write_text("of somebody else")
    (tmp_path / "result" / "link").symlink_to(tmp_path / "secret")
    read = files_below(tmp_path / "result")
    assert read("link") is None
    assert read("../secret") is None


def test_limits_are_read_from_a_file_or_refused_with_the_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "limits.csv"
    table.write_text("damage,count\ndent,5\n")
    words = ["report", RESULT, "--out", str(tmp_path), "--form", "json", "--units", "in", "--limits", str(table)]
    assert main(words) == 0
    document = json.loads((tmp_path / "report.json").read_text())
    assert document["limits"]["rows"] == [{"line": 2, "text": "dent, anywhere: at most 5 on a blade"}]
    assert not (RESULTS / "two_models" / "limits.json").exists(), "the result stays as it is"
    capsys.readouterr()
    for command in (words, ["row", RESULT, "--limits", str(table)]):
        table.write_text("damage,count\ndent,few\n")
        assert main(command) == 2
        assert "line 2 of the table of limits: count is 'few'" in capsys.readouterr().err
    table.write_bytes(b"\xff\xfe")
    assert main(words) == 2
    assert "no text in UTF-8" in capsys.readouterr().err
