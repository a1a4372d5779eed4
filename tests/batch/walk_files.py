"""Files of walks for the tests of many files, and readers that are known by their names."""

import os
import signal
import sys

import numpy as np

from eigenwalker import FourierLinearizer, write_walk
from eigenwalker.batch import linearize_files
from tests.synthetic import make_walk

__all__ = ["linearize_and_die", "make_from_seed", "write_files"]

_SPOILED = 3  # every so many files have no stride


def make_from_seed(seed, *, n_cycles=3.0):
    """Return a walk in place; every fourth stands still and is refused."""
    rng = np.random.default_rng(int(seed))
    walk, _ = make_walk(rng, n_cycles=n_cycles, frame_rate=60.0, noise=0.002, name=f"walk_{int(seed) % 5}")
    if int(seed) % 4 == _SPOILED:
        return walk.with_channels(np.repeat(walk.channels[:1], walk.n_frames, axis=0))
    return walk


def write_files(folder, n_files):
    """Write walks into folders, two of which hold files of the same name; return the paths."""
    paths = []
    for seed in range(n_files):
        path = folder / f"person_{seed % 2}" / f"{seed // 2:03d}.npz"
        path.parent.mkdir(exist_ok=True)
        write_walk(make_from_seed(seed), path)
        paths.append(path)
    return paths


def linearize_and_die(paths, out, limit, counted, retry_refused=False):
    """Linearize files, and be killed after so many steps: files that are opened, renamed, imported and so on.

    How many steps there were is left in `counted` if the end is reached.
    """
    n_steps = 0

    def step(*_):
        nonlocal n_steps
        n_steps += 1
        if n_steps == limit:
            os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(step)
    linearize_files(
        paths, FourierLinearizer(), out, preparer="passthrough", files_per_part=3, retry_refused=retry_refused
    )
    counted.value = n_steps
