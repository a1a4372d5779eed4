r"""How strides differ from each other, and walks whose strides differ as much.

A harmonic series repeats one stride for ever, which Tilmanne & Dutoit (2012, section 4) name as its weakness.
Here stride j has coefficients and a duration of its own,

.. math:: c_j = c + d_j, \quad T_j = (1 + e_j) / f

and (d_j, e_j) are what is learned from recordings.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from sklearn.utils import check_random_state

from eigenwalker._validation import WalkError, check_array, check_walks, restore_read_only
from eigenwalker.motion.fourier import evaluate_harmonics
from eigenwalker.motion.stride_statistics import (
    degrees_of_freedom,
    lag_one_correlation,
    stride_features,
    stride_waves,
)
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["StrideVariation"]

_BLEND = 0.4  # strides over which one stride passes into the next
_LONGEST = 0.5  # share of its mean by which a duration may differ
_SAMPLES = 64  # of a stride, between which its phase is interpolated


@dataclass(frozen=True, eq=False)
class StrideVariation:
    """How the strides of a walk differ from each other: a normal distribution of their deviations.

    Parameters
    ----------
    deviations : ndarray of shape (n_strides, n_features)
        Of the strides that it was learned from, each a row, scaled such that deviations' deviations is their
        covariance. Features are the coefficients, row by row, and the duration in parts of its mean.
    correlation : float
        Between deviations of one stride and the next, the same for all features.
    channel_names : tuple of str
        Of the walks.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker import FourierLinearizer, make_walkers
    >>> from eigenwalker.motion import StrideVariation
    >>> walks = make_walkers(3, random_state=0).data
    >>> variation = StrideVariation.from_walks(walks)
    >>> vector = FourierLinearizer().fit_transform(walks)[0]
    >>> coefficients, frequency = vector[:-1].reshape(5, -1), vector[-1]
    >>> channels = variation.series(coefficients, frequency, np.arange(600) / 120, random_state=0)
    >>> channels.shape
    (600, 45)
    """

    deviations: NDArray[np.floating]
    correlation: float
    channel_names: tuple[str, ...]

    def __post_init__(self) -> None:
        deviations = check_array(self.deviations, shape=("n_strides", "n_features"), name="deviations")
        n_rows, rest = divmod(deviations.shape[1] - 1, max(1, len(self.channel_names)))
        if rest or n_rows < 3 or n_rows % 2 == 0 or not np.isfinite(deviations).all():
            raise ValueError(
                f"deviations must be finite, with 2 K + 1 coefficients a channel, {len(self.channel_names)} channels, "
                f"and a duration, got shape {deviations.shape}"
            )
        if not -1 < self.correlation < 1:
            raise ValueError(f"correlation must be between -1 and 1, got {self.correlation}")
        object.__setattr__(self, "deviations", deviations)

    def __setstate__(self, state: dict[str, object]) -> None:
        restore_read_only(self, state)

    @classmethod
    def from_walks(
        cls,
        walks: Sequence[Walk | JointWalk],
        *,
        n_harmonics: int = 2,
        phase_reference: str | Mapping[str, float] = "auto",
    ) -> Self:
        """Learn from recordings how strides differ within a walk.

        Each stride has its own coefficients, by least squares, and its own duration, see `split_strides`. Their
        deviations from the mean of their walk, of all walks together, are all that is kept: strides that are made from
        them deviate by a random mixture of recorded deviations, so that joints that go together stay together, however
        few the strides. The correlation from stride to stride is the one under which deviations from a mean over so few
        strides are expected as they are.

        Parameters
        ----------
        walks : list of Walk or JointWalk
            Prepared recordings with the same channels, of one person or one style.
        n_harmonics : int, default 2
            Number K of harmonics.
        phase_reference : "auto" or mapping of str to float, default "auto"
            See `phase_weights`.

        Returns
        -------
        StrideVariation

        Raises
        ------
        WalkError
            If no walk has two whole strides, channels differ, or a walk has no period.
        """
        walks = check_walks(walks, kind=(Walk, JointWalk))
        names = walks[0].channel_names
        differing = [walk.name for walk in walks if walk.channel_names != names]
        if differing:
            raise WalkError(f"walk {differing[0]!r}: expected the channels of the first walk, {walks[0].name!r}")
        found = [stride_features(walk, n_harmonics, phase_reference) for walk in walks]
        blocks = [features - features.mean(axis=0) for features in found if len(features) > 1]
        if not blocks:
            raise WalkError(
                f"expected at least two whole strides in a walk, to see how strides differ, got "
                f"{', '.join(f'{walk.name!r} {len(one)}' for walk, one in zip(walks, found, strict=True))}"
            )
        correlation = lag_one_correlation(blocks)
        together = np.concatenate(blocks)
        n_free = degrees_of_freedom([len(block) for block in blocks], correlation)
        return cls(together / np.sqrt(n_free), correlation, names)

    @property
    def n_harmonics(self) -> int:
        """Number K of harmonics."""
        return ((self.deviations.shape[1] - 1) // len(self.channel_names) - 1) // 2

    @property
    def coefficient_sd(self) -> NDArray[np.float64]:
        """SD of each coefficient from stride to stride, shape (2 K + 1, n_channels), in the unit of the channels."""
        return self._sd[:-1].reshape(-1, len(self.channel_names))

    @property
    def duration_sd(self) -> float:
        """SD of the duration of a stride, in parts of its mean."""
        return float(self._sd[-1])

    @property
    def _sd(self) -> NDArray[np.float64]:
        return np.sqrt((self.deviations**2).sum(axis=0))

    def series(
        self,
        coefficients: NDArray[np.floating],
        frequency: float,
        times: ArrayLike,
        *,
        scale: float = 1.0,
        random_state: Any = None,
    ) -> NDArray[np.float64]:
        """Return a walk in which every stride differs.

        Strides pass into each other over 0.4 of a stride about phase zero, so smoothly that velocity and acceleration
        have no steps.

        Parameters
        ----------
        coefficients : ndarray of shape (2 K + 1, n_channels)
            Of the mean stride, rows mean, sin1, cos1, ...; phase aligned, as those of `FourierLinearizer` are.
        frequency : float
            Mean strides a second.
        times : array-like of shape (n_times,)
            In seconds, from 0 on; at 0 the phase is zero.
        scale : float, default 1.0
            How much strides differ, in parts of what was learned. 0 is `evaluate_harmonics`.
        random_state : int, RandomState or None, default None
            Seed. Longer walks with the same seed start with the same strides.

        Returns
        -------
        ndarray of shape (n_times, n_channels)

        Raises
        ------
        ValueError
            If the coefficients have another shape, a time is negative, or `frequency` or `scale` are out of range.
        """
        coefficients = np.asarray(coefficients, dtype=np.float64)
        times = np.asarray(times, dtype=np.float64)
        self._check(coefficients, frequency, times, scale)
        if scale == 0 or not times.size:
            return evaluate_harmonics(coefficients, frequency, times)
        n_strides = int(times.max() * frequency / (1 - _LONGEST)) + 2
        drawn = scale * self._draw(n_strides, check_random_state(random_state))
        durations = (1 + np.clip(drawn[:, -1], -_LONGEST, _LONGEST)) / frequency
        counts = _counts_at(times, durations)
        basis = stride_waves(counts, self.n_harmonics)
        changes = drawn[:, :-1].reshape(len(drawn), *coefficients.shape)  # (n_strides, 2 K + 1, n_channels)
        channels = basis @ coefficients
        for stride, weights in _shares(counts, n_strides):
            channels += weights[:, np.newaxis] * np.einsum("tk,tkc->tc", basis, changes[stride])
        return channels

    def _check(self, coefficients: NDArray, frequency: float, times: NDArray, scale: float) -> None:
        expected = self.coefficient_sd.shape
        if coefficients.shape != expected:
            raise ValueError(
                f"coefficients must have shape {expected}, as this variation was learned with {self.n_harmonics} "
                f"harmonics of {expected[1]} channels, got {coefficients.shape}; learn it with from_walks(walks, "
                "n_harmonics=K)"
            )
        if times.ndim != 1 or (times < 0).any() or not np.isfinite(times).all():
            raise ValueError("times must be finite numbers of seconds from 0 on, one after the other, shape (n_times,)")
        if not 0 < frequency < np.inf:
            raise ValueError(f"frequency must be positive and finite, in hertz, got {frequency}")
        if not 0 <= scale < np.inf:
            raise ValueError(f"scale must be 0 or more, got {scale}")

    def _draw(self, n_strides: int, random: np.random.RandomState) -> NDArray[np.float64]:
        """Return deviations of strides, shape (n_strides, n_features), each correlated with the one before."""
        draws = random.standard_normal((n_strides, len(self.deviations)))
        for stride in range(1, n_strides):
            draws[stride] *= np.sqrt(1 - self.correlation**2)
            draws[stride] += self.correlation * draws[stride - 1]
        return draws @ self.deviations * self._gains()

    def _gains(self) -> NDArray[np.float64]:
        """Return by how much deviations must exceed what single strides are to show, shape (n_features,).

        A stride that passes into its neighbors, fitted by itself, has a bit of theirs: its coefficients are the sum of
        G_m d_(j + m) over m = -1, 0, 1. With V the mean variances of the rows of d, taken as uncorrelated, its own are
        the sum of (G_m * G_m') V correlation^|m - m'| over m and m'. All channels have the same gain.
        """
        counts = (np.arange(1024) + 0.5) / 1024
        shares, basis = np.array(_three_shares(counts)), stride_waves(counts, self.n_harmonics)
        near = [np.linalg.lstsq(basis, share[:, np.newaxis] * basis)[0] for share in shares]
        lags = self.correlation ** np.abs(np.subtract.outer(range(3), range(3)))
        mixing = np.einsum("mrq,nrq,mn->rq", near, near, lags)
        wanted = (self.coefficient_sd**2).mean(axis=1)
        needed = np.clip(np.linalg.solve(mixing, wanted), 0.5 * wanted, 2.0 * wanted)
        gains = np.sqrt(np.divide(needed, wanted, out=np.ones_like(wanted), where=wanted > 0))
        plain = shares.mean(axis=1)
        return np.append(np.repeat(gains, len(self.channel_names)), 1 / np.sqrt(plain @ lags @ plain))


def _counts_at(times: NDArray[np.float64], durations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how many strides have passed at some times; stride j takes durations[j], with smooth transitions."""
    counts = np.arange(len(durations) * _SAMPLES + 1) / _SAMPLES
    pace = sum((share * durations[stride] for stride, share in _shares(counts, len(durations))), np.zeros(len(counts)))
    passed = CubicSpline(counts, pace).antiderivative()(counts)  # dt / dn = pace
    return np.asarray(CubicSpline(passed, counts)(times), dtype=np.float64)


def _shares(counts: NDArray[np.float64], n_strides: int) -> Iterator[tuple[NDArray[np.intp], NDArray[np.float64]]]:
    """Yield the strides before, at and after each count, held inside of 0 ... n_strides - 1, and their shares in it."""
    at = np.floor(counts).astype(np.intp)
    for step, share in zip((-1, 0, 1), _three_shares(counts - at), strict=True):
        yield np.clip(at + step, 0, n_strides - 1), share


def _three_shares(within: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Return the shares of the stride before, of this one and of the next, at counts from 0 to 1; they sum to one."""
    before, after = 1 - _smooth_step(within / _BLEND + 0.5), _smooth_step((within - 1) / _BLEND + 0.5)
    return [before, 1 - before - after, after]


def _smooth_step(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what rises from 0 at 0 to 1 at 1 without a step in its first and second derivative."""
    x = np.clip(values, 0.0, 1.0)
    return x**3 * (10 - 15 * x + 6 * x**2)
