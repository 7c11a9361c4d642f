"""argparse, with negative numbers as values and errors of one line."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from cli.terminal import say

_NEGATIVE = re.compile(r"-(\d|\.\d|inf|nan)", re.IGNORECASE)
_BAD_USAGE = 2


class Parser(argparse.ArgumentParser):
    """A parser whose subcommands are parsers of the same kind."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:  # the base class has overloads
        """Parse, with `--point -3.6,0.5,12.7` read as `--point=-3.6,0.5,12.7`."""
        return super().parse_known_args(with_negative_values(sys.argv[1:] if args is None else args), namespace)

    def error(self, message: str) -> NoReturn:
        """Say what is wrong in one line and exit with the code of bad input."""
        say(f"bladeatlas: {message} (see {self.prog} --help)", error=True)
        self.exit(_BAD_USAGE)


def with_negative_values(args: Sequence[str]) -> list[str]:
    """The arguments, each negative number or list of numbers joined with the option before it.

    Alone, argparse takes all but a single plain negative number for an option.
    """
    joined: list[str] = []
    for word in args:
        option = joined[-1] if joined else ""
        if _NEGATIVE.match(word) and option.startswith("--") and option != "--" and "=" not in option:
            joined[-1] = f"{option}={word}"
        else:
            joined.append(word)
    return joined
