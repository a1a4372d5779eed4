"""What a process that works on tasks keeps to: one thread for linear algebra, and no life after its parent."""

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController

__all__ = ["keep_to_task"]

_SECONDS = 1.0  # between two looks at the parent


@contextmanager
def keep_to_task(owner: int) -> Iterator[None]:
    """Keep linear algebra to one thread, as matrices are small, and end with the process that gave the task.

    Of joblib's processes. Dask limits the threads of its workers, and ends them, itself; in threads the limit would be
    lifted by whoever is first.

    Parameters
    ----------
    owner : int
        Process that gave the task. A worker of joblib, when that is killed, would wait for ever for somebody to read
        its results.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    if os.getppid() == owner:
        _end_with(owner)
    with _pools().limit(limits=1):
        yield


@cache
def _end_with(owner: int) -> None:
    threading.Thread(target=_wait_for_end, args=(owner,), daemon=True).start()


def _wait_for_end(owner: int) -> None:
    while os.getppid() == owner:  # an orphan has another parent
        time.sleep(_SECONDS)
    os._exit(1)


@cache
def _pools() -> ThreadpoolController:
    return ThreadpoolController()  # looks through all libraries of the process, which takes milliseconds
