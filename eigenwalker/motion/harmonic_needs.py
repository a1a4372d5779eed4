"""How many harmonics walks need, label by label."""

from collections.abc import Hashable, Iterable, Sequence

import numpy as np
import pandas as pd

from eigenwalker._validation import check_finite, check_walks
from eigenwalker.motion.fourier import explained_power
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["harmonics_table"]

_SHARES = (95, 99)  # percent of what the most harmonics explain


def harmonics_table(
    walks: Sequence[Walk | JointWalk],
    labels: Iterable[Hashable],
    *,
    n_harmonics: Iterable[int] = range(1, 9),
) -> pd.DataFrame:
    """Return how much of the walks of each label so many harmonics explain, and how many are enough.

    Tilmanne & Dutoit (2012, section 4) keep two for all styles and find that "more complex" styles need others.

    Parameters
    ----------
    walks : list of Walk or JointWalk
        Prepared, in place.
    labels : iterable
        One a walk: its style, its walker, ...
    n_harmonics : iterable of int, default 1 to 8
        Numbers of harmonics, the fundamental included.

    Returns
    -------
    DataFrame
        One row a label, in the order in which they first appear. Columns: n_walks; for each number of harmonics, in
        rising order, the median over the walks of their `explained_power`; needed_for_95_percent and
        needed_for_99_percent, the least of these numbers at which that median is 0.95 and 0.99 of what it is at the
        largest one, which stands for all that is periodic.

    Raises
    ------
    WalkError
        If a walk has gaps, no period or less than one stride.
    ValueError
        If there is another number of labels than of walks, or a label is missing; if a number is below 1, or its
        harmonic lies beyond half the frame rate of a walk.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import harmonics_table
    >>> table = harmonics_table(make_walkers(4, random_state=0).data, ["a", "a", "b", "b"], n_harmonics=[1, 2, 4])
    >>> table.columns.to_list()
    ['n_walks', 1, 2, 4, 'needed_for_95_percent', 'needed_for_99_percent']
    """
    walks = check_walks(walks, kind=(Walk, JointWalk))
    groups = pd.Series(list(labels), dtype=object)
    numbers = sorted(set(n_harmonics))
    if len(groups) != len(walks):
        raise ValueError(f"expected one label a walk, {len(walks)}, got {len(groups)}")
    if groups.isna().any():
        raise ValueError("labels must name the label of each walk, got a missing one; leave its walk out")
    if not numbers or numbers[0] < 1:
        raise ValueError(f"n_harmonics must be one number or more, of at least 1, got {numbers}")
    explained = pd.DataFrame([_explained(walk, numbers) for walk in walks], columns=pd.Index(numbers, dtype=object))
    grouped = explained.groupby(groups.to_numpy(), sort=False)
    medians = grouped.median().rename_axis("label")
    enough = {f"needed_for_{share}_percent": _enough(medians, share / 100) for share in _SHARES}
    table = medians.assign(**enough)
    table.insert(0, "n_walks", grouped.size())
    return table


def _explained(walk: Walk | JointWalk, numbers: Sequence[int]) -> list[float]:
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    frequency = stride_frequency(walk)
    return [explained_power(walk.channels, walk.frame_rate, frequency, number) for number in numbers]


def _enough(medians: pd.DataFrame, share: float) -> pd.Series:
    """Return the first column of each row that reaches a share of the last one."""
    reached = medians.to_numpy() >= share * medians.to_numpy()[:, -1:]
    return pd.Series(np.asarray(medians.columns)[reached.argmax(axis=1)].astype(int), index=medians.index)
