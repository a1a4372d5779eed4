"""Walks over the floor from their harmonics: ``python -m benchmarks.synthesis [--short]``.

1,000 walks of 10 s at 60 frames a second, with root motion and feet that stand, in one call of `synthesize`. Beside it
the plain way to get root motion, the lowest point of both feet as the one that stands, which the tables of
`benchmarks.feet` show the faults of: frame by frame with scipy's Rotation, and in whole arrays with pymotion's forward
kinematics. All of them evaluate the same harmonics of the same walks; a peer does fewer of them, and time counts per
walk. The peers move the root and no leg: *root only* is the same job, ``hold=False``. Kinematics alone is neither a
walk nor a path, only what pymotion takes to place 22 joints in 600 frames.
"""

import argparse
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from threadpoolctl import threadpool_limits

from benchmarks import _measure
from eigenwalker.motion import JointWalk, Skeleton, synthesize
from eigenwalker.motion.fourier import evaluate_harmonics, fit_harmonics
from eigenwalker.motion.phase import stride_frequency

_DURATION, _RATE, _HARMONICS = 10.0, 60.0, 3
_OURS, _ROOT, _BOTH = "eigenwalker", "eigenwalker, root only", "eigenwalker, n_jobs=2"
_SCIPY, _PYMOTION, _KINEMATICS = "scipy, frame by frame", "pymotion", "pymotion, kinematics alone"

_LIMB = {"UpLeg": 0.45, "Leg": 0.5, "Foot": 0.2, "ToeBase": 0.3, "Arm": 0.4, "ForeArm": 0.3, "Shoulder": 0.05}

Array = NDArray[np.float64]


def main() -> None:
    """Print the table and the targets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="fewer walks and rounds")
    short = parser.parse_args().short
    n_walks, n_rounds = (40, 3) if short else (1000, 3)
    walks = _make_walks(n_walks)
    walks[0].joint_positions()
    synthesize(walks[:2])  # compiles
    calls: dict[str, Callable[[int], int]] = {
        _OURS: lambda _: _synthesize(walks),
        _ROOT: lambda _: _synthesize(walks, hold=False),
        _BOTH: lambda _: _synthesize(walks, n_jobs=2),
        _SCIPY: lambda turn: _one_of(_by_scipy, walks, turn, 1),
    }
    if find_spec("pymotion") is not None:
        calls[_PYMOTION] = lambda turn: _one_of(_by_pymotion, walks, turn, max(4, n_walks // 20))
        calls[_KINEMATICS] = _kinematics_of(walks[0], max(4, n_walks // 20))
    with threadpool_limits(1):
        seconds = _measure.interleaved(calls, n_rounds)
    ratios = {name: _measure.ratio(seconds, name, _OURS) for name in calls}
    same = {name: _measure.ratio(seconds, name, _ROOT) for name in calls}
    print(_measure.describe_machine(("numpy", "scipy", "numba", "upc-pymotion")))
    _measure.print_table(
        f"{n_walks} walks of {_DURATION:g} s at {_RATE:g} frames a second, {len(walks[0].skeleton.parents)} joints, "
        f"median of {n_rounds} rounds",
        ["", "ms a walk", "time / ours", "time / ours, root only"],
        [[name, f"{1e3 * np.median(seconds[name]):.2f}", f"{ratios[name]:.2f}", f"{same[name]:.2f}"] for name in calls],
    )
    targets = [("at least 30 times as fast as frame by frame", f"{ratios[_SCIPY]:.0f}", ratios[_SCIPY] >= 30)]
    if _PYMOTION in calls:
        targets.append(("root only: at least as fast as pymotion", f"{same[_PYMOTION]:.2f}", same[_PYMOTION] >= 1))
        targets.append(("legs reach: at least as fast as pymotion", f"{ratios[_PYMOTION]:.2f}", ratios[_PYMOTION] >= 1))
    _measure.print_targets(targets)


def _synthesize(walks: list[JointWalk], **options) -> int:
    return len(synthesize(walks, duration=_DURATION, frame_rate=_RATE, n_harmonics=_HARMONICS, **options))


def _make_walks(n_walks: int) -> list[JointWalk]:
    """Return synthetic joint walks in place, of 22 joints, each with a stride of its own."""
    skeleton, rng = _skeleton(), np.random.default_rng(0)
    phase = 2 * np.pi * np.arange(150) / 30
    walks = []
    for number in range(n_walks):
        frequency = rng.uniform(0.8, 1.1)
        rotations = np.zeros((len(phase), len(skeleton.parents), 3))
        for place, name in enumerate(skeleton.joint_names):
            size = _LIMB.get(name.removeprefix("Left").removeprefix("Right"), 0.03)
            sign = -1.0 if name.startswith("Left") else 1.0
            rotations[:, place, 1] = sign * size * np.cos(frequency * phase + rng.normal(scale=0.05))
            rotations[:, place] += 0.2 * size * np.cos(2 * frequency * phase + rng.uniform(0, 6))[:, np.newaxis]
            rotations[:, place, 1] += size * ("Leg" in name)
        root = np.tile([0.0, 0.0, 0.95], (len(phase), 1))
        walks.append(JointWalk(rotations, root, skeleton, 30.0, f"walk {number}"))
    return walks


def _skeleton() -> Skeleton:
    """Return an upright skeleton with the joint names of Mixamo's."""
    trunk = [("Hips", None, (0, 0, 0)), ("Spine", "Hips", (0, 0, 0.1)), ("Spine1", "Spine", (0, 0, 0.1))]
    trunk += [("Spine2", "Spine1", (0, 0, 0.15)), ("Neck", "Spine2", (0, 0, 0.15)), ("Head", "Neck", (0, 0, 0.1))]
    limbs = [
        ("Shoulder", "Spine2", (0, 0.05, 0.1)),
        ("Arm", "Shoulder", (0, 0.12, 0)),
        ("ForeArm", "Arm", (0, 0, -0.3)),
    ]
    limbs += [("Hand", "ForeArm", (0, 0, -0.25)), ("UpLeg", "Hips", (0, 0.09, 0)), ("Leg", "UpLeg", (0, 0, -0.42))]
    limbs += [("Foot", "Leg", (0, 0, -0.41)), ("ToeBase", "Foot", (0.12, 0, -0.06))]
    bones = list(trunk)
    for side, sign in (("Left", 1), ("Right", -1)):
        for name, above, (x, y, z) in limbs:
            bones.append((side + name, above if above in {"Spine2", "Hips"} else side + above, (x, sign * y, z)))
    names = tuple(name for name, *_ in bones)
    parents = [-1 if above is None else names.index(above) for _, above, _ in bones]
    return Skeleton(names, parents, np.array([offset for *_, offset in bones], dtype=float), upright=True)


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

    def run(_: int) -> int:
        for _ in range(count):
            fk(turns, still, offsets, parents)
        return count

    return run


def _quaternions(rotations: Array) -> Array:
    angles = np.linalg.norm(rotations, axis=-1, keepdims=True)
    return np.concatenate((np.cos(angles / 2), rotations * np.sinc(angles / (2 * np.pi)) / 2), axis=-1)


if __name__ == "__main__":
    main()
