"""What a fetcher returns."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.utils import Bunch

from eigenwalker.motion import JointWalk, Walk

__all__ = ["bundle"]


def bundle(
    walks: Sequence[Walk | JointWalk],
    target: pd.DataFrame,
    filenames: Sequence[Path],
    description: str,
    *,
    groups: NDArray[np.str_] | None,
    as_frame: bool,
    return_X_y: bool,
) -> Bunch | tuple[list[Walk | JointWalk], pd.DataFrame | pd.Series | NDArray]:
    """Return walks with their labels as a Bunch, or as the pair of both.

    Parameters
    ----------
    walks, target, filenames : sequence of walks, DataFrame, sequence of Path
        One row and one file a walk, in the same order.
    description : str
        The text of `DESCR`.
    groups : ndarray or None
        The person in each walk, where it is known.
    as_frame, return_X_y : bool
        As in the public fetchers.
    """
    names = pd.Index([walk.name for walk in walks], name="name")
    frame = target.set_axis(names)
    labels = frame.iloc[:, 0] if frame.shape[1] == 1 else frame
    if not as_frame:
        labels = labels.to_numpy(dtype=str if frame.shape[1] == 1 else object)
    if return_X_y:
        return list(walks), labels
    paths = [str(path) for path in filenames]
    return Bunch(
        data=list(walks),
        target=labels,
        target_names=list(frame.columns),
        groups=groups,
        frame=frame.assign(filename=paths) if as_frame else None,
        filenames=paths,
        DESCR=description,
    )
