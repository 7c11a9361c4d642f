"""The `bladeatlas` command: parses, calls one function per subcommand, maps errors to exit codes."""

from __future__ import annotations

import importlib
import os
import sys
import traceback
from collections.abc import Sequence

from cli import arguments
from cli.exits import INTERNAL, INTERRUPTED, exit_code, one_line
from cli.terminal import guarded_stdout, say
from core.errors import BladeAtlasError, Cancelled


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code (see docs/outputs.md)."""
    parsed = arguments.parser().parse_args(argv)
    try:
        # The module of a subcommand is loaded only when it is called: `--help` loads no vision library.
        with guarded_stdout():
            return int(getattr(importlib.import_module(parsed.module), parsed.function)(parsed))
    except Cancelled:
        return INTERRUPTED
    except KeyboardInterrupt:
        say("bladeatlas: interrupted", error=True)
        return INTERRUPTED
    except BladeAtlasError as error:
        say(f"bladeatlas: {one_line(error)}", error=True)
        return exit_code(error)
    except BrokenPipeError:
        # The reader of our output went away (`bladeatlas options | head`): nothing is wrong.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:  # noqa: BLE001  (the last frame: whatever it is becomes one line and exit code 1)
        if parsed.traceback:
            say(*traceback.format_exc().splitlines(), error=True)
        hint = "" if parsed.traceback else " (--traceback shows more)"
        say(f"bladeatlas: internal error: {type(error).__name__}: {error}{hint}", error=True)
        return INTERNAL


if __name__ == "__main__":
    sys.exit(main())
