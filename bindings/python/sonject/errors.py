"""What the package raises when the library refuses."""

from __future__ import annotations

from .enumerations import Status


class SonjectError(Exception):
    """A call of the library failed.

    status: which kind of failure; message: says what is wrong and where, in one line, or in
    one for each mistake of a scene or campaign file.
    """

    def __init__(self, status: Status, message: str) -> None:
        super().__init__(status, message)
        self.status = status
        self.message = message

    def __str__(self) -> str:
        return self.message


class Cancelled(SonjectError):
    """The progress function asked to stop. Nothing was published."""
