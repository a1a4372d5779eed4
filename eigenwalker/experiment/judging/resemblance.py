"""How much synthetic walks resemble recorded ones of their style (Tilmanne, Moinet & Dutoit 2012, 6.4)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist
from sklearn.base import TransformerMixin

from eigenwalker._validation import check_walks
from eigenwalker.experiment.judging.style_judge import JudgedFeatures
from eigenwalker.experiment.judging.variability import stride_variability, variance_ratio
from eigenwalker.motion.walk import JointWalk, Walk
from eigenwalker.motion.walk_measures import quality_table

__all__ = ["resemblance_table"]

_Walks = Sequence[Walk | JointWalk]


def resemblance_table(
    originals: _Walks,
    original_styles: ArrayLike,
    synthetics: _Walks,
    synthetic_styles: ArrayLike,
    *,
    features: TransformerMixin | None = None,
) -> pd.DataFrame:
    r"""Return how synthetic walks compare to recorded ones of their style, one row a style.

    Distances are medians over pairs of walks, in a space where one recorded walk is as far from another of its style as
    their features vary within styles. *dissimilarity* sets them on one scale,

    .. math:: \frac{d(synthetic, style) - d(style, style)}{d(style, others) - d(style, style)}

    0 where a synthetic walk is as far from recorded ones as they are from each other, below 0 where it is nearer, as an
    average is, and 1 where it is as far as another style.

    Parameters
    ----------
    originals, synthetics : list of Walk or JointWalk
        Prepared alike, see `cut_alike`, and at one frame rate: smoothness depends on it.
    original_styles, synthetic_styles : array-like of str
        Of each walk.
    features : transformer, default None
        From lists of walks to vectors. None is `JudgedFeatures` of three harmonics, mean posture and frequency of all
        joints without noise.

    Returns
    -------
    DataFrame
        - n_originals, n_synthetics;
        - to_style, within_style, to_others: the distances above, and dissimilarity;
        - variance_ratio, the median over channels, see `variance_ratio`;
        - stride_variability_ratio and stride_duration_ratio, of the medians over walks, see `stride_variability`;
        - jerk_ratio, of the mean squares, see `quality_table`;
        - foot_slip_m_per_step, the largest mean of a synthetic walk, and original_slip_m_per_step, the median.

    Raises
    ------
    WalkError
        If walks differ in their channels.
    ValueError
        If there is not one style a walk, a style has fewer than two originals, or there is only one style.
    """
    recorded, made = (check_walks(walks, kind=(Walk, JointWalk)) for walks in (originals, synthetics))
    truths, wanted = np.asarray(original_styles, dtype=str), np.asarray(synthetic_styles, dtype=str)
    _check_styles(truths, wanted, (len(recorded), len(made)))
    if features is None:
        features = JudgedFeatures((1, 2, 3), mean=True, frequency=True, share=1.0, noise=0.0)
    places = _within_units(features.fit(recorded).transform(recorded), truths)
    seen = features.transform(made) / places.scales
    rows = {}
    for style in np.unique(wanted):
        own, others, ours = places.points[truths == style], places.points[truths != style], seen[wanted == style]
        theirs = [walk for walk, truth in zip(recorded, truths, strict=True) if truth == style]
        rows[str(style)] = _distances(own, others, ours) | _movement(
            theirs, [walk for walk, name in zip(made, wanted, strict=True) if name == style]
        )
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("style")


def _check_styles(truths: NDArray[np.str_], wanted: NDArray[np.str_], counts: tuple[int, int]) -> None:
    if truths.shape != counts[:1] or wanted.shape != counts[1:]:
        raise ValueError(
            f"expected a style for each of {counts[0]} originals and {counts[1]} synthetics, got shapes "
            f"{truths.shape} and {wanted.shape}"
        )
    few = [str(style) for style in np.unique(wanted) if (truths == style).sum() < 2]
    if few or len(np.unique(truths)) < 2:
        raise ValueError(
            "expected two originals or more of each style, and originals of two styles or more; too few of: "
            f"{', '.join(few) or 'other styles'}"
        )


class _Places(NamedTuple):
    """Vectors of walks over the standard deviations of the features within styles, and these."""

    points: NDArray[np.float64]
    scales: NDArray[np.float64]


def _within_units(vectors: NDArray[np.float64], styles: NDArray[np.str_]) -> _Places:
    names, numbers = np.unique(styles, return_inverse=True)
    means = np.array([vectors[numbers == at].mean(axis=0) for at in range(len(names))])
    scales = np.sqrt(((vectors - means[numbers]) ** 2).sum(axis=0) / max(1, len(vectors) - len(names)))
    scales = np.where(scales > 0, scales, 1.0) * np.sqrt(vectors.shape[1])
    return _Places(vectors / scales, scales)


def _distances(own: NDArray, others: NDArray, made: NDArray) -> dict[str, float]:
    within = float(np.median(cdist(own, own)[np.triu_indices(len(own), 1)]))
    near, far = float(np.median(cdist(made, own))), float(np.median(cdist(own, others)))
    return {
        "n_originals": len(own),
        "n_synthetics": len(made),
        "to_style": near,
        "within_style": within,
        "to_others": far,
        "dissimilarity": (near - within) / (far - within),
    }


def _movement(originals: _Walks, synthetics: _Walks) -> dict[str, float]:
    qualities = [quality_table(walks) for walks in (synthetics, originals)]
    jerks = [float((table["jerk_m_per_s3"] ** 2).mean()) for table in qualities]
    varied = [np.nanmedian([stride_variability(walk) for walk in walks], axis=0) for walks in (synthetics, originals)]
    ratios = variance_ratio(synthetics, originals)
    return {
        "variance_ratio": float(np.median(ratios)) if len(ratios) else float("nan"),
        "stride_variability_ratio": float(varied[0][0] / varied[1][0]),
        "stride_duration_ratio": float(varied[0][1] / varied[1][1]),
        "jerk_ratio": jerks[0] / jerks[1],
        "foot_slip_m_per_step": float(qualities[0]["foot_slip_m_per_step"].max()),
        "original_slip_m_per_step": float(qualities[1]["foot_slip_m_per_step"].median()),
    }
