"""Annotation files of any readable kind to entries: the one way in for the command line, the service and the stage."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

from core.annotations.checks import shown
from core.annotations.foreign import yolo
from core.annotations.foreign.archive import files_of_zip
from core.annotations.foreign.conversion import annotations_of
from core.annotations.foreign.formats import AUTO, FORMAT_NAMES, FORMATS, OWN, Format
from core.annotations.foreign.sheet import Sheet, Size
from core.annotations.foreign.unreadable import binary_kind, is_own, json_kind, text_kind, unreadable, xml_kind
from core.annotations.model import Annotations
from core.annotations.parse import parse_annotations
from core.annotations.read import parse_json, read_bytes
from core.errors import BadInput
from core.names import unknown_name
from core.xml_tree import parse_xml

_ZIP = b"PK"


def load_annotations(path: Path | None, frame: Size | None = None, form: str = AUTO) -> Annotations:
    """Read and check an annotation file; no file gives no annotations.

    Args:
        path: the file, in our own form or in that of another tool; which is told by its content.
        frame: width and height of the video's frames in pixels, when the video is known. Files in pixels are held
            against it.
        form: a name of `FORMAT_NAMES`; any other than ``auto`` is the only format that is tried.

    Raises:
        BadInput: nothing else leaves this function.
    """
    if form not in FORMAT_NAMES:
        raise BadInput(unknown_name("format", form, FORMAT_NAMES), where="input.annotation_format")
    return Annotations() if path is None else annotations_from(read_bytes(path), frame, form)


def annotations_from(data: bytes, frame: Size | None = None, form: str = AUTO) -> Annotations:
    """The same of a file's content. Its name says nothing: results are named by content, and uploads have no name."""
    if data.startswith(_ZIP):
        return _archive(data, frame, form)
    kind = binary_kind(data)
    if kind is not None:
        raise kind
    document = _document(data)
    if isinstance(document, str):
        raise text_kind(document)
    return _of_documents([("", document)], frame, form, [])


def _document(data: bytes) -> object:
    """A JSON value, the root of an XML document, or the text when it is neither."""
    start = data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1]
    if start == b"<":
        return parse_xml(data)
    if start in (b"{", b"["):
        return parse_json(data)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return parse_json(data)  # says what is wrong
    if not text.strip() or text.strip()[0] in '"-0123456789tfn':
        try:
            return parse_json(data)
        except BadInput:
            return text
    return text


def _archive(data: bytes, frame: Size | None, form: str) -> Annotations:
    documents: list[tuple[str, object]] = []
    texts: dict[str, str] = {}
    others: list[str] = []
    for name, content in files_of_zip(data):
        if content is None:
            others.append(name)
            continue
        text = _text(content)
        if text is None:
            others.append(name)
        elif text.lstrip()[:1] in ("{", "[", "<"):
            try:
                documents.append((name, _document(content)))
            except BadInput as error:
                if name.lower().endswith((".json", ".xml")):
                    raise BadInput(f"{name}: {error.message}", code=error.code, where=error.where) from None
                texts[name] = text
        else:
            texts[name] = text
    known = [
        (name, one)
        for name, one in documents
        if _candidates(one, form) or (form in (AUTO, OWN) and is_own(one) and one)  # tools leave empty objects about
    ]
    if known:
        return _of_documents(known, frame, form, [one for _, one in documents if not isinstance(one, Element)])
    rows = [text for name, text in texts.items() if name.lower().endswith(".txt") and yolo.is_label_text(text)]
    if rows and form in (AUTO, "yolo"):
        sheet = _sheet_of("yolo")
        yolo.read(texts, others, sheet)
        return replace(annotations_of(sheet, frame), format="yolo")
    if documents:
        raise _not_read(documents[0][1], form)
    kinds = Counter(name.rpartition(".")[2].lower() for name in (*texts, *others))
    held = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common(3)) or "nothing"
    raise unreadable(f"an archive that holds no annotations ({held})")


def _text(content: bytes) -> str | None:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None


def _of_documents(
    documents: Sequence[tuple[str, object]], frame: Size | None, form: str, beside: Sequence[object]
) -> Annotations:
    """Annotations of documents that are all of one format."""
    found: dict[str, Format | None] = {}
    for _, document in documents:
        candidates = _candidates(document, form)
        if candidates:
            found[candidates[0].title] = candidates[0]
        elif form in (AUTO, OWN) and (is_own(document) or form == OWN) and not isinstance(document, Element):
            found[OWN] = None
        else:
            raise _not_read(document, form)
    if len(found) > 1 or (OWN in found and len(documents) > 1):
        names = " and ".join(found)
        raise BadInput(
            f"the archive holds several files of annotations ({names}); name one of them, or the format by --format",
            code="annotations_unclear_format",
            where=shown(documents[0][0]),
        )
    (chosen,) = found.values()
    if chosen is None:
        return parse_annotations(documents[0][1])
    sheet = Sheet(chosen.drops)
    for name, document in documents:
        chosen.read(document, name, sheet, beside)
    return replace(annotations_of(sheet, frame), format=chosen.name)


def _sheet_of(name: str) -> Sheet:
    return Sheet(next(one.drops for one in FORMATS if one.name == name))


def _candidates(document: object, form: str) -> list[Format]:
    container = "xml" if isinstance(document, Element) else "json"
    return [
        one for one in FORMATS if form in (AUTO, one.name) and one.container == container and one.recognises(document)
    ]


def _not_read(document: object, form: str) -> BadInput:
    """The error for a document that is of no format, or not of the one that was asked for."""
    if form != AUTO:
        other = next(iter(_candidates(document, AUTO)), None)
        seems = f"; it seems to be {other.title}" if other is not None else ""
        return BadInput(
            f"the annotations cannot be read as {form}{seems}",
            code="annotations_unknown_format",
            where="input.annotation_format",
        )
    return xml_kind(document) if isinstance(document, Element) else json_kind(document)
