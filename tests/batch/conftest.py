"""Files of walks and the data set of an undisturbed run, for all tests of a module."""

import pytest

from eigenwalker import FourierLinearizer
from eigenwalker.batch import linearize_files
from tests.batch.walk_files import write_files

N_FILES = 22


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    return write_files(tmp_path_factory.mktemp("walks"), N_FILES)


@pytest.fixture(scope="module")
def undisturbed(paths, tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed") / "coefficients"
    linearize_files(paths, FourierLinearizer(), folder, preparer="passthrough", files_per_part=3)
    return folder
