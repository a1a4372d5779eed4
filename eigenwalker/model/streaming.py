"""The whole model from walks that come in parts, exact to rounding, and never more than one part in memory."""

from collections.abc import Callable, Iterable, Sequence
from copy import deepcopy
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline
from sklearn.utils._set_output import _get_output_config

from eigenwalker.model._columns import shorten, take_vectors
from eigenwalker.model._fit_of_moments import fit_steps
from eigenwalker.model._parts import LabelColumns, SharedNames, is_fitted, measure, name_part, part_reader
from eigenwalker.model.discriminant import TraitClassifier
from eigenwalker.model.eigenwalkers import split_model, trait_axes
from eigenwalker.model.moments import Moments
from eigenwalker.model.scaling import BlockScaler
from eigenwalker.model.stepping import with_names
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["fit_moments", "fit_stream"]


class _Steps(NamedTuple):
    """A model's steps: those up to the linearizer as one, and what comes after."""

    head: Pipeline
    scaler: BlockScaler | None
    pca: PCA
    trait: TraitRegressor | TraitClassifier


def fit_stream(
    model: Pipeline,
    parts: Iterable[Any] | Callable[[], Iterable[Any]],
    labels: pd.DataFrame | pd.Series | None = None,
    *,
    labels_by: str = "name",
    control: str | Sequence[str] = (),
    groups: str | None = None,
    template: Walk | JointWalk | None = None,
    alphas: bool = True,
) -> Pipeline:
    """Return a model fitted to walks that come in parts, so that a million of them need the memory of one part.

    It is the model that ``model.fit(walks, labels)`` makes of all walks at once, to rounding: scaling, Eigenwalkers,
    axes and alphas. So are the signs of Eigenwalkers, but where rounding decides them in either, as the two features
    that weigh most in one weigh the same with opposite signs. No step is approximated: all of them need means and
    scatter only, see `Moments`. What has as many numbers as there are walks is `TraitRegressor.alphas_` alone, 8 bytes
    a walk and trait.

    Parameters
    ----------
    model : Pipeline
        From `make_eigenwalkers`, or with the same kinds of steps. It stays as it is. If its linearizer is fitted, parts
        may be coefficients without a `template`.
    parts : iterable, or function that returns one
        Each part is a pair (X, y), or X alone where `labels` has the labels of all walks by name. X are feature
        vectors, an array of shape (n_walks, n_features) or a DataFrame, which may have other columns besides; or a list
        of walks. y are their labels, as `TraitRegressor` takes them. For `alphas` the parts are read twice: a generator
        will not do, a function that makes one does.
    labels : DataFrame or Series, default None
        Labels of walks; the index is their names: `Walk.name`, or the column "name" of a part. Walks without a row are
        an error; those not labeled have NaN.
    labels_by : str, default "name"
        Another column of the parts that the index of `labels` holds, such as "file".
    control : str or sequence of str, default ()
        Which columns of the labels are control variables, see `TraitRegressor.fit`.
    groups : str, default None
        Which column of the labels is the person each walk is of. For ``scaling="noise"``, and for the SD and the alphas
        of persons. One vector a person is held in memory.
    template : Walk or JointWalk, default None
        What walks look like on which the coefficients were measured: any of them, as the model takes them. None is the
        first walk of the first part. Joints that turn are learned from it as well, where a `WalkPreparer` learns any.
    alphas : bool, default True
        Whether `TraitRegressor.alphas_` are kept: where training walkers lie, for `score_walker` and for the ends of
        the sliders of `view`. With `groups` they are those of persons, and need no second reading.

    Returns
    -------
    Pipeline
        Fitted.

    Raises
    ------
    TypeError, ValueError
        If the model has other steps; if parts can be read once only, have other columns than those of the linearizer or
        than other parts, or values that are not finite; if there are too few walks. It says in which part.

    Warns
    -----
    UserWarning
        If walks in several files have the same name, and so one row of labels.

    Notes
    -----
    What comes after the linearizer takes a table of coefficients, for predictions without walks:
    ``model[1:].predict(table[model[0].get_feature_names_out()].to_numpy())``.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.model import fit_stream, make_eigenwalkers
    >>> walkers = make_walkers(24, random_state=0)
    >>> parts = [(walkers.data[:9], walkers.target["weight"][:9]), (walkers.data[9:], walkers.target["weight"][9:])]
    >>> streamed = fit_stream(make_eigenwalkers(n_components=5), parts)
    >>> at_once = make_eigenwalkers(n_components=5).fit(walkers.data, walkers.target["weight"])
    >>> bool(abs(streamed.transform(walkers.data) - at_once.transform(walkers.data)).max() < 1e-10)
    True
    """
    fitted, steps = _copy(model, template)
    read = part_reader(parts, twice=alphas and groups is None)
    if labels is not None and not isinstance(labels, (pd.DataFrame, pd.Series)):
        raise TypeError(f"labels must be a DataFrame or Series by names of walks, got {type(labels).__name__}")
    columns = LabelColumns(labels, labels_by, [control] if isinstance(control, str) else list(control), groups)
    shared = SharedNames(columns)
    moments = _add_up(read(), steps.head, columns, shared)
    if not moments.n_walks:
        raise ValueError("expected parts with walks in them, got none")
    shared.warn(stacklevel=2)
    fitted = _fit(fitted, steps, moments)
    if alphas and groups is None:
        trait_axes(fitted).alphas_ = _read_alphas(read(), fitted, columns, moments.n_walks)
    return fitted


