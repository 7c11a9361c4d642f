"""`bladeatlas study`: write the folder of a study that asks people about two results."""

from __future__ import annotations

import argparse
from pathlib import Path

from cli.terminal import say, say_json
from core.study.build import ANSWERS, STUDY, build_study


def command(parsed: argparse.Namespace) -> int:
    """Write the study, and say what its scenes cannot answer and what to open."""
    out: Path = parsed.out
    lacks = build_study((parsed.first, parsed.second), out, parsed.contact, parsed.practice)
    page, answers = out / STUDY / "index.html", out / ANSWERS
    if parsed.json:
        say_json({"page": str(page), "answers": str(answers), "lacks": lacks})
        return 0
    for text in lacks:
        say(f"note: {text}")
    say(f"{page}  (open it in a browser; the folder needs nothing else)")
    say(f"{answers}  (keep it from those who take part; `bladeatlas-bench study` needs it)")
    return 0
