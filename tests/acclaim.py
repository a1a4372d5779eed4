"""A small body as ASF and AMC text, with the names of the CMU database."""

import math
from dataclasses import dataclass


@dataclass
class Bone:
    """One bone: where it hangs, direction and length, axis with its order, and its degrees of freedom."""

    parent: str
    direction: tuple
    length: float
    axis: tuple = (0, 0, 0)
    order: str = "XYZ"
    dof: tuple = ()


def _side(side, sign):
    """Return the bones of one leg and one arm, left in +x as in the CMU database."""
    down = (0.0, -1.0, 0.0)
    legs = {
        "hipjoint": Bone("root", (0.6 * sign, -0.8, 0.0), 2.2),
        "femur": Bone(f"{side}hipjoint", down, 7.2, (0, 0, 20 * sign), dof=("rx", "ry", "rz")),
        "tibia": Bone(f"{side}femur", down, 7.4, (0, 0, 20 * sign), dof=("rx",)),
        "foot": Bone(f"{side}tibia", (0.0, -0.28, 0.96), 2.2, (-70, 0, 20), dof=("rx", "rz")),
        "toes": Bone(f"{side}foot", (0.0, 0.0, 1.0), 1.1, (-90, 0, 20), dof=("rx",)),
    }
    out = (float(sign), 0.0, 0.0)
    arms = {
        "clavicle": Bone("thorax", (0.95 * sign, 0.3, 0.05), 3.4, dof=("ry", "rz")),
        "humerus": Bone(f"{side}clavicle", out, 5.0, (180, 30 * sign, 90), dof=("rx", "ry", "rz")),
        "radius": Bone(f"{side}humerus", out, 3.2, (180, 30 * sign, 90), dof=("rx",)),
        "wrist": Bone(f"{side}radius", out, 1.6, (90, 0, 90), dof=("ry",)),
        "hand": Bone(f"{side}wrist", out, 0.7, (90, 0, 90), dof=("rx", "rz")),
    }
    return {side + name: bone for name, bone in (legs | arms).items()}


def _spine(parent, length, **more):
    return Bone(parent, (0.0, 1.0, 0.0), length, dof=("rx", "ry", "rz"), **more)


BODY = {
    "lowerback": _spine("root", 2.1),
    "upperback": _spine("lowerback", 2.1),
    "thorax": _spine("upperback", 2.1),
    "lowerneck": _spine("thorax", 1.6),
    "upperneck": _spine("lowerneck", 1.5),
    "head": _spine("upperneck", 1.6),
    **_side("l", 1),
    **_side("r", -1),
}
ROOT_ORDER = ("TX", "TY", "TZ", "RX", "RY", "RZ")


def asf_text(bones, *, root_order=ROOT_ORDER, position=(0, 0, 0), length=0.45, degrees=True):
    """Return the text of an ASF file."""
    unit = (lambda angle: angle) if degrees else math.radians
    lines = ["# a skeleton", ":version 1.10", ":name VICON", ":units", "  mass 1.0", f"  length {length}"]
    lines += [f"  angle {'deg' if degrees else 'rad'}", ":documentation", "   begin: made for a test (no data), end"]
    lines += [":root", f"   order {' '.join(root_order)}", "   axis XYZ"]
    lines += [f"   position {' '.join(map(str, position))}", "   orientation 0 0 0", ":bonedata"]
    for number, (name, bone) in enumerate(bones.items(), 1):
        lines += ["  begin", f"     id {number}", f"     name {name}"]
        lines += [f"     direction {' '.join(map(str, bone.direction))}", f"     length {bone.length}"]
        lines += [f"     axis {' '.join(str(unit(angle)) for angle in bone.axis)}  {bone.order}"]
        if bone.dof:
            limits = ["(-160.0 20.0)"] + ["           (-70.0 70.0)"] * (len(bone.dof) - 1)
            lines += [f"    dof {' '.join(bone.dof)}", "    limits " + "\n".join(limits)]
        lines += ["  end"]
    lines += [":hierarchy", "  begin"]
    for parent in dict.fromkeys(bone.parent for bone in bones.values()):
        lines += [f"    {parent} {' '.join(name for name, bone in bones.items() if bone.parent == parent)}"]
    return "\n".join([*lines, "  end", ""])


def amc_text(frames, *, first=1, degrees=True):
    """Return the text of an AMC file; each frame has the values of the bones by name."""
    lines = ["#!OML:ASF F:\\VICON\\rory3.ASF", ":FULLY-SPECIFIED", ":DEGREES" if degrees else ":RADIANS"]
    for number, frame in enumerate(frames, first):
        lines.append(str(number))
        lines += [" ".join([name, *map(str, values)]) for name, values in frame.items()]
    return "\n".join(lines) + "\n"


def stand():
    """Return one frame of the humanoid in its rest posture, its root at 17.0 units."""
    return {"root": [3, 17.0, -20, 0, 0, 0]} | {name: [0] * len(b.dof) for name, b in BODY.items() if b.dof}


ASF, AMC = asf_text(BODY), amc_text([stand(), stand()])