def fit_moments(model: Pipeline, moments: Moments, *, template: Walk | JointWalk | None = None) -> Pipeline:
    """Return a model fitted to moments of feature vectors, wherever they were added up.

    Parameters
    ----------
    model : Pipeline
        As in `fit_stream`.
    moments : Moments
        Of feature vectors with their labels.
    template : Walk or JointWalk, default None
        As in `fit_stream`; None is for a model whose linearizer is fitted.

    Returns
    -------
    Pipeline
        Fitted, without `TraitRegressor.alphas_` unless the moments have groups; see `fit_stream`.

    Raises
    ------
    TypeError, ValueError
        If the model has other steps, or the moments other features than the linearizer.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.model import FourierLinearizer, Moments, fit_moments, make_eigenwalkers
    >>> walkers = make_walkers(24, random_state=0)
    >>> linearizer = FourierLinearizer().fit(walkers.data[:1])
    >>> vectors, weight = linearizer.transform(walkers.data), walkers.target["weight"]
    >>> here, there = (Moments().update(vectors[some], weight[some]) for some in (slice(9), slice(9, None)))
    >>> model = make_eigenwalkers(n_components=5).set_params(linearizer=linearizer)
    >>> fit_moments(model, here + there).transform(walkers.data).shape
    (24, 1)
    """
    if not isinstance(moments, Moments):
        raise TypeError(f"expected Moments, got {type(moments).__name__}; fit_stream takes parts themselves")
    return _fit(*_copy(model, template), moments)


def _fit(fitted: Pipeline, steps: _Steps, moments: Moments) -> Pipeline:
    total, names = moments.total(), steps.head[-1].get_feature_names_out().tolist()
    if total.n_features != len(names) or moments.feature_names not in (None, names):
        foreign = [name for name in moments.feature_names or () if name not in set(names)]
        raise ValueError(
            f"expected moments of the {len(names)} features of the linearizer in their order, got {total.n_features} "
            f"features{', also ' * bool(foreign)}{shorten(foreign)}; use Moments(linearizer.get_feature_names_out())"
        )
    # A scaler knows features by name if, in `fit`, it would be given a table.
    is_table = _get_output_config("transform", steps.head[-1])["dense"] != "default"
    fit_steps(total, steps.scaler, steps.pca, steps.trait, names if is_table else None)
    fitted.steps[: len(steps.head)] = steps.head.steps
    return fitted


def _add_up(parts: Iterable[Any], head: Pipeline, columns: LabelColumns, shared: SharedNames) -> Moments:
    """Return the moments of all parts; the head of the model is fitted to the first, if it is not fitted."""
    moments = Moments()
    for number, part in enumerate(parts):
        with name_part(number):
            X, y = columns.pair(part)
            if not len(X):
                continue
            shared.add(X)
            vectors = measure(X, head)
            moments = moments if moments.n_walks else Moments(head[-1].get_feature_names_out())
            traits, controls, persons = columns.split(y)
            moments.update(vectors, traits, control=controls, groups=persons)
    return moments


def _read_alphas(parts: Iterable[Any], fitted: Pipeline, columns: LabelColumns, n_walks: int) -> NDArray[np.float64]:
    """Return the alphas of all training walkers, shape (n_walks, n_traits)."""
    n_after = len(split_model(fitted)[2]) + 1
    head, tail = fitted[:-n_after], fitted[-n_after:]
    names, found = head[-1].get_feature_names_out(), []
    for number, part in enumerate(parts):
        with name_part(number):
            X, _ = columns.pair(part)
            if len(X):
                vectors = np.asarray(take_vectors(measure(X, head), names), dtype=np.float64)
                found.append(np.asarray(tail.transform(with_names(vectors, names, tail))))
    if sum(map(len, found)) != n_walks:
        raise ValueError(f"expected the same parts in both readings, got {n_walks} walks, then {sum(map(len, found))}")
    return np.concatenate(found)


def _copy(model: Pipeline, template: Walk | JointWalk | None) -> tuple[Pipeline, _Steps]:
    """Return a model to be fitted, of which no more than the linearizer and what comes before may be already."""
    if not isinstance(model, Pipeline):
        raise TypeError(f"expected a Pipeline as of make_eigenwalkers, got {type(model).__name__}")
    fitted = clone(model)
    n_after = len(split_model(model)[2]) + 1
    if template is None and is_fitted(model[-n_after - 1]):
        fitted.steps[:-n_after] = deepcopy(model.steps[:-n_after])
    scaler, pca, trait = _check_steps(fitted, n_after)
    head = fitted[:-n_after]
    if template is not None:
        head.fit([template])
    return fitted, _Steps(head, scaler, pca, trait)


def _check_steps(model: Pipeline, n_after: int) -> tuple[BlockScaler | None, PCA, TraitRegressor | TraitClassifier]:
    after = [step for _, step in model.steps[-n_after:]]
    scaler, others = (after[0], after[1:]) if isinstance(after[0], BlockScaler) else (None, after)
    fits = len(others) == 2 and type(others[0]) is PCA and isinstance(others[1], TraitRegressor | TraitClassifier)
    if not fits:
        raise ValueError(
            "expected a BlockScaler, or none, a PCA, and a TraitRegressor or TraitClassifier after the linearizer, as "
            f"they are fitted to moments, got {', '.join(map(repr, after))}"
        )
    pca, trait = others
    if pca.svd_solver != "full" or pca.whiten or isinstance(pca.n_components, str):
        raise ValueError(
            "expected PCA(svd_solver='full', whiten=False) with n_components a number or None, as others need the "
            f"walks themselves, got {pca!r}"
        )
    return scaler, pca, trait
