"""Synthetic joint walks: bodies that walk in place, and one that only moves."""

import numpy as np

from eigenwalker.motion import JointWalk, Skeleton

__all__ = ["make_joint_walks", "random_joint_walk"]

# Amplitudes in radians.
_LIMB = {"UpLeg": 0.45, "Leg": 0.5, "Foot": 0.2, "ToeBase": 0.3, "Arm": 0.4, "ForeArm": 0.3, "Shoulder": 0.05}

# Each chain of joints hangs from the joint before its colon; from joint to joint, in metres, forward, left and up.
_CHAINS = """
: Hips 0 0 0
Hips: LHipJoint 0 .02 -.02, LeftUpLeg 0 .07 -.06, LeftLeg 0 .02 -.41, LeftFoot 0 .02 -.40, LeftToeBase .12 0 -.04
Hips: RHipJoint 0 -.02 -.02, RightUpLeg 0 -.07 -.06, RightLeg 0 -.02 -.41, RightFoot 0 -.02 -.4, RightToeBase .12 0 -.04
Hips: LowerBack 0 0 .02, Spine 0 0 .11, Spine1 0 0 .11, Neck 0 0 .02, Neck1 .01 0 .08, Head .01 0 .09
Spine1: LeftShoulder 0 .01 .02, LeftArm 0 .18 .04, LeftForeArm 0 .28 0, LeftHand 0 .18 0, LeftFingerBase 0 .01 0
LeftFingerBase: LeftHandIndex1 0 .06 0
LeftHand: LThumb .04 .04 0
Spine1: RightShoulder 0 -.01 .02, RightArm 0 -.18 .04, RightForeArm 0 -.28 0, RightHand 0 -.18 0
RightHand: RightFingerBase 0 -.01 0
RightFingerBase: RightHandIndex1 0 -.06 0
RightHand: RThumb .04 -.04 0
"""


def random_joint_walk(random: np.random.Generator, n_frames: int) -> JointWalk:
    """Return smooth motion of a body with the 31 joints of the CMU database, 120 frames a second."""
    names, parents, offsets = list[str](), list[int](), list[list[float]]()
    for line in _CHAINS.strip().splitlines():
        held, _, chain = line.partition(":")
        for joint in chain.split(","):
            name, *offset = joint.split()
            parents.append(names.index(held) if held else -1)
            offsets.append([float(length) for length in offset])
            names.append(held := name)
    skeleton = Skeleton(tuple(names), np.array(parents), np.array(offsets))
    times = np.arange(n_frames)[:, np.newaxis, np.newaxis] / 120
    phases, speeds = random.uniform(0, 2 * np.pi, (2, len(names), 3))
    rotations = 0.4 * np.sin(speeds * times + phases)
    root = np.column_stack((1.3 * times.ravel(), 0.03 * np.sin(times.ravel()), 0.95 + 0.02 * np.cos(times.ravel())))
    return JointWalk(rotations, root, skeleton, 120.0, "random")


def make_joint_walks(n_walks: int) -> list[JointWalk]:
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
