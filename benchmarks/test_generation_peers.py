"""Parameter generation by this package and by nnmnkwii: ``python -m pytest benchmarks``."""

import numpy as np
import pytest

from benchmarks._hsmm_generation import make_nnmnkwii, make_states
from eigenwalker.hsmm.generation import generate_trajectory


@pytest.mark.parametrize("n_frames", [12, 600])
def test_generation_agrees_with_nnmnkwii(n_frames):
    """All channels, without dynamics in the first and last two frames, of which it takes none."""
    pytest.importorskip("nnmnkwii", reason="nnmnkwii is not installed")
    means, variances = make_states(n_frames)
    expected = make_nnmnkwii()(means, variances)
    assert np.allclose(generate_trajectory(means, variances), expected, rtol=0, atol=1e-12)
