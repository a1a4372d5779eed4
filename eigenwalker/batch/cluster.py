"""scikit-learn on a Dask cluster, with the walks on every worker."""

import time
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from itertools import chain
from typing import Any

from joblib import parallel_config
from joblib.parallel import get_active_backend

__all__ = ["on_cluster", "workers_of"]

_ATTEMPTS = 20
_PAUSE = 0.05  # seconds between two looks at who is there


def workers_of(client: Any) -> AbstractContextManager[Any]:
    """Return a context in which joblib works on a cluster; None leaves joblib as it is."""
    if client is None:
        return nullcontext()
    _check_client(client)
    return parallel_config("dask", client=client)


@contextmanager
def on_cluster(client: Any, *data: Any, folds: Sequence[tuple[Any, Any]] = ()) -> Iterator[None]:
    """Let scikit-learn and joblib work on a Dask cluster, to which data are sent once, and which may lose workers.

    ``joblib.parallel_config("dask")`` alone sends a list of walks with each task again, and what it does send once,
    arrays of labels and of folds, is on one worker and lost with it. Here the data go to all workers before the first
    task, and stay on all of them.

    Parameters
    ----------
    client : distributed.Client
        The cluster. With ``Client(..., direct_to_workers=True)`` data do not pass through the scheduler.
    *data : object
        The very objects that are handed to scikit-learn then: the list of walks, the labels, groups.
    folds : sequence of (train, test), default ()
        The folds, ``list(KFold(5).split(walks))``, which are handed to scikit-learn as ``cv``.

    Raises
    ------
    ImportError
        If dask.distributed is not installed.
    TypeError, ValueError
        If `client` is not a Client, or is closed.
    RuntimeError
        If workers keep dying while they are sent the data, as for want of memory.

    Notes
    -----
    Dask's active memory manager, which throws copies away, is stopped meanwhile. The Fourier step learns nothing
    across walks: where they are many it is quicker to linearize them once and to send the vectors,
    ``cross_validate(model[1:], model[0].fit_transform(walks), y)``, which gives the same numbers. On one machine no
    cluster is needed: inside ``joblib.parallel_config("loky", n_jobs=-1, max_nbytes=10_000)`` processes share the
    arrays of walks, where joblib by itself would send a copy of them all with each task.

    Examples
    --------
    >>> from distributed import Client  # doctest: +SKIP
    >>> from sklearn.model_selection import KFold, cross_validate
    >>> from eigenwalker.batch import on_cluster
    >>> folds = list(KFold(5).split(walks))  # doctest: +SKIP
    >>> with on_cluster(client, walks, y, folds=folds):  # doctest: +SKIP
    ...     scores = cross_validate(model, walks, y, cv=folds)
    """
    _check_client(client)
    held = [*data, *chain.from_iterable(folds)]
    was_managed = client.amm.running()
    client.amm.stop()
    try:
        with parallel_config("dask", client=client):
            futures = _send(client, held) if held else []
            backend, _ = get_active_backend()
            backend.data_futures = {id(one): future for one, future in zip(held, futures, strict=True)}
            yield
    finally:
        if was_managed:
            client.amm.start()


def _send(client: Any, held: Sequence[Any]) -> list[Any]:
    """Return futures of data that all workers have; begin anew where a worker dies meanwhile."""
    # Not with scatter(broadcast=True), which waits for ever for a worker that has died.
    for _ in range(_ATTEMPTS):
        workers = set(client.nthreads())
        try:
            # Under keys of their own. By their hash, as joblib does it, workers may be told to let go of the same data
            # of a call before after they got them again, and are then asked for them for ever.
            futures = client.scatter(held, hash=False)
        except (KeyError, OSError, TimeoutError):  # what it raises for a worker that has just died
            continue
        copies = [client.submit(_take, futures, workers=[worker], pure=False) for worker in workers]
        if _have_come(client, copies, workers):
            return futures
    raise RuntimeError(
        f"workers died {_ATTEMPTS} times while they were sent the data; is their memory large enough? See the "
        "cluster's logs, client.get_worker_logs()"
    )


def _take(data: Sequence[Any]) -> None:
    """Do nothing: a worker that is given data keeps a copy."""


def _have_come(client: Any, copies: Sequence[Any], workers: set[str]) -> bool:
    """Wait for tasks, one a worker; return whether all are done, or False as soon as a worker is gone."""
    while not all(copy.done() for copy in copies):
        if not workers <= set(client.nthreads()):
            return False
        time.sleep(_PAUSE)
    return all(copy.status == "finished" for copy in copies)


def _check_client(client: object) -> None:
    try:
        from distributed import Client
    except ImportError:
        raise ImportError("a cluster needs dask.distributed: pip install 'eigenwalker[cluster]'") from None
    if not isinstance(client, Client):
        raise TypeError(f"client must be a distributed.Client, got {type(client).__name__}")
    if client.status != "running":
        raise ValueError(f"client must be connected to a cluster, got one that is {client.status}")
