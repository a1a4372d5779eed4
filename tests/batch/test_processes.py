"""Processes on one machine share the arrays of walks, if joblib is told how small the arrays are."""

from pathlib import Path

import numpy as np
from joblib import parallel_config
from sklearn.model_selection import cross_validate

from eigenwalker import make_eigenwalkers, make_walkers

N_WALKS = 30
MAX_NBYTES = 10_000  # as the documentation says; joblib's own bound is that of arrays a hundred times as large


def _copied_bytes(model, walks, labels):
    return sum(walk.positions.nbytes for walk in walks if _file_of(walk) is None)


def _n_files(model, walks, labels):
    return len(list(_file_of(walks[0]).parent.glob("*.pkl"))) if _file_of(walks[0]) else 0


def _file_of(walk):
    array = walk.positions
    while array is not None and not isinstance(array, np.memmap):
        array = array.base if isinstance(array, np.ndarray) else None
    return None if array is None else Path(array.filename)


def test_walks_reach_processes_without_a_copy_for_each_task(tmp_path):
    walks = make_walkers(N_WALKS, random_state=0).data
    labels = np.random.default_rng(0).normal(size=N_WALKS)
    scoring = {"r2": "r2", "copied": _copied_bytes, "files": _n_files}
    model = make_eigenwalkers(n_components=3)
    wanted = cross_validate(model, walks, labels, cv=6, scoring=scoring)
    with parallel_config("loky", n_jobs=2, max_nbytes=MAX_NBYTES, temp_folder=tmp_path):
        found = cross_validate(model, walks, labels, cv=6, scoring=scoring)
    np.testing.assert_array_equal(found["test_r2"], wanted["test_r2"])
    assert wanted["test_copied"].all()
    assert not found["test_copied"].any()
    assert N_WALKS <= found["test_files"].max() <= N_WALKS + 5  # one a walk, whatever the number of folds, and labels
