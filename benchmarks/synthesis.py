"""Walks over the floor from their harmonics: ``python -m benchmarks.synthesis [--short]``.

1,000 walks of 10 s at 60 frames a second, with root motion and feet that stand, in one call of `synthesize`. Beside it
the plain way to get root motion, the lowest point of both feet as the one that stands, which the tables of
`benchmarks.feet` show the faults of: frame by frame with scipy's Rotation, and in whole arrays with pymotion's forward
kinematics. All of them evaluate the same harmonics of the same walks; a peer does fewer of them, and time counts per
walk. The peers move the root and no leg: *root only* is the same job, ``hold=False``. Kinematics alone is neither a
walk nor a path, only what pymotion takes to place 22 joints in 600 frames.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from threadpoolctl import threadpool_limits

from benchmarks import _measure
from benchmarks._command import run
from benchmarks._findings import Row
from benchmarks._joint_walks import make_joint_walks
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table
from eigenwalker.motion import JointWalk, synthesize
from eigenwalker.motion.fourier import evaluate_harmonics, fit_harmonics
from eigenwalker.motion.phase import stride_frequency

_DURATION, _RATE, _HARMONICS = 10.0, 60.0, 3
_OURS, _ROOT, _BOTH = "eigenwalker", "eigenwalker, root only", "eigenwalker, n_jobs=2"
_SCIPY, _PYMOTION, _KINEMATICS = "scipy, frame by frame", "pymotion", "pymotion, kinematics alone"
_HELD, _FREE = "synthesis of 10 s with feet that stand, a walk", "synthesis of 10 s, root only, a walk"
_WANTED = {(_HELD, _OURS, _SCIPY): 30, (_HELD, _OURS, _PYMOTION): 1, (_FREE, _ROOT, _PYMOTION): 1}
_OTHER_WALK = "the peer's root follows the lowest point of its feet: another walk, of which no difference is told"

Array = NDArray[np.float64]


def findings(*, short: bool) -> list[Row]:
    """Print the table, and return a row for each peer."""
    n_walks, n_rounds = (40, 3) if short else (1000, 3)
    walks = make_joint_walks(n_walks)
    walks[0].joint_positions()
    synthesize(walks[:2])  # compiles
    calls, missing = _ways(walks)
    with threadpool_limits(1):
        seconds = _measure.interleaved(calls, n_rounds)
    print(describe_machine(("numpy", "scipy", "numba", "upc-pymotion")))
    rows = [
        [
            name,
            f"{1e3 * np.median(seconds[name]):.2f}",
            f"{_measure.ratio(seconds, name, _OURS):.2f}",
            f"{_measure.ratio(seconds, name, _ROOT):.2f}",
        ]
        for name in calls
    ]
    print_table(
        f"{n_walks} walks of {_DURATION:g} s at {_RATE:g} frames a second, {len(walks[0].skeleton.parents)} joints, "
        f"median of {n_rounds} rounds",
        ["", "ms a walk", "time / ours", "time / ours, root only"],
        rows + [[name, reason, "", ""] for name, reason in missing.items()],
    )
    return [
        _measure.beside(task, seconds, ours, peer, wanted=wanted, note=missing.get(peer, _OTHER_WALK))
        for (task, ours, peer), wanted in _WANTED.items()
    ]


def _ways(walks: list[JointWalk]) -> tuple[dict[str, Callable[[int], int]], dict[str, str]]:
    """Return functions for `interleaved`, and why some cannot be."""
    some = max(4, len(walks) // 20)
    pymotion, missing = _measure.try_peers({_PYMOTION: lambda: _by_pymotion(walks[0])})
    calls: dict[str, Callable[[int], int]] = {
        _OURS: lambda _: _synthesize(walks),
        _ROOT: lambda _: _synthesize(walks, hold=False),
        _BOTH: lambda _: _synthesize(walks, n_jobs=2),
        _SCIPY: lambda turn: _one_of(_by_scipy, walks, turn, 1),
    }
    if pymotion:
        calls[_PYMOTION] = lambda turn: _one_of(_by_pymotion, walks, turn, some)
        calls[_KINEMATICS] = _kinematics_of(walks[0], some)
    return calls, missing


def _synthesize(walks: list[JointWalk], **options) -> int:
    return len(synthesize(walks, duration=_DURATION, frame_rate=_RATE, n_harmonics=_HARMONICS, **options))


def _one_of(function: Callable[[JointWalk], Array], walks: list[JointWalk], turn: int, count: int) -> int:
    """Make some of the walks, others in each round, and return how many."""
    for place in range(count):
        function(walks[(turn * count + place) % len(walks)])
    return count


def _series(walk: JointWalk) -> Array:
    """Return exponential maps over time, shape (n_frames, n_joints, 3), of the harmonics of a walk."""
    frequency = stride_frequency(walk)
    coefficients = fit_harmonics(walk.channels, walk.frame_rate, frequency, _HARMONICS)
    times = np.arange(round(_DURATION * _RATE)) / _RATE
    return evaluate_harmonics(coefficients, frequency, times).reshape(len(times), -1, 3)


def _feet(walk: JointWalk) -> list[int]:
    names = walk.skeleton.joint_names
    return [names.index(f"{side}{joint}") for side in ("Left", "Right") for joint in ("Foot", "ToeBase")]


def _root(feet: Array) -> Array:
    """Return the path of the root under which the lowest of some points, shape (n_frames, n_points, 3), stays."""
    lowest = feet[..., 2].argmin(axis=1)
    frames = np.arange(len(feet) - 1)
    steps = feet[frames, lowest[:-1]] - feet[frames + 1, lowest[:-1]]
    root = np.vstack((np.zeros(3), np.cumsum(steps, axis=0)))
    root[:, 2] = -feet[..., 2].min(axis=1)
    return root


def _by_scipy(walk: JointWalk) -> Array:
    rotations, skeleton = _series(walk), walk.skeleton
    offsets = np.array(skeleton.offsets)  # Rotation takes no read-only ones
    feet = np.empty((len(rotations), 4, 3))
    for frame, turns in enumerate(rotations):
        places, axes = [], []
        for joint, parent in enumerate(skeleton.parents):
            own = Rotation.from_rotvec(turns[joint])
            if parent < 0:
                places.append(np.zeros(3))
                axes.append(own)
                continue
            places.append(places[parent] + axes[parent].apply(offsets[joint]))
            axes.append(axes[parent] * own)
        feet[frame] = [places[joint] for joint in _feet(walk)]
    return _root(feet)


def _by_pymotion(walk: JointWalk) -> Array:
    from pymotion.ops.skeleton import fk

    rotations = _series(walk)
    turns = _quaternions(rotations)
    places, _ = fk(turns, np.zeros((len(turns), 3)), np.array(walk.skeleton.offsets), np.array(walk.skeleton.parents))
    return _root(places[:, _feet(walk)])


def _kinematics_of(walk: JointWalk, count: int) -> Callable[[int], int]:
    from pymotion.ops.skeleton import fk

    turns = _quaternions(_series(walk))
    still = np.zeros((len(turns), 3))
    offsets, parents = np.array(walk.skeleton.offsets), np.array(walk.skeleton.parents)

    def place_joints(_: int) -> int:
        for _ in range(count):
            fk(turns, still, offsets, parents)
        return count

    return place_joints


def _quaternions(rotations: Array) -> Array:
    angles = np.linalg.norm(rotations, axis=-1, keepdims=True)
    return np.concatenate((np.cos(angles / 2), rotations * np.sinc(angles / (2 * np.pi)) / 2), axis=-1)


if __name__ == "__main__":
    run(findings, __doc__, short="fewer walks and rounds")
