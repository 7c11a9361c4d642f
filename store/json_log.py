"""Structured logs: an event's name and its data as keywords, one JSON line each in a server."""

from __future__ import annotations

import logging
import sys
from typing import Any

import structlog
from structlog.typing import EventDict, Processor

_SHARED: tuple[Processor, ...] = (
    structlog.contextvars.merge_contextvars,
    structlog.stdlib.add_log_level,
    structlog.stdlib.add_logger_name,
    structlog.processors.TimeStamper(fmt="iso", utc=True),
    structlog.processors.format_exc_info,
)


def logger(name: str) -> structlog.stdlib.BoundLogger:
    """A logger that speaks through the standard library: silent below warnings until `configure` was called."""
    wrapped: structlog.stdlib.BoundLogger = structlog.wrap_logger(
        logging.getLogger(name),
        processors=[
            structlog.stdlib.filter_by_level,
            *_SHARED,
            structlog.stdlib.ProcessorFormatter.wrap_for_formatter,
        ],
        wrapper_class=structlog.stdlib.BoundLogger,
    )
    return wrapped


def configure(level: str = "INFO") -> None:
    """Write everything that this process logs, libraries included, as JSON lines to stderr."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=_SHARED,
            processors=[_without_colours, structlog.processors.JSONRenderer(), _printable],
        )
    )
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel(level)
    structlog.configure(
        processors=[
            structlog.stdlib.filter_by_level,
            *_SHARED,
            structlog.stdlib.ProcessorFormatter.wrap_for_formatter,
        ],
        logger_factory=structlog.stdlib.LoggerFactory(),
        wrapper_class=structlog.stdlib.BoundLogger,
    )


def _printable(_logger: object, _method: str, line: Any) -> str:
    """JSON writes every control character out but DEL, in texts of strangers too."""
    return str(line).replace("\x7f", "\\u007f")


def _without_colours(_logger: object, _method: str, event: EventDict) -> EventDict:
    """Drop what only concerns the formatter, and uvicorn's second, coloured copy of its message."""
    for name in ("color_message", "_record", "_from_structlog"):
        event.pop(name, None)
    return event
