"""A cluster gives the same numbers, loses workers without harm, and is sent walks once."""

import os
import pickle
import signal
import sys
from functools import partial

import joblib
import numpy as np
import pytest
from sklearn.model_selection import KFold, cross_validate

from eigenwalker import FourierLinearizer, make_eigenwalkers
from eigenwalker.batch import linearize_files, on_cluster
from tests.batch.walk_files import write_files
from tests.synthetic import make_walk

N_FILES, N_WALKS = 70, 40

pytestmark = [
    pytest.mark.filterwarnings("ignore:[0-9]+ of [0-9]+ walks were refused:UserWarning"),
    # What Dask and its sockets leave behind when a worker was killed.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture
def client():
    """Return a cluster of its own for each test: one in which a worker was killed takes a while to know that."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0") as cluster,
        Client(cluster, direct_to_workers=True) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    return write_files(tmp_path_factory.mktemp("walks"), N_FILES)


@pytest.fixture(scope="module")
def undisturbed(paths, tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed") / "coefficients"
    linearize_files(paths, FourierLinearizer(), folder, preparer="passthrough")
    return _parts(folder)


@pytest.fixture(scope="module")
def labeled():
    rng = np.random.default_rng(0)
    walks = [make_walk(rng, n_cycles=12.0, noise=0.002, name=str(number))[0] for number in range(N_WALKS)]
    labels = rng.normal(size=N_WALKS)
    folds = list(KFold(4).split(walks))
    model = make_eigenwalkers(n_components=3)
    return model, walks, labels, folds, cross_validate(model, walks, labels, cv=folds)["test_score"]


def _parts(folder):
    return {path.name: path.read_bytes() for path in folder.glob("part-*.parquet")}


def _count_bytes():
    """Count what this process writes to others from now on."""
    from distributed.comm.tcp import TCP

    if not hasattr(TCP, "counted"):
        write = TCP.write

        async def counting(self, *arguments, **options):
            n_bytes = await write(self, *arguments, **options)
            TCP.counted += n_bytes or 0
            return n_bytes

        TCP.write = counting
    TCP.counted = 0


def _counted_bytes():
    return sys.modules["distributed.comm.tcp"].TCP.counted


def test_linearized_on_a_cluster(client, paths, undisturbed, tmp_path):
    _count_bytes()
    linearize_files(paths, FourierLinearizer(), tmp_path / "table", preparer="passthrough", client=client)
    assert _parts(tmp_path / "table") == undisturbed
    size = sum(path.stat().st_size for path in paths)
    assert _counted_bytes() < size / 4  # the workers read the files themselves
    with joblib.parallel_config("dask", client=client):
        linearize_files(iter(paths), FourierLinearizer(), tmp_path / "again", preparer="passthrough")
    assert _parts(tmp_path / "again") == undisturbed


def test_linearized_though_a_worker_is_killed(client, paths, undisturbed, tmp_path):
    worker = next(iter(client.run(os.getpid).values()))

    def deadly():
        for number, path in enumerate(paths):
            if number == N_FILES // 2:
                os.kill(worker, signal.SIGKILL)
            yield path

    linearize_files(deadly(), FourierLinearizer(), tmp_path / "table", preparer="passthrough", client=client)
    assert _parts(tmp_path / "table") == undisturbed


def test_walks_cross_the_wire_once(client, labeled):
    model, walks, labels, folds, expected = labeled
    client.wait_for_workers(2, timeout=60)
    client.run(_count_bytes)
    _count_bytes()
    with on_cluster(client, walks, labels, folds=folds):
        scores = cross_validate(model, walks, labels, cv=folds)["test_score"]
    np.testing.assert_array_equal(scores, expected)
    size, sent = len(pickle.dumps(walks)), _counted_bytes()
    between = sum(client.run(_counted_bytes).values())
    assert size < sent < 1.2 * size  # from here to a worker
    assert between < 1.2 * size  # and from one to the other
    assert client.amm.running()


def _score_or_die(model, walks, labels, *, flag, spared):
    """Score a model; the first worker that gets here is killed."""
    if os.getpid() != spared and not os.path.exists(flag):
        with open(flag, "x"):
            os.kill(os.getpid(), signal.SIGKILL)
    return model.score(walks, labels)


def test_cross_validated_though_a_worker_is_killed(client, labeled, tmp_path):
    model, walks, labels, folds, expected = labeled
    client.wait_for_workers(2, timeout=60)
    scoring = partial(_score_or_die, flag=str(tmp_path / "killed"), spared=os.getpid())
    with on_cluster(client, walks, labels, folds=folds):
        scores = cross_validate(model, walks, labels, cv=folds, scoring=scoring)["test_score"]
    assert (tmp_path / "killed").exists()
    np.testing.assert_array_equal(scores, expected)


def test_data_are_sent_though_a_worker_has_just_been_killed(client, labeled):
    model, walks, labels, folds, expected = labeled
    client.wait_for_workers(2, timeout=60)
    os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
    with on_cluster(client, walks, labels, folds=folds):
        scores = cross_validate(model, walks, labels, cv=folds)["test_score"]
    np.testing.assert_array_equal(scores, expected)


def test_a_closed_client_is_an_error(client):
    from distributed import Client

    closed = Client(client.cluster.scheduler_address)
    closed.close()
    with pytest.raises(ValueError, match="connected to a cluster, got one that is closed"), on_cluster(closed, [1, 2]):
        pass


def test_a_cluster_that_takes_no_data_is_an_error(client, monkeypatch):
    def scatter(*arguments, **options):
        raise KeyError("tcp://gone")

    monkeypatch.setattr(client, "scatter", scatter)
    with pytest.raises(RuntimeError, match="died 20 times while they were sent the data"), on_cluster(client, [1, 2]):
        pass
    assert client.amm.running()


def test_distributed_is_named_where_it_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ImportError, match=r"pip install 'eigenwalker\[cluster\]'"), on_cluster(2):
        pass


@pytest.mark.parametrize("client", ["tcp://127.0.0.1:8786", 2])
def test_only_clients_are_taken(client, tmp_path):
    match = f"client must be a distributed.Client, got {type(client).__name__}"
    with pytest.raises(TypeError, match=match), on_cluster(client):
        pass
    with pytest.raises(TypeError, match=match):
        linearize_files([0], FourierLinearizer(), tmp_path, client=client)
