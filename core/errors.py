"""The one tree of expected errors.

Every class carries a stable `code`; the worker decides from `retryable` and the code what is retried, the API maps
codes to HTTP, the command line maps classes to exit codes. Nothing here knows about any of them. Layers above `core`
add errors of their own as subclasses, beside the code that raises them.
"""

from __future__ import annotations

from collections.abc import Mapping


class BladeAtlasError(Exception):
    """Base of all expected errors: a code, one clear sentence, and where it happened."""

    code = "internal"
    retryable = False

    def __init__(self, message: str, *, code: str | None = None, where: str = "", **context: object) -> None:
        super().__init__(message)
        self.message = message
        self.code = code or type(self).code
        self.where = where
        self.context = context

    def to_dict(self) -> dict[str, object]:
        """JSON form that crosses process borders; see `error_from_dict`."""
        return {
            "kind": type(self).__name__,
            "code": self.code,
            "message": self.message,
            "where": self.where,
            "retryable": self.retryable,
        }


class ProgrammingError(BladeAtlasError):
    """A mistake in our code, never something that the input says: it stops a run, whichever task meets it."""


class BadInput(BladeAtlasError):
    """The user's file or parameter is wrong. Never retried."""

    code = "bad_input"


class NoReconstruction(BladeAtlasError):
    """The video gave no model that can be trusted. An outcome, never retried."""

    code = "no_reconstruction"


class StageFailed(BladeAtlasError):
    """A stage could not make its result from valid input. Never retried."""

    code = "stage_failed"


class ResourceError(BladeAtlasError):
    """Memory, time or another resource of the machine ran out.

    Retried by the runner within its limits, unless the same would happen again: a task that exceeded its memory
    (`oom`) or its time (`timeout`) fails at once, and a full disk (`DiskFull`) stops the run.
    """

    code = "resource"
    retryable = True


class DiskFull(ResourceError):
    """No space left, or the folder cannot be written."""

    code = "disk_full"
    retryable = False


class Cancelled(BladeAtlasError):
    """Somebody asked to stop."""

    code = "cancelled"


_KINDS: dict[str, type[BladeAtlasError]] = {
    kind.__name__: kind
    for kind in (
        BladeAtlasError,
        ProgrammingError,
        BadInput,
        NoReconstruction,
        StageFailed,
        ResourceError,
        DiskFull,
        Cancelled,
    )
}


def error_from_dict(data: Mapping[str, object]) -> BladeAtlasError:
    """Rebuild the error that `BladeAtlasError.to_dict` described; an unknown kind becomes the base."""
    kind = _KINDS.get(str(data.get("kind")), BladeAtlasError)
    return kind(str(data.get("message", "")), code=str(data.get("code", kind.code)), where=str(data.get("where", "")))
