"""The border between this program and the terminal: everything that is printed as text goes through here.

Labels, file names, codec names and a server's messages are written by strangers. A terminal obeys control
characters in them, and a line break makes one line look like two, so all of these are shown as what they are.
"""

from __future__ import annotations

import json
import sys
import unicodedata
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO, cast

if TYPE_CHECKING:
    from rich.console import Console

_UNSAFE = ("Cc", "Cs", "Zl", "Zp")
"""Categories of control characters, halves of surrogate pairs, and separators of lines and paragraphs."""
_BIDI = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Characters that turn the direction of what follows."""
_DEL = "\x7f"


def visible(text: str, keep: str = "") -> str:
    """The text with every character that a terminal would obey written out, e.g. ``\\x1b``, ``\\n``, ``\\u202e``.

    Args:
        text: anything.
        keep: characters that stay as they are.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(char if char in keep or not _obeyed(char) else _written_out(char) for char in text)


def _obeyed(char: str) -> bool:
    return char in _BIDI or unicodedata.category(char) in _UNSAFE


def _written_out(char: str) -> str:
    # JSON leaves only DEL as it is, and knows this spelling of it: so a JSON text stays one.
    return "\\u007f" if char == _DEL else char.encode("unicode_escape").decode("ascii")


def say(*lines: str, error: bool = False) -> None:
    """Print lines, on standard output or on standard error. A line break inside of one is shown, not obeyed."""
    stream = sys.stderr if error else sys.stdout
    for line in lines:
        print(_encodable(visible(line), stream), file=stream, flush=True)


def say_json(value: Mapping[str, Any], indent: int | None = None, stream: TextIO | None = None) -> None:
    """Print a JSON object: exact, and of printable ASCII only."""
    text = json.dumps(dict(value), indent=indent, allow_nan=False)
    print(visible(text, keep="\n"), file=stream or sys.stdout, flush=True)


@contextmanager
def guarded_stdout() -> Iterator[None]:
    """Whatever is printed on standard output inside, by any code: only printable characters and line ends pass."""
    raw = sys.stdout
    sys.stdout = cast(TextIO, _Guard(raw))  # it has what `print` needs
    try:
        yield
    finally:
        sys.stdout = raw


class _Guard:
    def __init__(self, raw: TextIO) -> None:
        self.raw = raw

    def write(self, text: str) -> int:
        self.raw.write(_encodable(visible(text, keep="\n"), self.raw))
        return len(text)

    def flush(self) -> None:
        self.raw.flush()


def console(*, error: bool) -> Console:
    """Rich's console, whose own control characters must reach the terminal: give it only what `visible` gave."""
    from rich.console import Console  # few commands draw

    stream = sys.stderr if error else sys.stdout
    return Console(file=getattr(stream, "raw", stream))


def _encodable(text: str, stream: object) -> str:
    """The text without what the terminal's encoding lacks: that is written out as well."""
    encoding = getattr(stream, "encoding", None) or "utf-8"
    return text.encode(encoding, "backslashreplace").decode(encoding)


def duration(seconds: float) -> str:
    """``4.2 s``, ``3 min 05 s``, ``2 h 07 min``."""
    if seconds < 59.95:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    return f"{minutes // 60} h {minutes % 60:02d} min"
