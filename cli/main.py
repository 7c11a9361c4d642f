"""The `bladeatlas` command: parses, calls one function per subcommand, maps errors to exit codes."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence

from cli import arguments
from cli.exits import INTERNAL, INTERRUPTED, exit_code, one_line
from core.errors import BladeAtlasError, Cancelled


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code (see docs/outputs.md)."""
    parsed = arguments.parser().parse_args(argv)
    try:
        # The module of a subcommand is loaded only when it is called: `--help` loads no vision library.
        return int(importlib.import_module(parsed.module).command(parsed))
    except Cancelled:
        return INTERRUPTED
    except KeyboardInterrupt:
        print("bladeatlas: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BladeAtlasError as error:
        print(f"bladeatlas: {one_line(error)}", file=sys.stderr)
        return exit_code(error)
    except BrokenPipeError:
        # The reader of our output went away (`bladeatlas options | head`): nothing is wrong.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:  # the last frame: whatever it is becomes one line and exit code 1
        if parsed.traceback:
            raise
        print(f"bladeatlas: internal error: {type(error).__name__}: {error} (--traceback shows more)", file=sys.stderr)
        return INTERNAL


if __name__ == "__main__":
    sys.exit(main())
