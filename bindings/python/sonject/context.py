"""Contexts, one device each, and the handles made with them."""

from __future__ import annotations

import collections
import contextlib
import ctypes
import importlib
import logging
import signal
import threading
import weakref
from typing import Any, Callable, Iterator, Optional, Sequence, Type, TypeVar, Union

from . import _interface as s
from ._classes import Device as Device
from ._library import load
from ._values import filled, optional_file_name, text
from .enumerations import Status
from .errors import Cancelled, SonjectError


# A function called with the finished fraction 0...1, 1 at the end, and the stage's name; a true
# answer cancels. True: a bar by tqdm, or nothing if tqdm is not installed.
Progress = Union[bool, Callable[[float, str], Any]]


class Bar:
    """A progress bar by tqdm."""

    def __init__(self, tqdm: Any) -> None:
        self._bar = tqdm(total=1.0, bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")

    def __call__(self, fraction: float, stage: str) -> None:
        self._bar.set_description_str(stage, refresh=False)
        self._bar.update(fraction - self._bar.n)

    def close(self) -> None:
        """Leaves the bar where the work ended."""
        self._bar.close()


def _new_bar() -> Optional[Bar]:
    try:
        return Bar(importlib.import_module("tqdm.auto").tqdm)
    except ImportError:
        return None


class SignalBridge:
    """Keeps what the handlers of signals raise during a call, such as KeyboardInterrupt, for its end.

    Python calls handlers when a callback begins, before its first line. Nothing there could catch
    what they raise: ctypes would print it and go on.
    """

    _NUMBERS = [
        getattr(signal, name) for name in ("SIGALRM", "SIGTERM", "SIGINT") if hasattr(signal, name)
    ]

    def __init__(self) -> None:
        self.error: Optional[BaseException] = None
        self._handlers: dict[int, Any] = {}

    def _called(self, number: int, frame: Any) -> None:
        try:
            self._handlers[number](number, frame)
        except BaseException as error:  # raised again for the caller of the library
            self.error = error

    def _stand_before(self) -> None:
        for number in self._NUMBERS:
            handler = signal.getsignal(number)
            if callable(handler):
                self._handlers[number] = handler
                try:
                    signal.signal(number, self._called)
                except ValueError:  # Python runs within a program whose main thread is another
                    del self._handlers[number]

    @contextlib.contextmanager
    def keeping(self) -> Iterator[None]:
        """Stands before the handlers that are written in Python. Only the main thread may do so."""
        try:
            if threading.current_thread() is threading.main_thread():
                self._stand_before()
            yield
        finally:
            for number, handler in self._handlers.items():
                if signal.getsignal(number) == self._called:
                    signal.signal(number, handler)


class ProgressBridge:
    """Calls a progress function.

    There is a callback even without a function, so that Python calls the handlers of signals.
    """

    def __init__(self, progress: Optional[Progress]) -> None:
        self.error: Optional[BaseException] = None
        self.signals = SignalBridge()
        self._progress = None if isinstance(progress, bool) else progress
        self._bar = _new_bar() if progress is True else None
        self.callback = s.sonject_progress_function(self._called)

    def _called(self, _user: Optional[int], fraction: float, stage: Optional[bytes]) -> int:
        if self.signals.error is not None:
            return 1
        try:
            function = self._progress if self._bar is None else self._bar
            return 0 if function is None else int(bool(function(fraction, text(stage))))
        except BaseException as error:  # raised again for the caller of the library
            self.error = error
            return 1

    def close(self) -> None:
        """Ends the bar at the end of the work."""
        if self._bar is not None:
            self._bar.close()


class LogBridge:
    """Calls a log function. It holds no reference to the context, which would then live for ever."""

    def __init__(self, log: Callable[[int, str], Any]) -> None:
        self.error: Optional[BaseException] = None
        self._log = log
        self.callback = s.sonject_log_function(self._called)

    def _called(self, _user: Optional[int], level: int, line: Optional[bytes]) -> None:
        try:
            self._log(logging.WARNING if level else logging.INFO, text(line))
        except BaseException as error:  # raised again for the caller of the library
            self.error = error


def counted(number: int, word: str) -> str:
    """Returns "1 object", "2 objects" and so on."""
    return f"{number} {word}" if number == 1 else f"{number} {word}s"


Self = TypeVar("Self", bound="Handle")


class Handle:
    """An object made with a context; released by its last reference, close() or a with statement."""

    _noun = "handle"

    def __init__(self, context: "Context", pointer: Any) -> None:
        self._context = context
        self._pointer = pointer
        # The finalizer keeps the context alive: the context must be released last.
        self._finalizer = weakref.finalize(self, context.release, pointer)
        context.adopt(self)

    @property
    def context(self) -> "Context":
        """The context that this was made with."""
        return self._context

    @property
    def pointer(self) -> Any:
        """The C handle. Raises ValueError once it was closed."""
        if not self._finalizer.alive:
            raise ValueError(f"this sonject {self._noun} was closed")
        return self._pointer

    def _summary(self) -> str:
        raise NotImplementedError

    def __repr__(self) -> str:
        """Returns one line, whatever the state."""
        try:
            told = " " + self._summary()
        except (RuntimeError, SonjectError, ValueError) as error:  # in a callback; a wrong scene; closed
            told = ": " + str(error).partition("\n")[0]
        return f"<sonject.{type(self).__name__}{told}>"

    def close(self) -> None:
        """Releases the library's memory now."""
        self._finalizer()

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


class Context:
    """One device, and the calls that use it.

    device: part of the device's name; None: the one named by SONJECT_DEVICE, else a GPU, else
    native, this processor. log: called like a logger's log, with a level of logging and a line; the
    level is WARNING for notes that a user must see, else INFO. None: the log of the logger
    "sonject". decodes_in_process: reads images and HDF5 in this process instead of a child (a
    damaged file may end this process). threads: of a launch on native; 0: one per processor.

    Calls from several threads on one context wait for each other; use a context per thread to work
    at once. The device native works in forked children, too. OpenCL's devices are refused in a
    child whose parent used OpenCL.
    """

    def __init__(
        self,
        device: Optional[str] = None,
        log: Optional[Callable[[int, str], Any]] = None,
        decodes_in_process: bool = False,
        threads: int = 0,
    ) -> None:
        self._library = load()
        self._device = device
        self._lock = threading.Lock()
        self._owner: Optional[int] = None
        self._waiting: collections.deque[Any] = collections.deque()
        self._handles: weakref.WeakValueDictionary[int, Handle] = weakref.WeakValueDictionary()
        self._log = LogBridge(logging.getLogger("sonject").log if log is None else log)
        params = filled(
            s.sonject_context_params,
            device_name=optional_file_name("device", device),
            decodes_in_process=int(decodes_in_process),
            threads=threads,
        )
        params.log = self._log.callback
        self._pointer = ctypes.POINTER(s.sonject_context)()
        status = self._library.sonject_context_create(
            ctypes.byref(params), ctypes.byref(self._pointer)
        )
        if status != Status.OK:
            name = text(self._library.sonject_status_name(status))
            raise SonjectError(Status(status), f"the context cannot be made: {name}")
        self._finalizer = weakref.finalize(self, _release_context, self._pointer, self._log)

    def close(self) -> None:
        """Releases the context, after the scenes and results made with it."""
        for handle in list(self._handles.values()):
            handle.close()
        if self._finalizer.alive:
            with self._exclusive():
                pass  # waits for a running call, and releases the handles that waited for its end
            self._finalizer()

    def __repr__(self) -> str:
        told = "on the default device" if self._device is None else f"on {self._device}"
        return f"<sonject.Context {told if self.is_usable else 'that was closed'}>"

    def __enter__(self) -> "Context":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def devices(self) -> list[Device]:
        """Lists the devices: native, then OpenCL's."""
        count = ctypes.c_size_t()
        self.call("sonject_devices", self, None, 0, ctypes.byref(count))
        found = (s.sonject_device_info * count.value)()
        self.call("sonject_devices", self, found, len(found), ctypes.byref(count))
        return [Device.from_structure(info) for info in found[: count.value]]

    @property
    def pointer(self) -> Any:
        """The C handle. Raises ValueError once the context is closed."""
        if not self._finalizer.alive:
            raise ValueError("this sonject context was closed")
        return self._pointer

    @property
    def is_usable(self) -> bool:
        """False once the context is closed."""
        return self._finalizer.alive

    def call(self, name: str, *arguments: Any, bridge: Optional[ProgressBridge] = None) -> None:
        """Calls the library function name, which returns a status.

        Handles among the arguments stand for their pointers. Raises exceptions of the handlers of
        signals and of callbacks first, then SonjectError.
        """
        signals = SignalBridge() if bridge is None else bridge.signals
        try:
            with self._exclusive(), signals.keeping():
                # Pointers are read under the lock: another thread may close a handle before.
                values = [
                    each.pointer if isinstance(each, (Handle, Context)) else each
                    for each in arguments
                ]
                status = getattr(self._library, name)(*values)
                message = ""
                if status != Status.OK:
                    message = text(self._library.sonject_context_message(self._pointer))
        finally:
            if bridge is not None:
                bridge.close()
        for callback in (signals, bridge, self._log):
            if callback is not None and callback.error is not None:
                error, callback.error = callback.error, None
                raise error
        if status == Status.CANCELLED:
            raise Cancelled(Status.CANCELLED, message)
        if status != Status.OK:
            raise SonjectError(Status(status), message)

    def work(
        self,
        name: str,
        *arguments: Any,
        progress: Optional[Progress],
        outputs: Sequence[Any] = (),
    ) -> None:
        """Calls a function with a progress callback behind its arguments, and outputs last."""
        bridge = ProgressBridge(progress)
        self.call(name, *arguments, bridge.callback, None, *outputs, bridge=bridge)

    def complete(self, name: str, *arguments: Any, progress: Optional[Progress]) -> bool:
        """Does work that may have been finished before; returns whether there was anything to do."""
        was_finished = ctypes.c_int()
        self.work(name, *arguments, progress=progress, outputs=[ctypes.byref(was_finished)])
        return not was_finished.value

    def text(self, name: str, *arguments: Any) -> str:
        """Calls the library function name, whose last parameter gets a text."""
        line = ctypes.c_char_p()
        self.call(name, *arguments, ctypes.byref(line))
        try:
            return text(line.value)
        finally:
            self._library.sonject_text_release(ctypes.byref(line))

    def make(
        self,
        kind: Type[ctypes.Structure],
        name: str,
        *arguments: Any,
        bridge: Optional[ProgressBridge] = None,
    ) -> Any:
        """Calls the library function name, whose last parameter gets a new handle of kind."""
        pointer = ctypes.POINTER(kind)()
        try:
            self.call(name, *arguments, ctypes.byref(pointer), bridge=bridge)
        except BaseException:
            if pointer:  # made, but a callback raised an exception
                self.release(pointer)
            raise
        return pointer

    def adopt(self, handle: Handle) -> None:
        """Registers a handle to be closed before the context."""
        self._handles[id(handle)] = handle  # scenes have no hash

    def release(self, pointer: Any) -> None:
        """Gives a handle back to the library."""
        # This runs wherever Python collects garbage, perhaps inside a callback of a running call.
        # The release then waits for that call's end: a context works for one thread at a time.
        self._waiting.append(pointer)
        if self._lock.acquire(blocking=False):
            try:
                self._release_waiting()
            finally:
                self._lock.release()

    def _release_waiting(self) -> None:
        while self._waiting:
            pointer = self._waiting.popleft()
            release = getattr(self._library, pointer._type_.__name__ + "_release")
            release(ctypes.byref(pointer))

    @contextlib.contextmanager
    def _exclusive(self) -> Iterator[None]:
        if self._owner == threading.get_ident():
            raise RuntimeError("a sonject context cannot be used within its own callbacks")
        with self._lock:
            self._owner = threading.get_ident()
            try:
                yield
            finally:
                self._owner = None
                self._release_waiting()


def _release_context(pointer: Any, _log: LogBridge) -> None:
    load().sonject_context_release(ctypes.byref(pointer))


_of_thread = threading.local()


def default_context() -> Context:
    """Returns the calling thread's own context on the default device."""
    context: Optional[Context] = getattr(_of_thread, "context", None)
    if context is None or not context.is_usable:
        context = Context()
        _of_thread.context = context
    return context


def devices() -> list[Device]:
    """Lists the devices: native, then OpenCL's."""
    return default_context().devices()
