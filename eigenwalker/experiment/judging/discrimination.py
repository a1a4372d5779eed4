"""Can synthetic walks be told from recorded ones? A judge in place of the test of naturalness (Tilmanne et al. 6.2)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator
from sklearn.model_selection import StratifiedGroupKFold, StratifiedKFold, cross_val_predict

from eigenwalker._validation import check_walks
from eigenwalker.experiment.analysis.rates import Estimated, rate_interval
from eigenwalker.experiment.judging.style_judge import make_style_judge
from eigenwalker.experiment.stimulus import KINDS
from eigenwalker.model._scores import score_columns
from eigenwalker.model.intervals import score_interval
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["Discrimination", "discriminate_walks"]


class Discrimination(NamedTuple):
    """What `discriminate_walks` returns.

    Parameters
    ----------
    accuracy, auc : Estimated
        Share of right answers, and area under the curve, with intervals: 0.5 if synthetic walks, as many as recorded
        ones, cannot be told apart; 1 if they always can.
    trials : DataFrame
        One row a walk: truth and answer, "original" or "synthetic", kind (the truth), walk, and score, which is the
        higher the more synthetic it looks. `answer_shares` takes it, as it takes the answers of people.
    """

    accuracy: Estimated
    auc: Estimated
    trials: pd.DataFrame


def discriminate_walks(
    originals: Sequence[Walk | JointWalk],
    synthetics: Sequence[Walk | JointWalk],
    *,
    original_groups: ArrayLike | None = None,
    synthetic_groups: ArrayLike | None = None,
    judge: BaseEstimator | None = None,
    n_splits: int = 5,
    level: float = 0.95,
) -> Discrimination:
    """Return how well a judge tells synthetic walks from recorded ones that it has not learned from.

    Groups are never split between what is learned and what is asked. Walks of one style as a group ask whether
    synthesis can be told *as such*, in a style that the judge has only heard of: without groups a judge may learn by
    heart where the syntheses of one model lie, which resemble each other more than recordings do. Both kinds should
    have the same styles in the same numbers, or it tells styles.

    Parameters
    ----------
    originals, synthetics : list of Walk or JointWalk
        Prepared alike, see `cut_alike`.
    original_groups, synthetic_groups : array-like, default None
        Which walks are judged together: styles, for instance. Both or none.
    judge : estimator, default None
        A classifier over lists of walks. None is `make_style_judge`, which sees mean posture, frequency and three
        harmonics of all joints without noise.
    n_splits : int, default 5
        Number of folds, not more than groups or walks of a kind.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    Discrimination
        Accuracy has an interval that knows the groups, see `rate_interval`; the area that of `score_interval`.

    Raises
    ------
    ValueError
        If there are fewer than two walks of a kind, or two groups, or groups that do not fit.

    References
    ----------
    Lopez-Paz & Oquab 2017, Revisiting classifier two-sample tests.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import discriminate_walks
    >>> walks = make_walkers(20, random_state=0).data
    >>> found = discriminate_walks(walks[::2], walks[1::2])
    >>> bool(found.auc.low < 0.5 < found.auc.high)
    True
    """
    walks = [*check_walks(originals, kind=(Walk, JointWalk)), *check_walks(synthetics, kind=(Walk, JointWalk))]
    counts = len(originals), len(synthetics)
    groups = _join_groups(original_groups, synthetic_groups, counts)
    most = min(*counts, *([len(np.unique(groups))] if groups is not None else []))
    if most < 2:
        raise ValueError(f"expected two walks or more of each kind, and two groups or more, got {counts}")
    if judge is None:
        judge = make_style_judge(harmonics=(1, 2, 3), mean=True, frequency=True, share=1.0, noise=0.0)
    kinds = np.repeat(KINDS, counts)
    folds = StratifiedKFold if groups is None else StratifiedGroupKFold
    parts = folds(min(n_splits, most), shuffle=True, random_state=0)
    scores = cross_val_predict(judge, walks, kinds, groups=groups, cv=parts, method="decision_function")
    labels = np.where(kinds == KINDS[1], 1.0, -1.0)
    right = scores * labels > 0
    area = float(score_columns(scores[:, np.newaxis], labels[:, np.newaxis], "auc")[0])
    trials = pd.DataFrame(
        {
            "truth": kinds,
            "answer": np.where(scores > 0, KINDS[1], KINDS[0]),
            "kind": kinds,
            "walk": [walk.name for walk in walks],
            "score": scores,
        }
    )
    return Discrimination(
        rate_interval(right, groups, level=level),
        Estimated(area, *score_interval(scores, labels, "auc", level=level)),
        trials,
    )


def _join_groups(one: ArrayLike | None, other: ArrayLike | None, counts: tuple[int, int]) -> np.ndarray | None:
    if one is None and other is None:
        return None
    shapes = tuple(None if groups is None else np.shape(groups) for groups in (one, other))
    if shapes != tuple((count,) for count in counts):
        raise ValueError(f"expected a group for each of {counts[0]} and {counts[1]} walks, got shapes {shapes}")
    return np.concatenate((np.asarray(one), np.asarray(other)))
