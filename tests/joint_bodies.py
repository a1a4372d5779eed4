"""Small skeletons of every known rig, and joint walks on them."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from eigenwalker import read_walk
from eigenwalker.io.amc import read_amc
from eigenwalker.motion import JointWalk, Skeleton, find_rig, stand_upright
from tests.acclaim import AMC, ASF

__all__ = [
    "RIGS_OF_JOINTS",
    "apart",
    "body",
    "in_posture",
    "mixamo",
    "over_floor",
    "random_skeleton",
    "still",
    "swinging",
    "turned",
    "turning",
]

RIGS_OF_JOINTS = ("bandai", "cmu", "asf", "mixamorig", "mixamo")

_SIDE = {
    "Shoulder": ("Spine2", (0, 0.06, 0.12)),
    "Arm": ("Shoulder", (-0.01, 0.12, 0)),
    "ForeArm": ("Arm", (0, 0.28, 0)),
    "Hand": ("ForeArm", (0, 0.27, 0)),
    "UpLeg": ("Hips", (0, 0.09, -0.06)),
    "Leg": ("UpLeg", (0, 0.004, -0.42)),
    "Foot": ("Leg", (-0.01, 0, -0.42)),
    "ToeBase": ("Foot", (0.13, 0, -0.08)),
}


def mixamo(prefix=""):
    """Return Mixamo's skeleton, a T with axes along those of the room where all rotations are zero."""
    bones = {"Hips": (None, (0, 0, 1.0))}
    for below, above in (("Spine", "Hips"), ("Spine1", "Spine"), ("Spine2", "Spine1"), ("Neck", "Spine2")):
        bones[below] = (above, (0, 0, 0.12))
    bones["Head"] = ("Neck", (0.01, 0, 0.1))
    for side, sign in (("Left", 1), ("Right", -1)):
        for name, (above, offset) in _SIDE.items():
            parent = above if above in bones else side + above
            bones[side + name] = (parent, np.multiply(offset, [1, sign, 1]))
    names = tuple(bones)
    parents = [-1 if above is None else names.index(above) for above, _ in bones.values()]
    tips = {"Head": (0, 0, 0.18), "LeftHand": (0, 0.1, 0), "RightHand": (0, -0.1, 0)}
    tips |= dict.fromkeys(("LeftToeBase", "RightToeBase"), (0.07, 0, 0))
    return Skeleton(
        tuple(prefix + name for name in names),
        parents,
        np.array([offset for _, offset in bones.values()], dtype=np.float64),
        [names.index(name) for name in tips],
        np.array(list(tips.values()), dtype=np.float64),
    )


def body(rig, folder, data_dir):
    """Return a joint walk with a skeleton of a rig, as files have it; `data_dir` is called for recorded ones only."""
    if rig == "bandai":
        walk = read_walk(data_dir() / "bandai2" / "dataset-2_walk_normal_001.bvh")
    elif rig == "cmu":
        walk = read_walk(data_dir() / "cmu_bvh" / "07_01.bvh", unit=0.0564)
    elif rig == "asf":
        (folder / "07.asf").write_text(ASF)
        (folder / "07_01.amc").write_text(AMC)
        walk = read_amc(folder / "07_01.amc")
    else:
        walk = still(mixamo("mixamorig:" if rig == "mixamorig" else ""), n_frames=2)
    assert find_rig(walk.skeleton.joint_names).name == rig
    return walk


def still(skeleton, n_frames=1):
    """Return a walk in which all rotations of a skeleton are zero, its root 0.9 m above the floor."""
    rotations = np.zeros((n_frames, len(skeleton.joint_names), 3))
    return JointWalk(rotations, np.tile([0, 0, 0.9], (n_frames, 1)), skeleton, 30.0, "still")


