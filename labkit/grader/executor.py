"""Executors, which call functions in worker processes of this machine or of a Dask cluster.

Both kinds are a `concurrent.futures.Executor`.  A worker that dies affects no call but its own.
Arguments and results are pickled, which is safe because they are the grader's own.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any

from ..errors import LabkitError


@contextmanager
def executor(workers: int, dask: str | None = None) -> Iterator[Executor]:
    """An executor for a ``with`` block; an exception in the block ends all running calls.

    Args:
        workers: How many processes of this machine there are.
        dask: The address of a Dask scheduler to use instead; give it to loopback or TLS.

    Raises:
        LabkitError: The package ``distributed`` is missing, or no scheduler answers there.
    """
    with ExitStack() as stack:
        if dask is None:
            pool: Executor = LocalExecutor(workers)
            os.environ["PYTHONSAFEPATH"] = "1"  # workers import nothing from where this runs
            stack.callback(os.environ.pop, "PYTHONSAFEPATH", None)
        else:
            try:
                from distributed import Client

                client = stack.enter_context(Client(dask, timeout="10s", set_as_default=False))
            except ImportError:
                raise LabkitError("Dask is missing; type: pip install 'labkit[cluster]'") from None
            except (OSError, ValueError) as error:
                raise LabkitError(f"no Dask scheduler at {dask}: {error}") from None
            pool = client.get_executor(pure=False)
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False)
            raise
        pool.shutdown()


class LocalExecutor(Executor):
    """Processes of this machine, each in its own pool, so that a crash affects one task only.

    Args:
        workers: How many processes there are; each starts when it is first needed.
    """

    def __init__(self, workers: int) -> None:
        self._threads = ThreadPoolExecutor(workers, initializer=_block_interrupts)
        self._idle: SimpleQueue[ProcessPoolExecutor | None] = SimpleQueue()
        for _ in range(workers):
            self._idle.put(None)
        self._end, self._open = Pipe(duplex=False)

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call a function in one of the processes."""
        return self._threads.submit(self._call, partial(function, *args, **kwargs))

    def _call(self, task: Callable[[], Any]) -> Any:
        pool = self._idle.get()
        try:
            pool = pool or self._start()
            return pool.submit(task).result()
        except BrokenProcessPool:
            pool = None
            raise LabkitError("its worker died, or took too long; grade it again") from None
        finally:
            self._idle.put(pool)

    def _start(self) -> ProcessPoolExecutor:
        if self._open.closed:
            raise BrokenProcessPool("the executor was shut down")
        return ProcessPoolExecutor(1, get_context("spawn"), _begin_worker, (self._end,))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes once they have done their work or, without ``wait``, at once."""
        self._threads.shutdown(wait, cancel_futures=cancel_futures or not wait)
        while wait and not self._idle.empty():
            pool = self._idle.get()
            if pool is not None:
                pool.shutdown()
        self._open.close()


def _block_interrupts() -> None:
    """Leave Ctrl-C to the main thread, which ends this thread and the processes that it starts."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _begin_worker(end: Connection) -> None:
    """Prepare a new process of a `LocalExecutor`."""
    os.dup2(2, 1)  # the grader's output has its own format
    threading.Thread(target=_end_with_executor, args=(end,), daemon=True).start()


def _end_with_executor(end: Connection) -> None:
    """Exit when the executor or its process has ended; the kernel then ends the sandbox, too."""
    with suppress(EOFError, OSError):
        end.recv()
    os._exit(1)
