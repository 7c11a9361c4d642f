"""XML of strangers as a tree, without declarations of document types or entities: nothing can expand or be fetched."""

from __future__ import annotations

from typing import Any, NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from core.errors import BadInput

MAX_ELEMENTS = 2_000_000
"""As a tree they take about a gigabyte, half of what a stage may use."""
MAX_DEPTH = 64


def parse_xml(data: bytes, what: str = "annotations") -> Element:
    """The root of an XML document.

    Args:
        data: its bytes.
        what: it holds; messages say so and codes begin with it.

    Raises:
        BadInput: `WHAT_malformed` (with line and column), `WHAT_xml_declares` (a document type, the only place where
            entities can be declared), `WHAT_not_utf8` or `WHAT_too_large`.
    """
    builder = TreeBuilder()
    count = depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count, depth
        count, depth = count + 1, depth + 1
        if count > MAX_ELEMENTS or depth > MAX_DEPTH:
            raise _refused(
                what, f"has more than {MAX_ELEMENTS} elements, or nests them deeper than {MAX_DEPTH}", "too_large"
            )
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def declared(*_: Any) -> NoReturn:
        raise _refused(what, "declares a document type; that is not read", "xml_declares")

    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.StartDoctypeDeclHandler = declared
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        place = f"line {error.lineno}, column {error.offset + 1}"
        raise BadInput(
            f"not valid XML in the {what}: {expat.ErrorString(error.code)} at {place}",
            code=f"{what}_malformed",
            where=place,
        ) from None
    except (LookupError, ValueError):  # an encoding that Python does not know
        raise _refused(what, "is in an encoding that is not read; UTF-8 is", "not_utf8") from None
    return builder.close()


def _refused(what: str, why: str, code: str) -> BadInput:
    return BadInput(f"the XML of the {what} {why}", code=f"{what}_{code}", where=what)
