"""A recorded BVH file with joints that no model knows: fingers, with channels in an order of their own."""

import numpy as np

from eigenwalker.io._bvh_text import parse_bvh

__all__ = ["add_fingers"]

_FINGER = """JOINT Finger_{side}
{{
\tOFFSET 9.0 0.0 0.0
\tCHANNELS 3 Yrotation Xrotation Zrotation
\tEnd Site
\t{{
\t\tOFFSET 4.0 0.0 0.0
\t}}
}}"""


def add_fingers(file, path):
    """Write a file of `bandai2` with a finger that moves at the tip of each hand, and return its words by frame."""
    text = file.read_text()
    bvh = parse_bvh(text.encode())
    head, motion = text.split("MOTION")
    _, frames, seconds, *rows = motion.split("\n")
    rows = [row.split() for row in rows if row.strip()]
    names = [joint.name for joint in bvh.joints]
    ends = np.cumsum([len(joint.channels) for joint in bvh.joints])
    times = np.arange(len(rows)) / 30
    for side in "RL":  # from the end, so that the places before stay
        start = head.index("End Site", head.index(f"JOINT Hand_{side}"))
        stop = head.index("}", start) + 1
        head = head[:start] + _FINGER.format(side=side) + head[stop:]
        angles = np.column_stack((10 * np.sin(times), 20 * np.cos(2 * times), 30 + 5 * times))
    for side in sorted("RL", key=lambda side: -names.index(f"Hand_{side}")):
        place = ends[names.index(f"Hand_{side}")]
        for row, turn in zip(rows, angles, strict=True):
            row[place:place] = [f"{angle:.4f}" for angle in turn]
    lines = ["MOTION", frames, seconds, *(" ".join(row) for row in rows)]
    path.write_text(head + "\n".join(lines) + "\n")
    return np.array(rows)
