"""Arguments that several commands of the bench share."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_results(parser: argparse.ArgumentParser, more: str = "") -> None:
    """Declare ``--result RESULT TRUTH``, any number of them: `results` is a list of pairs of folders.

    Args:
        parser: of the command.
        more: what its help says beside.
    """
    parser.add_argument(
        "--result",
        dest="results",
        type=Path,
        nargs=2,
        action="append",
        default=[],
        metavar=("RESULT", "TRUTH"),
        help="a result folder and the truth about its clip (repeatable)" + (f"; {more}" if more else ""),
    )
