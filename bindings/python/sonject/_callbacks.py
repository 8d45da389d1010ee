"""Python functions that C calls. What they raise is held until the call of the library is over."""

from __future__ import annotations

from typing import Any, Callable, Optional

from . import _structures as s

# Finished fraction 0...1 and the stage's name; a true answer asks to cancel.
Progress = Callable[[float, str], Any]


def text(line: Optional[bytes]) -> str:
    """A text of the library; damaged UTF-8 does not hide the rest of a message."""
    return (line or b"").decode("utf-8", "replace")


class ProgressBridge:
    """Calls a progress function.

    There is a callback even without a function, so that a pending KeyboardInterrupt finds Python
    code to be raised in.
    """

    def __init__(self, progress: Optional[Progress]) -> None:
        self.error: Optional[BaseException] = None
        self._progress = progress
        self.callback = s.sonject_progress_function(self._called)

    def _called(self, _user: Optional[int], fraction: float, stage: Optional[bytes]) -> int:
        try:
            if self._progress is None:
                return 0
            return int(bool(self._progress(fraction, text(stage))))
        except BaseException as error:  # goes on to the caller of the library
            self.error = error
            return 1


class LogBridge:
    """Calls a log function. Does not refer to the context, which would then live for ever."""

    def __init__(self, log: Callable[[str], Any]) -> None:
        self.error: Optional[BaseException] = None
        self._log = log
        self.callback = s.sonject_log_function(self._called)

    def _called(self, _user: Optional[int], line: Optional[bytes]) -> None:
        try:
            self._log(text(line))
        except BaseException as error:  # goes on to the caller of the library
            self.error = error
