"""The page trusts nothing from the annotation file and needs nothing but its own folder."""

from __future__ import annotations

import base64
import hashlib
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from core.gallery.boxes import FrameBoxes
from core.gallery.defects import defect_lines
from core.gallery.page import gallery_page
from core.gallery.palette import label_colors
from core.scene.defect import DefectRecord, Sighting
from core.scene.frame import SourceFrame
from core.thesis.grouping import cluster_detections, event_rows, with_defect_ids
from tests.core.gallery.hostile import NASTY, hostile_page
from tests.core.making_rows import defect, mapped, run_frames, unplaced

FORMER = Path(__file__).parents[2] / "data" / "gallery" / "hostile.html"
"""The page as version 0.1.0 wrote it, by hand, from the same rows."""


class Reader(HTMLParser):
    """Collects elements, attributes and text of the body."""

    def __init__(self) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.pieces: list[object] = []
        """Everything in its order: elements, their ends, and texts without the space around them."""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self.pieces.append(self.elements[-1])

    def handle_endtag(self, tag: str) -> None:
        self.pieces.append(tag)

    def handle_data(self, data: str) -> None:
        self.text += data
        self.pieces += [text] if (text := " ".join(data.split())) else []

    def of(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def record(number: int, label: str) -> DefectRecord:
    seen = (Sighting(number, 1.0, (0.5, 0.5), True),)
    return defect(number, label, centroid=(10.0 * number, 0.0, 0.0), frames=seen)


def page(labels: list[str], shown: int | None = None) -> tuple[str, Reader]:
    rows = [mapped(i, (i * 10.0, 0, 0), float(i), label) for i, label in enumerate(labels)]
    rows += [unplaced(len(labels), "no_frame", source_index=None)]
    clusters = cluster_detections(rows, 1.0)
    rows = with_defect_ids(rows, clusters)
    frames = [FrameBoxes(SourceFrame(0, i), float(i), (rows[i],)) for i in range(len(labels))]
    colors = label_colors([row.label for row in rows])
    events = event_rows(clusters)
    records = [record(number, labels[number]) for number in range(len(clusters))]
    used = run_frames(len(labels), 1.0)
    html = gallery_page(frames[:shown], len(frames), rows, defect_lines(records, events, used), colors)
    reader = Reader()
    reader.feed(html)
    return html, reader


@pytest.mark.parametrize("label", NASTY)
def test_labels_are_only_ever_text(label: str) -> None:
    harmless, nasty = page(["plain"])[1], page([label])[1]
    assert [tag for tag, _ in nasty.elements] == [tag for tag, _ in harmless.elements]
    names = [sorted(attributes) for _, attributes in harmless.elements]
    assert [sorted(attributes) for _, attributes in nasty.elements] == names
    assert label in nasty.text
    assert label in [item["data-label"] for item in nasty.of("li")]


def test_the_policy_allows_only_the_pages_own_script() -> None:
    html, reader = page(["dent"])
    policy = next(meta["content"] for meta in reader.of("meta") if "http-equiv" in meta)
    script = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script[0].encode()).digest()).decode()
    assert len(script) == 1
    assert f"script-src 'sha256-{digest}'" in str(policy)
    assert "default-src 'none'" in str(policy)


def test_nothing_comes_from_a_network() -> None:
    html, reader = page(["dent", "crack"])
    assert "//" not in "".join(str(a.get("src") or a.get("href")) for _, a in reader.elements)
    assert "http://" not in html
    assert "https://" not in html


def test_every_defect_links_to_a_frame_and_every_detection_to_its_defect() -> None:
    _, reader = page(["dent", "crack"])
    assert [button["data-defect"] for button in reader.of("button") if "data-defect" in button] == ["0", "1"]
    assert [item["data-defect"] for item in reader.of("li")] == ["0", "1"]
    links = [a["href"] for a in reader.of("a")]
    assert {"mesh_1.png", "mesh_2.png", "frame_000000.jpg", "frame_000001.jpg"} <= set(links)
    assert all(image["alt"] or image == {"alt": ""} for image in reader.of("img"))


def test_the_table_says_how_large_a_defect_is() -> None:
    html, reader = page(["dent", "crack"])
    table = html.split("<thead>")[1].split("</table>")[0]
    assert "<th>Size</th>" in table
    assert "Radius" not in table
    assert "0.5 ± 0.062 model units" in reader.text
    assert "1 of 2 frames" in reader.text


def test_a_label_turns_no_text_around_it() -> None:
    html, _ = page(["\u202egnp.exe"])
    assert html.count("<bdi>\u202egnp.exe</bdi>") == 2


def test_says_what_it_leaves_out() -> None:
    _, reader = page(["dent", "crack", "nick"], shown=2)
    assert "2 of 3 frames are shown" in reader.text
    assert "1 detections lie outside the video" in reader.text


def test_an_inspection_without_detections_has_a_page() -> None:
    html = gallery_page([], 0, [], [], {})
    assert "No defect was placed on the surface." in html
    assert "no detection inside the video" in html


@pytest.mark.parametrize(("models", "says"), [((0, 0, 0), ", 3 defects"), ((0, 1, 1), ", 2 to 3 defects")])
def test_defects_of_several_models_are_a_range(models: tuple[int, ...], says: str) -> None:
    used = run_frames(3, 1.0)
    lines = defect_lines([replace(record(n, "dent"), model=model) for n, model in enumerate(models)], [], used)
    html = gallery_page([], 0, [], lines, {})
    assert f"{says}</p>" in html
    assert ("counted twice" in html) == (len(set(models)) > 1)


def test_the_page_says_what_it_said_when_it_was_written_by_hand() -> None:
    former, now = Reader(), Reader()
    former.feed(FORMER.read_text(encoding="utf-8"))
    now.feed(hostile_page())
    assert len(former.pieces) > 300
    assert now.pieces == former.pieces
