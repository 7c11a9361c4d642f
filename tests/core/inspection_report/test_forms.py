"""The forms of the report: all of them tell every finding, none of them obeys what stands in a label."""

from __future__ import annotations

import csv
import io
import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from pypdf import PdfReader

from core.errors import BadInput
from core.inspection_report.forms import COLUMNS, POLICY, Form
from core.inspection_report.typeset import _SET, settable, typeset
from core.json_files import write_json
from tests.core.inspection_report.making_reports import DAY, ROW, changed, document_of, form_of, source_of, text_of
from tests.core.making_results import RESULTS

pytestmark = pytest.mark.slow

HOSTILE = (
    '#panic("ran")',
    '#read("/etc/passwd")',
    "$ x $ *bold* _it_ @ref <label> `raw` = heading",
    '"); #import "x.typ": *; (',
    "\\ // comment /* open",
    "<script>document.title='ran'</script><img src=x onerror=alert(1)>",
    "{{ 7 * 7 }}{% raw %}",
    '=HYPERLINK("http://x")',
    "中文 العربية עברית ไทย 🛩 e\u0301\u0327 \u202eabc \x00\x1b[31m",
    "a" * 3000,
)


class Tags(HTMLParser):
    """Names of the elements of a page, and addresses in it."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.names: set[str] = set()
        self.addresses: list[str] = []
        self.events: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.add(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("href", "src", "xlink:href")]
        self.events += [name for name, _ in attrs if name.startswith("on")]


def hostile(tmp_path: Path, text: str) -> Path:
    def label(defects: list[dict[str, Any]]) -> None:
        defects[0]["label"] = text

    def named(summary: dict[str, Any]) -> None:
        summary.update(label=text, metadata={text: text})

    return changed(tmp_path / "result", defects=label, summary=named)


def test_the_pdf_tells_every_finding_and_what_was_not_seen(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(blade="2"))
    write_json(folder / "row.json", ROW)
    document, text = document_of(folder), text_of(form_of(folder, Form.PDF))
    assert len(document["findings"]) == 4
    for one in document["findings"]:
        assert f"{one['name']}: {one['label']}" in text
        assert one["place"]["text"] in text
        assert one["size"]["text"] in text
    for sentence in document["not_seen"]:
        assert sentence in text
    for flag in document["flags"]:
        assert flag["text"] in text
    for words in ("Verdict SUSPECT", "Reviewer", "Signature", "blade 2 (relative)", document["method"]["fingerprint"]):
        assert words in text
    assert "mapping.method thesis" in text


@pytest.mark.parametrize("form", Form)
@pytest.mark.parametrize("name", ["two_models", "refused"])
def test_the_same_result_has_the_same_bytes_wherever_it_lies(tmp_path: Path, form: Form, name: str) -> None:
    there = changed(tmp_path / "elsewhere" / "result", name)
    assert form_of(RESULTS / name, form, day=DAY) == form_of(there, form, day=DAY)


@pytest.mark.parametrize("day", [None, DAY])
def test_the_pdf_is_tagged_and_with_its_day_archivable(day: str | None) -> None:
    reader = PdfReader(io.BytesIO(form_of(RESULTS / "two_models", Form.PDF, day=day)))
    catalog: Any = reader.trailer["/Root"]
    said = catalog["/Metadata"].get_data().decode()
    assert "<pdfuaid:part>1</pdfuaid:part>" in said
    assert ("<pdfaid:part>2</pdfaid:part>" in said) == (day is not None)
    assert catalog["/MarkInfo"]["/Marked"]
    assert catalog["/Lang"].lower().startswith("en")
    assert not {"/OpenAction", "/AA", "/AcroForm"} & set(catalog)
    assert reader.metadata is not None
    assert reader.metadata.title == "Inspection"
    # Three pictures of each of four findings; the frame and its close-up are one picture.
    assert len({image.data for page in reader.pages for image in page.images}) >= 4


def test_a_refused_result_says_why_and_shows_no_place() -> None:
    document, text = document_of(RESULTS / "refused"), text_of(form_of(RESULTS / "refused", Form.PDF))
    assert document["findings"] == []
    assert "Verdict REFUSED" in text
    assert "no case has a model" in text
    assert "The result was refused: it says nothing about where damage is." in text
    assert "5 detections have no place" in text
    assert "The result was refused" in form_of(RESULTS / "refused", Form.HTML).decode()


@pytest.mark.parametrize("text", HOSTILE)
def test_no_form_obeys_a_label(tmp_path: Path, text: str) -> None:
    folder = hostile(tmp_path, text)
    pdf = text_of(form_of(folder, Form.PDF, day=DAY)).replace(" ", "")
    assert settable(text).replace(" ", "")[:60] in pdf
    assert "root:" not in pdf
    page = form_of(folder, Form.HTML).decode()
    tags = Tags(page)
    assert not {"script", "iframe", "object", "img"} & tags.names
    assert tags.events == []
    assert all(address.startswith(("#p", "data:image/jpeg;base64,")) for address in tags.addresses)
    rows = list(csv.DictReader(io.StringIO(form_of(folder, Form.CSV).decode(), newline="")))
    labels = [row["label"] for row in rows]
    assert not any(label.startswith(("=", "+", "-", "@")) for label in labels)
    assert json.loads(form_of(folder, Form.JSON))["title"] == text


def test_every_character_that_is_not_written_out_can_be_set(tmp_path: Path) -> None:
    """PDF/UA refuses a character without a glyph, so setting all of them proves that each has one."""
    every = "".join(settable(chr(code)) for low, high in _SET for code in range(low, high + 1))
    assert "\\u" not in every.replace("\\\\", "")
    for start in range(0, len(every), 200):
        one = hostile(tmp_path / str(start), " ".join(every[start : start + 200]))
        assert typeset(document_of(one), source_of(one)).startswith(b"%PDF")


def test_characters_without_a_glyph_are_written_out() -> None:
    assert settable("中 \u202e\x00 Ä A\u0308 🛩") == "\\u4e2d \\u202e\\u0000 Ä Ä \\U0001f6e9"


def test_the_page_stands_alone(tmp_path: Path) -> None:
    page = form_of(RESULTS / "two_models", Form.HTML).decode()
    assert POLICY.replace("'", "&#39;") in page
    for one in document_of(RESULTS / "two_models")["findings"]:
        assert f"{one['name']}: {one['label']}" in page
        assert one["place"]["text"] in page
    # Every picture is in it once: the frame and its close-up are one.
    pictures = [address for address in Tags(page).addresses if address.startswith("data:")]
    assert len(pictures) == len(set(pictures)) >= 4


def test_the_table_has_a_row_for_every_finding() -> None:
    rows = list(csv.DictReader(io.StringIO(form_of(RESULTS / "two_models", Form.CSV).decode(), newline="")))
    assert tuple(rows[0]) == COLUMNS
    assert [row["finding"] for row in rows] == ["D0", "D1", "D2", "D10"]
    assert {row["size_unit"] for row in rows} == {"model"}
    assert {row["blade"] for row in rows} == {""}


def test_a_result_without_a_page_has_a_report_that_says_so(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result")
    for page in list(folder.rglob("viewer")):
        for file in page.rglob("*"):
            if file.is_file():
                file.unlink()
    text = text_of(form_of(folder, Form.PDF))
    assert text.count("No such picture is kept") == 12
    assert "No such picture is kept" in form_of(folder, Form.HTML).decode()


def test_a_house_has_its_own_style(tmp_path: Path) -> None:
    style = tmp_path / "style"
    style.mkdir()
    own = (Path(__file__).parents[3] / "core/inspection_report/templates/style.typ").read_text(encoding="utf-8")
    (style / "style.typ").write_text(
        own.replace("#let organisation = none", '#let organisation = "House of Blades"').replace(
            "#let logo = none", '#let logo = image("logo.jpg", alt: "Logo", height: 10mm)'
        ),
        encoding="utf-8",
    )
    (style / "logo.jpg").write_bytes((RESULTS / "two_models/viewer/frames/0000.jpg").read_bytes())
    (style / "report.css").write_text("h1 { color: teal; }")
    assert "House of Blades" in text_of(form_of(RESULTS / "two_models", Form.PDF, style))
    assert "h1 { color: teal; }" in form_of(RESULTS / "two_models", Form.HTML, style).decode()


@pytest.mark.parametrize(
    "line", ['#read("/../../../../../../etc/passwd")', '#import "@preview/tablex:0.0.8": *', "#oops"]
)
def test_a_style_that_cannot_be_used_is_refused(tmp_path: Path, line: str) -> None:
    style = tmp_path / "style"
    style.mkdir()
    own = (Path(__file__).parents[3] / "core/inspection_report/templates/style.typ").read_text(encoding="utf-8")
    (style / "style.typ").write_text(f"{own}\n{line}\n", encoding="utf-8")
    with pytest.raises(BadInput, match="cannot be set in this style"):
        form_of(RESULTS / "refused", Form.PDF, style)
    with pytest.raises(BadInput, match="is no folder"):
        form_of(RESULTS / "refused", Form.PDF, tmp_path / "absent")


def test_a_depth_is_told_where_it_was_measured_and_only_there(tmp_path: Path) -> None:
    measured = {"length": 3.5, "length_sigma": 0.2, "length_unit": "mm", "depth": 0.45, "depth_sigma": 0.1}
    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(measured))
    page, text = form_of(folder, Form.HTML).decode(), text_of(form_of(folder, Form.PDF))
    for told in (page, text):
        assert told.count("0.45 ± 0.1 mm") == 1
        assert told.count("wrong by its whole value") == 1
    rows = list(csv.DictReader(io.StringIO(form_of(folder, Form.CSV).decode())))
    assert [row["depth"] for row in rows].count("0.45") == 1
    assert sorted(row["depth_sigma"] for row in rows)[-1] == "0.1"
    assert "Depth" not in form_of(RESULTS / "two_models", Form.HTML).decode()
