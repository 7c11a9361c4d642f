"""The log of servers and workers: one line of printable JSON per event."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
CODE = """
import logging
from store import json_log
json_log.configure()
text = "two\\nlines \\x1b[31m\\x7f\\x9b\\u202e"
json_log.logger("ours").info("named", label=text)
logging.getLogger("a library").warning(text)
"""


def test_what_strangers_wrote_is_exact_and_not_obeyed() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], cwd=ROOT, capture_output=True, check=True)
    assert [byte for byte in done.stderr if not (0x20 <= byte < 0x7F or byte == 0x0A)] == []
    ours, library = (json.loads(line) for line in done.stderr.splitlines())
    assert ours["label"] == library["event"] == "two\nlines \x1b[31m\x7f\x9b\u202e"
