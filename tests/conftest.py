"""What all tests share."""

import os

os.environ.setdefault("SCIPY_ARRAY_API", "1")  # before scipy: scikit-learn skips one of its checks without it
os.environ.setdefault("OMP_NUM_THREADS", "1")  # before numpy: each processor has a process of tests already

from pathlib import Path

import pytest
from hypothesis import settings

# The first example of a law may wait for a compiled loop; and where it decides, a run gives the same answer twice.
settings.register_profile("eigenwalker", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("eigenwalker")


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """Return 0, which is no process but this one, for tests of one file: they stay together anyway."""
    files = {argument.partition("::")[0] for argument in config.args}
    return 0 if len(files) == 1 and files.pop().endswith(".py") else None


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Return the folder of recorded walks, or skip the test where there is none."""
    default = Path(__file__).parents[2] / "shared" / "data"
    folder = Path(os.environ.get("EIGENWALKER_TEST_DATA", default))
    if not folder.is_dir():
        pytest.skip(f"no recorded walks in {folder}; set EIGENWALKER_TEST_DATA to the folder that holds them")
    return folder
