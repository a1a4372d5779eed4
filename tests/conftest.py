"""What all tests share."""

import os

os.environ.setdefault("SCIPY_ARRAY_API", "1")  # before scipy: scikit-learn skips one of its checks without it

from pathlib import Path

import pytest
from hypothesis import settings

# The first example of a law may wait for a compiled loop; and where it decides, a run gives the same answer twice.
settings.register_profile("eigenwalker", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("eigenwalker")


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Return the folder of recorded walks, or skip the test where there is none."""
    default = Path(__file__).parents[2] / "shared" / "data"
    folder = Path(os.environ.get("EIGENWALKER_TEST_DATA", default))
    if not folder.is_dir():
        pytest.skip(f"no recorded walks in {folder}; set EIGENWALKER_TEST_DATA to the folder that holds them")
    return folder