def in_posture(skeleton, **turns):
    """Return one frame of a skeleton in which some joints are turned, by exponential maps in degrees."""
    rotations = np.zeros((1, len(skeleton.joint_names), 3))
    for joint, turn in turns.items():
        rotations[0, skeleton.index(joint)] = np.deg2rad(turn)
    return JointWalk(rotations, [[0, 0, 0.9]], skeleton, 30.0, "posed")


def turning(skeleton, seed, n_frames=40, *, translations=()):
    """Return a walk in which all joints but those above the root turn smoothly, about other axes all the time."""
    rng = np.random.default_rng(seed)
    n_joints = len(skeleton.joint_names)
    steps = rng.normal(scale=0.15, size=(n_frames, n_joints, 3))
    rotations = rng.uniform(-1.5, 1.5, size=(n_joints, 3)) + steps.cumsum(axis=0)
    above = skeleton.above(skeleton.root)
    rotations[:, above] = rotations[0, above]
    paths = {skeleton.joint_names[joint]: rng.normal(size=(n_frames, 3)) for joint in translations}
    return JointWalk(rotations, rng.normal(size=(n_frames, 3)), skeleton, 30.0, "turning", translations=paths)


def swinging(phase, *, seed=0, frame_rate=120.0, loose=(), name="anna"):
    """Return an upright walk in place of two harmonics, in the stride's phase, shape (n_frames,).

    Joints that are `loose` move against their parents by some millimeters.
    """
    skeleton = stand_upright(still(mixamo())).skeleton
    rng = np.random.default_rng(seed)
    waves = np.stack([wave(k * phase) for k in (1, 2) for wave in (np.sin, np.cos)], axis=1)  # (n_frames, 4)
    rotations = 0.04 * np.einsum("tf,fjc->tjc", waves, rng.normal(size=(4, len(skeleton.joint_names), 3)))
    for side, sign in (("Left", -1), ("Right", 1)):
        rotations[:, skeleton.index(f"{side}UpLeg"), 1] += sign * 0.4 * np.cos(phase)
        rotations[:, skeleton.index(f"{side}Leg"), 1] += 0.4
    root = np.array([0, 0, 0.9]) + 0.01 * waves @ rng.normal(size=(4, 3))
    paths = {
        joint: skeleton.offsets[skeleton.index(joint)] + 0.003 * waves @ rng.normal(size=(4, 3)) for joint in loose
    }
    return JointWalk(rotations, root, skeleton, frame_rate, name, translations=paths)


def over_floor(walk, *, speed=1.3):
    """Return a walk in place as it goes along x."""
    along = speed * np.arange(walk.n_frames) / walk.frame_rate
    return replace(walk, root=walk.root + np.outer(along, [1.0, 0.0, 0.0]))


def turned(walk, degrees):
    """Return a walk turned about the vertical, whose root hangs from joints without rotations, or from none."""
    about = Rotation.from_rotvec([0, 0, np.deg2rad(degrees)])
    rotations, place = np.array(walk.rotations), walk.skeleton.root
    rotations[:, place] = (about * Rotation.from_rotvec(rotations[:, place])).as_rotvec()
    return replace(walk, rotations=rotations, root=about.apply(np.array(walk.root)))


def random_skeleton(seed):
    """Return a tree of random bones, its root anywhere in it, with tips."""
    rng = np.random.default_rng(seed)
    n_joints = int(rng.integers(1, 8))
    parents = [-1, *(int(rng.integers(0, joint)) for joint in range(1, n_joints))]
    n_ends = int(rng.integers(0, 4))
    return Skeleton(
        tuple(f"joint{number}" for number in range(n_joints)),
        parents,
        rng.normal(size=(n_joints, 3)),
        rng.integers(0, n_joints, size=n_ends),
        rng.normal(size=(n_ends, 3)),
        root=int(rng.integers(0, n_joints)),
    )


def apart(one, other):
    """Return how far apart joints and tips of two walks are, at most, in metres."""
    places = [np.concatenate((walk.joint_positions(), walk.end_positions()), axis=1) for walk in (one, other)]
    return np.abs(places[0] - places[1]).max()
