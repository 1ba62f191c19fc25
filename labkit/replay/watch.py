"""A watch over a live controller that ends one that is too slow or never returns, and says why."""

from __future__ import annotations

import ctypes
import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from pathlib import Path
from statistics import median

from ..errors import LabkitError

PATIENCE = 1.0
"""A controller that has not returned after this long, in [s], is ended."""

GIVES_UP = 4.0
"""A controller that still has not returned after this long, in [s], requires a new kernel."""

SLOW, CALLS = 1.0, 40
"""Least total duration, in [s], and least number of calls by which a controller is judged."""

TURN = 5e-4
"""Switch interval of Python's threads while an arm is live, in [s], lest other cells delay it."""

_LOOK = 0.05  # period of the watch, in [s]


class _Turns:
    """Switches threads often while an arm is live, and as usual after the last one has ended."""

    _lock, _live, _usual = threading.Lock(), 0, 0.0

    def __enter__(self) -> None:
        with _Turns._lock:
            if not _Turns._live:
                _Turns._usual = sys.getswitchinterval()
                sys.setswitchinterval(TURN)
            _Turns._live += 1

    def __exit__(self, *_: object) -> None:
        with _Turns._lock:
            _Turns._live -= 1
            if not _Turns._live:
                sys.setswitchinterval(_Turns._usual)


class _Ended(BaseException):
    """Raised in a controller that does not return; a student's `except Exception` misses it."""


class TooSlow(LabkitError):
    """A controller takes longer than a tick."""


class Watch:
    """Measures how long each call of a controller takes."""

    def __init__(self, period: float, say: Callable[[str], None]) -> None:
        """Watch a controller called once in a period [s]; ``say`` is called if it gets stuck."""
        self._period, self._say = period, say
        self._calls, self._within, self._since, self._name = 0, False, 0.0, ""
        self._times: deque[float] = deque(maxlen=round(1.0 / period))

    def begins(self, name: str) -> None:
        """Note that a call of the controller with this name begins."""
        self._calls += 1
        if name != self._name:
            self._times.clear()
        self._name, self._since, self._within = name, time.perf_counter(), True

    def ends(self) -> None:
        """Note that the call has returned, or that the run is over."""
        if self._within:
            self._times.append(time.perf_counter() - self._since)
        self._within = False

    def check_pace(self) -> None:
        """Raise `TooSlow` if half of the recent calls took longer than a period."""
        times = self._times
        if len(times) >= CALLS and sum(times) > SLOW and median(times) > self._period:
            took = 1e3 * median(self._times)
            self._times.clear()
            raise TooSlow(
                f"{self._name} takes {took:.1f} ms, but is called every {1e3 * self._period:g} "
                "ms; make it faster, or give live(..., rate=...) a lower rate"
            )

    def over(self, thread: threading.Thread) -> None:
        """Watch the controllers of ``thread`` as long as it lives."""
        threading.Thread(target=self._look, args=(thread,), daemon=True).start()

    def _look(self, thread: threading.Thread) -> None:
        """End a controller that stays in the same call for `PATIENCE`.

        Checks are counted instead of seconds, because this thread also waits while another cell
        holds Python's lock.
        """
        looks, call = 0, -1
        with _Turns():
            while thread.is_alive():
                time.sleep(_LOOK)
                looks = looks + 1 if self._within and self._calls == call else 0
                call = self._calls
                if looks and looks % round(PATIENCE / _LOOK) == 0:
                    since = _LOOK * looks
                    way_out = (
                        "it is being ended"
                        if since < GIVES_UP
                        else "it could not be ended so far: perhaps a bare `except:` in it catches "
                        "everything. If it goes on, choose Kernel, Restart Kernel"
                    )
                    self._say(f"{self._name} has not returned for {since:.0f} s; {way_out}")
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(
                        ctypes.c_ulong(thread.ident or 0), ctypes.py_object(_Ended)
                    )


def sentence(error: BaseException, name: str) -> str:
    """The reason why the arm stopped, with the student's line that caused it."""
    if isinstance(error, _Ended):
        what = f"{name} did not return; does every loop in it end?"
    elif isinstance(error, LabkitError):
        what = str(error).replace("error.log", "view.log")
    else:
        what = f"{type(error).__name__}: {error}"
    steps = traceback.extract_tb((error.__cause__ or error).__traceback__)
    own = [step.line for step in steps if step.line and not _library(step.filename)]
    return f"{what} (line: {own[-1]})" if own else what


def _library(file: str) -> bool:
    """Whether a file belongs to labkit or to an installed package."""
    return file.startswith(str(Path(__file__).parents[1])) or "site-packages" in file
