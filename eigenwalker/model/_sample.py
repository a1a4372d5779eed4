"""What the statistics of trait axes are given: walks as vectors, who walks, and labels as numbers."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import TransformerMixin, clone
from sklearn.utils.validation import check_array

from eigenwalker._validation import check_choice
from eigenwalker.model._labels import encode, learn_coding, tabulate
from eigenwalker.model._persons import number_persons

__all__ = [
    "Labels",
    "Reduction",
    "Sample",
    "take_components",
    "take_labels",
    "take_reduction",
    "take_sample",
]


class Reduction(NamedTuple):
    """What is fitted before the trait axis: `BlockScaler(n_scalars, unit=scaling)` and `PCA(n_components)`."""

    n_components: int
    scaling: str | None
    n_scalars: int = 1
    tolerance: float = 1e-6


class Sample(NamedTuple):
    """Vectors of walks, shape (n_walks, n_features), and the number of the person each walk is of."""

    vectors: NDArray[np.float64]
    persons: NDArray[np.intp]
    n_scalars: int

    @property
    def n_persons(self) -> int:
        """Number of persons."""
        return int(self.persons.max()) + 1

    def fewest_others(self, n_left_out: int = 1) -> int:
        """Return how many walks are left without the `n_left_out` persons with most walks."""
        return len(self.persons) - int(np.sort(np.bincount(self.persons))[-n_left_out:].sum())


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
    n_persons: int = 3,
) -> Sample:
    """Return the sample that a caller's arguments stand for.

    Raises
    ------
    ValueError
        If there are fewer than `n_persons` persons, the vectors are not finite numbers, or an argument is out of range.
    """
    check_choice(scaling, ("blocks", "features", "noise", None), name="scaling")
    if linearizer is not None:
        vectors = clone(linearizer).fit_transform(vectors)  # learns nothing across walks, so that no fold is needed
    elif isinstance(vectors, list | tuple) and len(vectors) and hasattr(vectors[0], "channels"):
        raise TypeError("expected vectors, got walks: pass linearizer=FourierLinearizer() as well, or its output")
    if n_scalars is None:
        n_scalars = 1 + len(getattr(linearizer, "extras", ()))
    array = check_array(vectors, dtype=np.float64, input_name="vectors")
    if scaling is not None and not 0 <= n_scalars < array.shape[1]:
        raise ValueError(
            f"expected posture features beside n_scalars={n_scalars} single ones, got {array.shape[1]} feature(s)"
        )
    sample = Sample(array, number_persons(groups, len(array)), n_scalars)
    if sample.n_persons < n_persons:
        raise ValueError(f"expected walks of at least {n_persons} persons, got {sample.n_persons}")
    return sample


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
    """Return the numbers of components that are asked for; None is all from 1 to the rank.

    Raises
    ------
    ValueError
        If a number is below 1 or larger than PCA accepts with any `n_left_out` persons left out.
    """
    n_features = sample.vectors.shape[1]
    n_others = sample.fewest_others(n_left_out)
    if n_components is None:
        rank = int(np.linalg.matrix_rank(sample.vectors - sample.vectors.mean(axis=0)))
        return np.arange(1, max(1, min(rank, n_others - 1)) + 1)
    given = np.atleast_1d(np.asarray(n_components if np.ndim(n_components) == 0 else list(n_components)))  # type: ignore[arg-type]
    if given.ndim != 1 or not len(given) or not np.issubdtype(given.dtype, np.integer):
        raise ValueError(f"n_components must be a whole number, several of them, or None, got {n_components!r}")
    largest = min(n_others, n_features)
    if given.min() < 1 or given.max() > largest:
        raise ValueError(
            f"n_components must be between 1 and {largest}, which is what {n_others} walks without those left out and "
            f"{n_features} features allow, got {n_components!r}"
        )
    return given.astype(np.intp)


def take_reduction(n_components: object, scaling: str | None, sample: Sample) -> Reduction:
    """Return the reduction to one number of components; see `take_components`."""
    if isinstance(n_components, bool) or not isinstance(n_components, int | np.integer):
        raise ValueError(f"n_components must be a whole number, got {n_components!r}")
    return Reduction(int(take_components(int(n_components), sample)[0]), scaling, sample.n_scalars)
