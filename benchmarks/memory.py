"""Peak memory of fitting the whole model: ``python -m benchmarks.memory [--short]``.

In a process of its own, beside the memory of the walks themselves. Needs a Unix system.
"""

import argparse
import json
import resource
import subprocess
import sys

from benchmarks._command import finish, suite_parser
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table

_RATE = 120.0
_N_FRAMES = 600
_SHARE = 2  # of the memory of the walks


def main() -> None:
    """Print how much memory the fit took, or be the process that takes it."""
    parser = suite_parser(__doc__, short="300 walks instead of 2,000")
    parser.add_argument("--child", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        print(json.dumps(_measure_fit(arguments.child)))
    else:
        finish(findings(short=arguments.short), arguments.out)


def findings(*, short: bool) -> list[Check]:
    """Run the fit in a child process, and return whether it took too much memory."""
    # Nothing large may be imported before the child starts: Linux hands the parent's peak on to it.
    n_walks = 300 if short else 2000
    command = [sys.executable, "-m", "benchmarks.memory", "--child", str(n_walks)]
    measured = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    return _report(n_walks, **measured)


def _measure_fit(n_walks: int) -> dict[str, float]:
    """Return bytes in use before the walks, the bytes of the walks, and the peaks before and after the fit."""
    import numpy as np

    from benchmarks._synthetic import random_coefficients, random_walk
    from eigenwalker.model import make_eigenwalkers
    from eigenwalker.motion import Walk

    random = np.random.default_rng(0)

    def make_walks(n: int) -> list[Walk]:
        walks = []
        for frequency in random.uniform(0.8, 1.1, n):
            angles = 2 * np.pi * frequency / _RATE * np.arange(_N_FRAMES)
            channels = random_walk(random, random_coefficients(random), angles, 0.001)
            channels.flags.writeable = False  # else the walk keeps a copy
            walks.append(Walk(channels.reshape(_N_FRAMES, -1, 3), _RATE))
        return walks

    def fit(walks: list[Walk]) -> None:
        make_eigenwalkers().fit(walks, random.standard_normal(len(walks)))

    fit(make_walks(16))  # compiled code and lazy imports are in memory now
    before = _bytes_in_use()
    walks = make_walks(n_walks)
    with_walks = _peak_bytes()
    fit(walks)
    size = sum(walk.positions.nbytes for walk in walks)
    return {"before": before, "with_walks": with_walks, "after": _peak_bytes(), "size": size}


def _peak_bytes() -> int:
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def _bytes_in_use() -> int:
    """Return the resident memory, or the peak so far where the system does not tell."""
    try:
        with open("/proc/self/statm", encoding="ascii") as numbers:
            return int(numbers.read().split()[1]) * resource.getpagesize()
    except OSError:
        return _peak_bytes()


def _report(n_walks: int, before: float, with_walks: float, after: float, size: float) -> list[Check]:
    print(describe_machine())
    rows = [
        ["the walks themselves", f"{size / 1e6:.0f}", "1.00"],
        ["peak after making them", f"{(with_walks - before) / 1e6:.0f}", f"{(with_walks - before) / size:.2f}"],
        ["peak after the fit", f"{(after - before) / 1e6:.0f}", f"{(after - before) / size:.2f}"],
    ]
    title = f"make_eigenwalkers().fit, {n_walks} walks of {_N_FRAMES} frames x 15 markers, float64"
    print_table(title, ["", "MB more than before", "of the walks"], rows)
    share = (after - before) / size
    wanted = f"fitting the model takes less than {_SHARE} times the memory of the walks"
    return [Check(wanted, f"{share:.2f}", share < _SHARE)]


if __name__ == "__main__":
    main()
