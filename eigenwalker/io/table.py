"""Tables of marker positions: one row a frame, a column each for ``left_ankle_x`` and so on."""

from pathlib import Path

import numpy as np
import pandas as pd

from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["write_csv"]


def write_csv(walk: Walk | JointWalk, path: str | Path) -> None:
    """Write a walk as a table of positions in metres, with a column ``time`` in seconds.

    Parameters
    ----------
    walk : Walk
        What to write. Gaps become empty fields.
    path : str or Path
        Where to.

    Raises
    ------
    TypeError
        If `walk` has joints and no markers.
    """
    if not isinstance(walk, Walk):
        raise TypeError(f"expected a Walk, got {type(walk).__name__}; turn joints into markers with to_markers()")
    table = pd.DataFrame(walk.channels, columns=list(walk.channel_names))
    table.insert(0, "time", np.arange(walk.n_frames) / walk.frame_rate)
    table.to_csv(path, index=False)
