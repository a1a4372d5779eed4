"""What was written is read back, in whatever pieces."""

import numpy as np
import pandas as pd
import pytest

from eigenwalker import FourierLinearizer, make_eigenwalkers
from eigenwalker.batch import (
    iterate_coefficients,
    linearize_files,
    read_coefficients,
    read_linearizer,
    refused_files,
)
from eigenwalker.model import fit_stream
from tests.batch.walk_files import make_from_seed

N_WALKS = 19


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("data") / "coefficients"
    with pytest.warns(UserWarning, match="4 of 19 walks were refused"):
        linearize_files(
            range(N_WALKS),
            FourierLinearizer(),
            folder,
            preparer="passthrough",
            read=make_from_seed,
            files_per_part=4,
        )
    return folder


@pytest.mark.parametrize("batch_rows", [1, 2, 7, 15, 1000])
def test_batches_are_the_table(folder, batch_rows):
    tables = list(iterate_coefficients(folder, batch_rows=batch_rows))
    assert {len(table) for table in tables[:-1]} <= {batch_rows}
    assert 0 < len(tables[-1]) <= batch_rows
    together = pd.concat(tables, ignore_index=True)
    pd.testing.assert_frame_equal(together, read_coefficients(folder), check_exact=True)
    assert all(table.index[0] == 0 for table in tables)


def test_used_and_refused_are_all_files(folder):
    used, refused = read_coefficients(folder, columns=["file"])["file"], refused_files(folder)["file"]
    assert sorted([*used, *refused], key=int) == [str(seed) for seed in range(N_WALKS)]
    assert list(refused) == ["3", "7", "11", "15"]


def test_columns_come_in_the_order_asked_for(folder):
    names = ["frequency", "name", "mean_head_z"]
    table = read_coefficients(folder, columns=names)
    assert list(table) == names
    pd.testing.assert_frame_equal(table, read_coefficients(folder)[names], check_exact=True)
    assert read_coefficients(folder, columns=["reason"])["reason"].isna().all()
    features = read_coefficients(folder, columns=read_linearizer(folder).get_feature_names_out())
    assert features.shape == (15, 226)
    assert features.dtypes.eq(np.float64).all()


def test_other_readers_see_the_same_table(folder):
    table = pd.read_parquet(folder)
    assert list(table["file"]) == [str(seed) for seed in range(N_WALKS)]
    used = table[table["reason"].isna()].drop(columns="reason").reset_index(drop=True)
    pd.testing.assert_frame_equal(used, read_coefficients(folder), check_exact=True)


def test_a_model_is_fitted_from_batches(folder):
    labels = pd.Series(np.sin(np.arange(N_WALKS)), index=[str(seed) for seed in range(N_WALKS)], name="mood")
    used = read_coefficients(folder, columns=["file"])["file"]
    whole = make_eigenwalkers(n_components=3).fit([make_from_seed(seed) for seed in used], labels[used].to_numpy())

    def parts():
        for table in iterate_coefficients(folder, batch_rows=4):
            yield table, labels[table["file"]].to_numpy()

    model = fit_stream(make_eigenwalkers(n_components=3), parts, template=read_linearizer(folder).template_)
    walk = make_from_seed(0)
    np.testing.assert_allclose(model.predict([walk]), whole.predict([walk]), rtol=1e-9)


def test_nothing_is_found_where_nothing_is(tmp_path):
    for read in (read_coefficients, iterate_coefficients, refused_files, read_linearizer):
        with pytest.raises(ValueError, match="expected a folder that linearize_files has written, got none"):
            read(tmp_path)


def test_wrong_arguments(folder):
    with pytest.raises(ValueError, match=r"columns must be out of file, name, reason.*, got gender"):
        iterate_coefficients(folder, columns=["name", "gender"])
    with pytest.raises(TypeError, match="got the single string 'name'"):
        read_coefficients(folder, columns="name")
    with pytest.raises(ValueError, match="batch_rows must be a whole number of at least 1, got 0"):
        iterate_coefficients(folder, batch_rows=0)
