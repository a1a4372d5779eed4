"""The rigs that are recognised by the names of joints or markers."""

from collections.abc import Iterable

from eigenwalker.motion.joint_rigs import JOINT_RIGS
from eigenwalker.motion.marker_rigs import MARKER_RIGS
from eigenwalker.motion.rig import Rig

__all__ = ["RIGS", "find_rig"]

RIGS: tuple[Rig, ...] = JOINT_RIGS + MARKER_RIGS
"""The rigs that `to_markers` recognises by names; the first one that fits is taken."""


def find_rig(names: Iterable[str]) -> Rig:
    """Return the rig whose joints or markers are all among `names`.

    Parameters
    ----------
    names : iterable of str
        Joints of a skeleton or recorded markers.

    Raises
    ------
    ValueError
        If no rig of `RIGS` fits; the error lists the names found and says how to pass a rig.

    Examples
    --------
    >>> from eigenwalker.motion import TROJE15, find_rig
    >>> find_rig((*TROJE15.names, "left_ear")).name
    'troje15'
    """
    found = tuple(names)
    for rig in RIGS:
        if rig.sources <= set(found):
            return rig
    known = ", ".join(dict.fromkeys(rig.name for rig in RIGS))
    raise ValueError(
        f"no known rig ({known}) fits the names {', '.join(found)}{_nearest(set(found))}; "
        "pass rig={'head': 'HEAD', 'left_knee': {'LKNE': 0.5, 'LKNM': 0.5}, ...}, a dictionary that says which of them "
        "make each of the 15 markers"
    )


def _nearest(found: set[str]) -> str:
    """Name the rig of which most is there, if that is at least half, and what is missing."""
    rig = max(RIGS, key=lambda rig: len(rig.sources & found) / len(rig.sources))
    missing = sorted(rig.sources - found)
    if len(missing) > len(rig.sources) / 2:
        return ""
    advice = ""
    if set(missing) <= {name for segment in rig.segments for name in segment.carried}:
        advice = ", which a static trial has: pass static=..."
    return f" (the nearest, {rig.name}, lacks {', '.join(missing)}{advice})"
