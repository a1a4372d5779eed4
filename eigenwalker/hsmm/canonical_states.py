"""Which of the equally likely models of walkers is the canonical one.

With D diagonal and positive, states of D z + g are as likely under the transforms (D A, D b + g) as those of z under
(A, b). `nearest_to_identity` takes of all these the one whose transforms lie nearest to the identity: for row j of the
transforms W~_i = (A~_i b~_i) of walkers i in standard units, sum_i ||(d A~_ij, d b~_ij + g) - (e_j, 0)||^2 is least for

    g = -d mean_i b~_ij,    d = sum_i A~_ijj / sum_i (||A~_ij||^2 + (b~_ij - mean_i b~_ij)^2)

but d no smaller than keeps variances above their floors: else channels at the floor, which gain by growing, would be
shrunk again and again until nothing is left of them.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.duration_transform import DurationTransform
from eigenwalker.hsmm.estimation import StateParameters
from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.transform_estimation import StandardUnits
from eigenwalker.hsmm.transformed_inference import TransformClasses, WalkerTransforms
from eigenwalker.hsmm.transforms import ChannelTransform, window_sums

__all__ = ["nearest_to_identity"]


def nearest_to_identity(
    parameters: StateParameters,
    transforms: Sequence[WalkerTransforms],
    *,
    classes: TransformClasses,
    units: StandardUnits,
    duration_units: StandardUnits,
    windows: Sequence[Sequence[float]] = WINDOWS,
    floors: ArrayLike = 0.0,
    duration_floor: float = 0.0,
) -> tuple[StateParameters, list[WalkerTransforms]]:
    """Return states and transforms that are as likely, with the transforms as near to the identity as they can be.

    Parameters
    ----------
    parameters : StateParameters
        Of transformed channels and durations.
    transforms : sequence of WalkerTransforms
        Of each walker.
    classes : TransformClasses
        Of the states; each class is changed by itself.
    units, duration_units : StandardUnits
        In which nearness is measured.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window.
    floors, duration_floor : array-like of shape (n_features,), default 0.0, and float, default 0.0
        Variances that none becomes smaller than.

    Returns
    -------
    parameters : StateParameters
    transforms : list of WalkerTransforms

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.hsmm.duration_transform import identity_durations
    >>> from eigenwalker.hsmm.transform_estimation import standard_units
    >>> from eigenwalker.hsmm.transformed_inference import one_class
    >>> states = StateParameters(np.array([[4.0]]), np.array([[16.0]]), np.array([5.0]), np.array([1.0]))
    >>> walker = WalkerTransforms((ChannelTransform(np.array([[2.0]]), np.array([2.0])),), identity_durations())
    >>> settings = {"units": standard_units(1), "duration_units": standard_units(1), "windows": ((1.0,),)}
    >>> states, (walker,) = nearest_to_identity(states, [walker], classes=one_class(states), **settings)
    >>> states.means, states.variances, walker.channels[0]
    (array([[1.]]), array([[4.]]), ChannelTransform(matrix=array([[1.]]), bias=array([0.])))
    """
    means, variances = parameters.means.copy(), parameters.variances.copy()
    sums, n_windows = window_sums(windows), len(windows)
    least = _least_factors(variances, floors)
    moves = []
    for group in range(classes.n_states):
        states = classes.states == group
        lowest = least[states].reshape(-1, len(units.scales)).max(axis=0, initial=0.0)
        factors, shifts = _gauge(np.array([_rows(own.channels[group]) for own in transforms]), units, lowest)
        moves.append(ChannelTransform(np.diag(factors), shifts))
        means[states] = means[states] * np.tile(factors, n_windows) + np.multiply.outer(sums, shifts).ravel()
        variances[states] *= np.tile(factors, n_windows) ** 2
    lowest = _least_factors(parameters.duration_variances, duration_floor)
    durations, own_durations = _gauge_durations(parameters, transforms, classes, duration_units, lowest)
    moved = [
        WalkerTransforms(tuple(part.then(move) for part, move in zip(own.channels, moves, strict=True)), lasting)
        for own, lasting in zip(transforms, own_durations, strict=True)
    ]
    return StateParameters(means, variances, *durations), moved


def _gauge_durations(
    parameters: StateParameters,
    transforms: Sequence[WalkerTransforms],
    classes: TransformClasses,
    units: StandardUnits,
    least: NDArray[np.float64],
) -> tuple[tuple[NDArray, NDArray], list[DurationTransform]]:
    """Return means and variances of durations, and the walkers' transforms of them."""
    factors, shifts = np.empty((2, classes.n_durations))
    for group in range(classes.n_durations):
        pairs = np.array([[[own.durations.factors[group], own.durations.shifts[group]]] for own in transforms])
        lowest = least[classes.durations == group].max(initial=0.0, keepdims=True)
        factors[group], shifts[group] = (part[0] for part in _gauge(pairs, units, lowest))
    of_states = factors[classes.durations]
    means = of_states * parameters.duration_means + shifts[classes.durations]
    return (means, of_states**2 * parameters.duration_variances), [
        DurationTransform(factors * own.durations.factors, factors * own.durations.shifts + shifts)
        for own in transforms
    ]


def _least_factors(variances: NDArray[np.float64], floors: ArrayLike) -> NDArray[np.float64]:
    """Return how far standard deviations can shrink, at most 1."""
    return np.minimum(np.sqrt(np.asarray(floors, dtype=np.float64) / variances), 1.0)


def _gauge(
    rows: NDArray[np.float64], units: StandardUnits, least: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return D, not below `least`, and g for transforms W of shape (n_walkers, n_channels, n_channels + 1)."""
    matrices = rows[..., :-1] * units.scales / units.scales[:, np.newaxis]
    biases = (rows[..., :-1] @ units.origin + rows[..., -1] - units.origin) / units.scales
    means = biases.mean(axis=0)
    traces = np.einsum("ijj->j", matrices)
    factors = traces / ((matrices**2).sum(axis=(0, 2)) + ((biases - means) ** 2).sum(axis=0))
    factors = np.where(traces > 0, np.maximum(factors, least), 1.0)  # only mirrored channels have other traces
    return factors, units.origin - factors * (units.origin + units.scales * means)


def _rows(transform: ChannelTransform) -> NDArray[np.float64]:
    return np.column_stack((transform.matrix, transform.bias))
