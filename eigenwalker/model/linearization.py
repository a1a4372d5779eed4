"""Walks as points of a linear space: Fourier coefficients (Troje 2002, section 2) and their scaling."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.utils.validation import check_array, check_is_fitted

from eigenwalker._validation import WalkError, check_finite, check_walks
from eigenwalker.motion.fourier import evaluate_harmonics, explained_by, fit_harmonics, reference_phase, shift_phase
from eigenwalker.motion.phase import find_stride, phase_weights
from eigenwalker.motion.robust import fit_harmonics_robust
from eigenwalker.motion.template import check_alike, fill_template, one_frame
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["FourierLinearizer"]

_EXTRAS = ("speed", "size")


class FourierLinearizer(TransformerMixin, BaseEstimator):
    r"""Turn each walk into the vector of its Fourier coefficients, and vectors back into walks.

    .. math:: p(t) = p_0 + \sum_{k=1}^{K} s_k \sin(k \omega t) + c_k \cos(k \omega t) + err

    (Troje 2002, Eq. 1.) The frequency is the walk's own where it is known, `Walk.frequency`, else it is found by
    variable projection on all channels; time zero is where the first
    harmonic of the phase reference is a pure cosine with positive sign, so that all walks are in the same phase.
    With 15 markers and 2 harmonics a walk has 5 x 45 + 1 = 226 features.

    Learns nothing across walks: `fit` records only which channels there are.

    Parameters
    ----------
    n_harmonics : int, default 2
        Number K of harmonics, the fundamental included.
    phase_reference : "auto" or mapping of str to float, default "auto"
        Channels, with weights, that carry the phase. "auto" is left minus right ankle, forward; for joint walks left
        minus right hip flexion. It is fair to both sides: a mirrored walk has the same features with the names of
        left and right exchanged and the sign of y and of the odd harmonics turned.
    extras : sequence of {"speed", "size"}, default ()
        Further features, in m/s, and as the factor that was taken out of the positions.
    n_cycles : float, default 10
        Strides in a walk that `inverse_transform` makes.
    frame_rate : float, default 120.0
        Frames per second of a walk that `inverse_transform` makes.
    robust : bool, default False
        Whether frames in which a marker jumps are weighted down, see `fit_harmonics_robust`: for noisy sensors.
    warn_below : float, default 0.5
        Explained power below which `transform` warns, naming the walks.

    Attributes
    ----------
    template_ : Walk or JointWalk
        One frame of the first walk in `fit`: its kind, its channels.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.model import FourierLinearizer
    >>> walks = make_walkers(4, random_state=0).data
    >>> linearizer = FourierLinearizer().fit(walks)
    >>> vectors = linearizer.transform(walks)
    >>> vectors.shape
    (4, 226)
    >>> linearizer.inverse_transform(vectors)[0].positions.shape[1:]
    (15, 3)
    """

    def __init__(
        self,
        n_harmonics: int = 2,
        *,
        phase_reference: str | Mapping[str, float] = "auto",
        extras: Sequence[str] = (),
        n_cycles: float = 10,
        frame_rate: float = 120.0,
        robust: bool = False,
        warn_below: float = 0.5,
    ) -> None:
        self.n_harmonics = n_harmonics
        self.phase_reference = phase_reference
        self.extras = extras
        self.n_cycles = n_cycles
        self.frame_rate = frame_rate
        self.robust = robust
        self.warn_below = warn_below

    def fit(self, X: Sequence[Walk | JointWalk], y: object = None) -> Self:
        """Record which channels the walks have.

        Parameters
        ----------
        X : list of Walk or JointWalk
            Prepared walks, all with the same channels.
        y : object, default None
            Ignored.

        Returns
        -------
        self

        Raises
        ------
        WalkError
            If the walks differ in their channels or lack those of the phase reference.
        ValueError
            If a parameter is out of range.
        """
        walks = check_walks(X, kind=(Walk, JointWalk))
        if int(self.n_harmonics) != self.n_harmonics or self.n_harmonics < 1:
            raise ValueError(f"n_harmonics must be a whole number of at least 1, got {self.n_harmonics!r}")
        unknown = [name for name in self.extras if name not in _EXTRAS]
        if unknown or isinstance(self.extras, str):
            raise ValueError(f"extras must be a sequence out of {', '.join(_EXTRAS)}, got {self.extras!r}")
        phase_weights(walks[0], self.phase_reference)
        self.template_ = one_frame(walks[0])
        check_alike(walks, self.template_)
        return self

    def transform(self, X: Sequence[Walk | JointWalk]) -> NDArray[np.float64]:
        """Return the feature vectors.

        Parameters
        ----------
        X : list of Walk or JointWalk
            Prepared walks with the channels of `fit`.

        Returns
        -------
        ndarray of shape (n_walks, n_features)
            Columns as in `get_feature_names_out`.

        Raises
        ------
        WalkError
            If a walk has other channels, values that are not finite, no period, less than one stride, or no
            known value for one of `extras`.
        """
        check_is_fitted(self)
        walks = check_walks(X, kind=(Walk, JointWalk))
        check_alike(walks, self.template_)
        weights = phase_weights(self.template_, self.phase_reference)
        vectors = np.empty((len(walks), self._n_features))
        poor = []
        for vector, (walk, frequency, coefficients, power) in zip(vectors, self._fit_each(walks), strict=True):
            aligned = shift_phase(coefficients, reference_phase(coefficients, weights))
            vector[: aligned.size] = aligned.ravel()  # (2 K + 1, n_channels) -> blocks one after the other
            vector[aligned.size :] = [frequency, *self._extras_of(walk)]
            if power < self.warn_below:
                poor.append(f"{walk.name!r} {power:.0%}")
        if poor:
            warnings.warn(
                f"{self.n_harmonics} harmonics explain less than {self.warn_below:.0%} of the motion in {len(poor)} of "
                f"{len(walks)} walks: {', '.join(poor[:10])}{' ...' if len(poor) > 10 else ''}; were they prepared?",
                stacklevel=2,
            )
        return vectors

    def inverse_transform(self, X: ArrayLike) -> list[Walk | JointWalk]:
        """Return the walks that feature vectors stand for.

        Parameters
        ----------
        X : array-like of shape (n_walks, n_features)
            Columns as in `get_feature_names_out`.

        Returns
        -------
        list of Walk or JointWalk
            `n_cycles` strides at `frame_rate`, starting at phase zero. Their `speed` and `size` are those among the
            features, else unknown and 1. The root of joint walks stays where it was in the template.

        Raises
        ------
        ValueError
            If a vector has a frequency that is not positive, or a harmonic beyond half the frame rate.
        """
        check_is_fitted(self)
        vectors = check_array(X, dtype=np.float64, input_name="X")
        if vectors.shape[1] != self._n_features:
            raise ValueError(f"expected {self._n_features} features a walk, got {vectors.shape[1]}")
        return [self._to_walk(vector, f"walk {position}") for position, vector in enumerate(vectors)]

    def residual_power(self, walks: Sequence[Walk | JointWalk]) -> NDArray[np.float64]:
        """Return which share of each walk's power the harmonics leave, 1 - `explained_power`.

        Parameters
        ----------
        walks : list of Walk or JointWalk
            Prepared walks with the channels of `fit`.

        Returns
        -------
        ndarray of shape (n_walks,)
        """
        check_is_fitted(self)
        walks = check_walks(walks, kind=(Walk, JointWalk))
        check_alike(walks, self.template_)
        return np.array([1.0 - power for *_, power in self._fit_each(walks)])

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Return the names of the features: ``mean_head_x`` ... ``cos2_right_ankle_z``, ``frequency``, the extras.

        Parameters
        ----------
        input_features : object, default None
            Ignored; the input is walks.
        """
        check_is_fitted(self)
        blocks = ["mean"] + [f"{wave}{k}" for k in range(1, self.n_harmonics + 1) for wave in ("sin", "cos")]
        names = [f"{block}_{channel}" for block in blocks for channel in self.template_.channel_names]
        return np.array([*names, "frequency", *self.extras], dtype=object)

    @property
    def _n_features(self) -> int:
        return (2 * self.n_harmonics + 1) * len(self.template_.channel_names) + 1 + len(self.extras)

    def _fit_each(
        self, walks: list[Walk | JointWalk]
    ) -> Iterator[tuple[Walk | JointWalk, float, NDArray[np.floating], float]]:
        """Yield each walk with its frequency, its coefficients from its first frame on, and its explained power."""
        weights = phase_weights(self.template_, self.phase_reference)
        for walk in walks:
            channels = walk.channels
            check_finite(channels, walk.channel_names, walk=walk.name)
            frequency = find_stride(channels, walk.frame_rate, weights, known=walk.frequency, name=walk.name)
            coefficients = self._fit_series(channels, walk.frame_rate, frequency)
            yield walk, frequency, coefficients, explained_by(coefficients, channels, walk.frame_rate, frequency)

    def _fit_series(self, channels: NDArray[np.floating], frame_rate: float, frequency: float) -> NDArray[np.floating]:
        if self.robust:
            return fit_harmonics_robust(channels, frame_rate, frequency, self.n_harmonics)[0]
        return fit_harmonics(channels, frame_rate, frequency, self.n_harmonics)

    def _extras_of(self, walk: Walk | JointWalk) -> list[float]:
        extras = [getattr(walk, name) for name in self.extras]
        if not np.isfinite(extras).all():
            unknown = [name for name, value in zip(self.extras, extras, strict=True) if not np.isfinite(value)]
            raise WalkError(
                f"walk {walk.name!r}: its {' and '.join(unknown)} must be known to be a feature; set it, "
                "dataclasses.replace(walk, speed=1.3), or leave it out of extras"
            )
        return extras

    def _to_walk(self, vector: NDArray[np.float64], name: str) -> Walk | JointWalk:
        n_rows = 2 * self.n_harmonics + 1
        n_channels = len(self.template_.channel_names)
        coefficients = vector[: n_rows * n_channels].reshape(n_rows, n_channels)
        frequency, *extras = vector[n_rows * n_channels :].tolist()
        if frequency <= 0:
            raise ValueError(
                f"{name}: expected a positive frequency, got {frequency:.3g} Hz; no walk lies that far out on the "
                "axis, use an alpha nearer to zero"
            )
        if self.n_harmonics * frequency >= self.frame_rate / 2:
            raise ValueError(
                f"{name}: harmonic {self.n_harmonics} of {frequency:.3g} Hz must lie below half of "
                f"frame_rate={self.frame_rate:g}; raise the linearizer's frame_rate"
            )
        times = np.arange(max(1, round(self.n_cycles * self.frame_rate / frequency))) / self.frame_rate
        channels = evaluate_harmonics(coefficients, frequency, times)
        known = dict(zip(self.extras, extras, strict=True))
        return fill_template(self.template_, channels, frame_rate=self.frame_rate, name=name, **known)

    def __sklearn_tags__(self):
        """Tell scikit-learn that the input is a list of walks."""
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        tags.no_validation = True
        return tags
