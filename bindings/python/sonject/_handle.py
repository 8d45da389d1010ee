"""Handles of the library as Python objects."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from .context import Context

Self = TypeVar("Self", bound="Handle")


class Handle:
    """Something that was made with a context and is released with its last reference, or sooner by
    close() or a with statement."""

    _noun = "handle"

    def __init__(self, context: "Context", pointer: Any) -> None:
        self._context = context
        self._pointer = pointer
        # The finalizer keeps the context alive, which must be released last.
        self._finalizer = weakref.finalize(self, context.release, pointer)
        context.adopt(self)

    @property
    def context(self) -> "Context":
        """The context that it was made with."""
        return self._context

    @property
    def pointer(self) -> Any:
        """The C handle. Raises ValueError once it is closed."""
        if not self._finalizer.alive:
            raise ValueError(f"this sonject {self._noun} was closed")
        return self._pointer

    def close(self) -> None:
        """Releases the library's memory now."""
        self._finalizer()

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
