"""Made walks in the skeleton of a file, so that they move that file's character."""

from collections.abc import Mapping
from pathlib import Path

from eigenwalker._validation import WalkError
from eigenwalker.io.formats import read_walk
from eigenwalker.motion.posture import lean_back
from eigenwalker.motion.walk import JointWalk

__all__ = ["in_skeleton_of"]


def in_skeleton_of(file: Path, walk: JointWalk, *, reading: Mapping[str, object]) -> JointWalk:
    """Return an upright walk in the skeleton of a file, with its bones and the axes of its joints.

    Parameters
    ----------
    file : Path
        With joints, such as BVH; the same as those of the walk.
    walk : JointWalk
        From a model of prepared walks.
    reading : dict
        Arguments of `read_walk`.

    Raises
    ------
    WalkError, ValueError
        If the file has markers, or other joints.
    """
    original = read_walk(file, **reading)
    if not isinstance(original, JointWalk):
        raise WalkError(f"--skeleton: expected a file with joints, such as BVH, got the markers of {file}")
    return lean_back(walk, original)
