"""What the statistics of trait axes are given: walks as vectors, who walks, and labels as numbers."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import TransformerMixin, clone
from sklearn.utils.validation import check_array

from eigenwalker._validation import check_choice
from eigenwalker.model._control import take_controls
from eigenwalker.model._labels import encode, learn_coding, tabulate
from eigenwalker.model._persons import number_persons
from eigenwalker.model.blocks import take_weights
from eigenwalker.model.scaling import SCALINGS

__all__ = [
    "Labels",
    "Reduction",
    "Sample",
    "control_sample",
    "take_components",
    "take_labels",
    "take_reduction",
    "take_sample",
]


class Reduction(NamedTuple):
    """What is fitted before the trait axis: `BlockScaler(unit=scaling)` and `PCA(n_components)`."""

    n_components: int
    scaling: str | None


class Sample(NamedTuple):
    """Walks as vectors.

    Parameters
    ----------
    vectors : ndarray of shape (n_walks, n_features)
        Without features of weight 0.
    persons : ndarray of shape (n_walks,)
        Number of the person each walk is of.
    n_scalars : int
        How many of the last features are single ones.
    weights : ndarray of shape (n_features,)
        Of the features, after scaling.
    kept : ndarray of bool of shape (n_all_features,)
        Which features of the caller's these are.
    controls : ndarray of shape (n_walks, n_controls)
        What no axis may go along with.
    """

    vectors: NDArray[np.float64]
    persons: NDArray[np.intp]
    n_scalars: int
    weights: NDArray[np.float64]
    kept: NDArray[np.bool_]
    controls: NDArray[np.float64]

    @property
    def n_persons(self) -> int:
        """Number of persons."""
        return int(self.persons.max()) + 1

    def fewest_others(self, n_left_out: int = 1) -> int:
        """Return how many walks are left without the `n_left_out` persons with most walks."""
        return len(self.persons) - int(np.sort(np.bincount(self.persons))[-n_left_out:].sum())

    def take(self, walks: NDArray[np.bool_]) -> Self:
        """Return the sample of some of the walks."""
        persons = number_persons(self.persons[walks], int(walks.sum()))
        return self._replace(vectors=self.vectors[walks], persons=persons, controls=self.controls[walks])


class Labels(NamedTuple):
    """Labels as numbers, shape (n_walks, n_traits), NaN where missing; whether two-valued; whether `y` was 1-D."""

    codes: NDArray[np.float64]
    names: list[str]
    two_valued: list[bool]
    is_single: bool


def take_sample(
    vectors: object,
    groups: ArrayLike | None,
    scaling: str | None,
    *,
    n_scalars: int | None = None,
    linearizer: TransformerMixin | None = None,
    weights: Mapping[str, float] | ArrayLike | None = None,
    n_persons: int = 3,
) -> Sample:
    """Return the sample that a caller's arguments stand for.

    Raises
    ------
    ValueError
        If there are fewer than `n_persons` persons, the vectors are not finite numbers, or an argument is out of range.
    """
    check_choice(scaling, SCALINGS, name="scaling")
    names = getattr(vectors, "columns", None)
    if linearizer is not None:
        linearizer = clone(linearizer)  # learns nothing across walks, so that no fold is needed
        vectors = linearizer.fit_transform(vectors)
        names = linearizer.get_feature_names_out()
    elif isinstance(vectors, list | tuple) and len(vectors) and hasattr(vectors[0], "channels"):
        raise TypeError("expected vectors, got walks: pass linearizer=FourierLinearizer() as well, or its output")
    if n_scalars is None:
        n_scalars = 1 + len(getattr(linearizer, "extras", ()))
    array = check_array(vectors, dtype=np.float64, input_name="vectors")
    if scaling is not None and not 0 <= n_scalars < array.shape[1]:
        raise ValueError(
            f"expected posture features beside n_scalars={n_scalars} single ones, got {array.shape[1]} feature(s)"
        )
    found = take_weights(weights, array.shape[1], names)
    kept = found > 0
    n_scalars = int(kept[len(kept) - n_scalars :].sum())
    controls = np.empty((len(array), 0))
    sample = Sample(array[:, kept], number_persons(groups, len(array)), n_scalars, found[kept], kept, controls)
    if sample.n_persons < n_persons:
        raise ValueError(f"expected walks of at least {n_persons} persons, got {sample.n_persons}")
    return sample


def control_sample(sample: Sample, control: ArrayLike | None, labels: Labels) -> Sample:
    """Return the sample with control variables; see `TraitRegressor.fit`."""
    return sample._replace(controls=take_controls(control, len(sample.vectors), labels.names)[0])


def take_labels(y: object, n_walks: int) -> Labels:
    """Return labels as numbers, as `TraitRegressor` codes them: two words are -1 and +1 in alphabetical order."""
    if y is None:
        raise ValueError("requires y to be passed, but the target y is None")
    table = tabulate(y)
    if len(table) != n_walks:
        raise ValueError(f"y must have one label a walk, {n_walks}, got {len(table)}")
    codings = learn_coding(table, None)
    codes = encode(table, codings)
    # Numbers of which there are only two are two groups as well.
    two_valued = [
        coding.two_valued or set(np.unique(column[~np.isnan(column)])) == {-1.0, 1.0}
        for coding, column in zip(codings, codes.T, strict=True)
    ]
    is_single = len(getattr(y, "shape", np.shape(np.asarray(y, dtype=object)))) == 1
    return Labels(codes, [coding.name for coding in codings], two_valued, is_single)


def take_components(
    n_components: int | Iterable[int] | None, sample: Sample, *, n_left_out: int = 1
) -> NDArray[np.intp]:
    """Return the numbers of components that are asked for; None is all from 1, or 1 + n_controls, to the rank.

    Raises
    ------
    ValueError
        If a number is too small or larger than PCA accepts with any `n_left_out` persons left out.
    """
    fewest = 1 + sample.controls.shape[1]
    n_features = sample.vectors.shape[1]
    n_others = sample.fewest_others(n_left_out)
    if n_components is None:
        rank = int(np.linalg.matrix_rank(sample.vectors - sample.vectors.mean(axis=0)))
        return np.arange(fewest, max(fewest, min(rank, n_others - 1)) + 1)
    given = np.atleast_1d(np.asarray(n_components if np.ndim(n_components) == 0 else list(n_components)))  # type: ignore[arg-type]
    if given.ndim != 1 or not len(given) or not np.issubdtype(given.dtype, np.integer):
        raise ValueError(f"n_components must be a whole number, several of them, or None, got {n_components!r}")
    largest = min(n_others, n_features)
    if given.min() < fewest or given.max() > largest:
        raise ValueError(
            f"n_components must be between {fewest} and {largest}, which is what {fewest - 1} controls, {n_others} "
            f"walks without those left out and {n_features} features allow, got {n_components!r}"
        )
    return given.astype(np.intp)


def take_reduction(n_components: object, scaling: str | None, sample: Sample) -> Reduction:
    """Return the reduction to one number of components; see `take_components`."""
    if isinstance(n_components, bool) or not isinstance(n_components, int | np.integer):
        raise ValueError(f"n_components must be a whole number, got {n_components!r}")
    return Reduction(int(take_components(int(n_components), sample)[0]), scaling)
