"""Pascal VOC: one XML file for each picture."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree.ElementTree import Element

from core.annotations.checks import invalid
from core.annotations.foreign.sheet import Points, Shape, Sheet, number_in_name
from core.annotations.foreign.values import number, size_of

DROPS = {"part": "part of an object", "no box": "object without a box", "actions": "set of actions"}


def recognises(root: Element) -> bool:
    """Whether an XML document is of Pascal VOC."""
    return root.tag == "annotation" and (root.find("object") is not None or root.find("filename") is not None)


def read(root: Element, name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read one picture; its number is in the name of the picture, else in that of the file."""
    known = (root.findtext("filename") or "").strip()
    known = known if any(char.isdigit() for char in known) else name
    size = size_of(root.findtext("size/width"), root.findtext("size/height"), "size")
    if size is None:
        raise invalid(
            "the file of Pascal VOC",
            "names no size of its picture (<size> with <width> and <height>); coordinates in pixels say nothing "
            "without it",
        )
    shapes = []
    for i, one in enumerate(root.findall("object")):
        shapes += _shape(one, f"object {i}", sheet)
    sheet.add(number_in_name(known), known, shapes, unit=size, size=size)


def _shape(one: Element, where: str, sheet: Sheet) -> list[Shape]:
    for kind, tag in (("part", "part"), ("actions", "actions")):
        sheet.drop(kind, len(one.findall(tag)))
    box = one.find("bndbox")
    if box is None:
        sheet.drop("no box")
        return []
    x1, y1, x2, y2 = (number(box.findtext(side) or "", f"{where}: {side}") for side in ("xmin", "ymin", "xmax", "ymax"))
    score = one.findtext("score") or one.findtext("confidence")
    return [
        Shape(
            one.findtext("name") or "",
            (x1, y1, x2, y2),
            _polygon(one.find("polygon"), where),
            None if score is None else number(score, f"{where}: score"),
        )
    ]


def _polygon(element: Element | None, where: str) -> Points | None:
    """Corners as Roboflow writes them: <x1>, <y1>, <x2>, <y2>, ..."""
    if element is None:
        return None
    values = {child.tag: number((child.text or "").strip(), f"{where}: polygon") for child in element}
    count = next((i for i in range(len(values) + 1) if f"x{i + 1}" not in values or f"y{i + 1}" not in values), 0)
    return tuple((values[f"x{i + 1}"], values[f"y{i + 1}"]) for i in range(count))
