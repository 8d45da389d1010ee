"""The exceptions for failed calls of the library."""

from __future__ import annotations

from .enumerations import Status


class SonjectError(Exception):
    """A failed call of the library.

    status: the kind of failure. message: names what is wrong and where, in one line, or in one line
    for each mistake of a scene or campaign file.
    """

    def __init__(self, status: Status, message: str) -> None:
        super().__init__(status, message)
        self.status = status
        self.message = message

    def __str__(self) -> str:
        return self.message


class Cancelled(SonjectError):
    """A call that the progress function asked to stop. Nothing was published."""
