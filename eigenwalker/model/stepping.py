"""Steps along trait axes, from where a walk is in the space of its features."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from sklearn.pipeline import Pipeline

from eigenwalker._validation import check_choice
from eigenwalker.model._guards import distances, warn_outside
from eigenwalker.model.blocks import in_part
from eigenwalker.model.eigenwalkers import split_model, trait_axes
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["Start", "check_traits", "label_of", "start_from", "step_from", "trait_name", "with_names"]


class Start(NamedTuple):
    """Where a step begins: alphas, score and vector, shape (1, ...), and what the features do not hold."""

    alphas: NDArray[np.float64]
    score: NDArray[np.float64]
    vector: NDArray[np.float64]
    kept: dict[str, Any]


def start_from(model: Pipeline, walk: Walk | JointWalk) -> Start:
    """Return where a step begins that changes a walk, one that the model's linearizer takes."""
    _, linearizer, reduction = split_model(model)
    vector = linearizer.transform([walk])
    kept = {name: getattr(walk, name) for name in ("speed", "size") if name not in linearizer.extras}
    score = reduction.transform(vector)
    return Start(np.asarray(model[-1].transform(score)), np.asarray(score), np.asarray(vector), kept)


def check_traits(model: Pipeline, names: list[str], alphas: NDArray[np.float64], hold: Sequence[str]) -> list[str]:
    """Return the names of the traits that are held, or raise unless alphas are finite and nothing is set and held."""
    if isinstance(hold, str):
        raise ValueError(f"hold must be a sequence of traits, ({hold!r},), got {hold!r}")
    if not np.isfinite(alphas).all():
        raise ValueError(f"alphas must be finite, got {', '.join(map(str, alphas[~np.isfinite(alphas)]))}")
    held = list(dict.fromkeys(trait_name(model, trait) for trait in hold))
    both = sorted(set(names) & set(held))
    if both:
        raise ValueError(f"a trait is either set or held, got both for {', '.join(both)}")
    return held


def step_from(
    model: Pipeline,
    start: Start,
    names: list[str],
    steps: NDArray[np.float64],
    held: list[str],
    labels: list[str],
    *,
    part: str | None = None,
    stacklevel: int = 4,
) -> NDArray[np.float64]:
    """Return the vectors that lie some steps along trait axes away from a start.

    Parameters
    ----------
    model : Pipeline
        Fitted.
    start : Start
        Where the steps begin.
    names : list of str
        The traits stepped along.
    steps : ndarray of shape (n_walks, n_names)
        How far, in the trait step's `alpha_unit`.
    held : list of str
        Traits that stay where they are.
    labels : list of str
        What the walks are called, for warnings and errors.
    part : {"structure", "dynamics"}, default None
        See `walk_along_axis`.
    stacklevel : int, default 4
        As in `warnings.warn`; 4 is who called the function that calls this one.

    Returns
    -------
    ndarray of shape (n_walks, n_features)
        What the Eigenwalkers leave out of the start stays.
    """
    axes = trait_axes(model)
    _, linearizer, reduction = split_model(model)
    scores = start.score + axes.step(np.pad(steps, ((0, 0), (0, len(held)))), [*names, *held])
    changes = reduction.inverse_transform(scores) - reduction.inverse_transform(start.score)
    features = linearizer.get_feature_names_out()
    vectors = start.vector + np.where(in_part(features, part), changes, 0.0)
    own = start.alphas[0, [axes.trait_names_.index(name) for name in names]]
    column = list(features).index("frequency")
    _check_reachable(start.vector[0, column], vectors[:, column], own, own + steps, labels)
    # With a part alone these are not the scores stepped to.
    reached = np.asarray(reduction.transform(with_names(vectors, features, reduction)))
    distance = distances(reached - axes.mean_, axes.covariance_)
    warn_outside(distance, axes.distance_limit(), labels, stacklevel=stacklevel)
    return vectors


def with_names(vectors: NDArray[np.float64], names: NDArray[np.object_], steps: Pipeline) -> ArrayLike:
    """Return vectors as steps were fitted to them: with the names of features, or without."""
    return pd.DataFrame(vectors, columns=names) if hasattr(steps[0], "feature_names_in_") else vectors


def _check_reachable(
    frequency: float,
    frequencies: NDArray[np.float64],
    own: NDArray[np.float64],
    alphas: NDArray[np.float64],
    labels: list[str],
) -> None:
    """Raise if a walk's frequency is not positive, and say which alphas, on the way to it, come near to 0."""
    worst = int(np.argmin(frequencies))
    if frequencies[worst] > 0:
        return
    reach = own + (alphas[worst] - own) * frequency / (frequency - frequencies[worst])  # frequency is linear in alpha
    raise ValueError(
        f"{labels[worst]}: no walk lies that far out, its frequency would be {frequencies[worst]:.3g} Hz; on the way "
        f"there it becomes 0 at alpha = {', '.join(f'{alpha:.3g}' for alpha in reach)}, stay well before that"
    )


def label_of(names: list[str], alphas: NDArray[np.float64]) -> str:
    """Return what a walk with alphas on axes is called, "happy +2, weight -1"."""
    return ", ".join(f"{name} {alpha:+g}" if alpha else f"{name} 0" for name, alpha in zip(names, alphas, strict=True))


def trait_name(model: Pipeline, trait: str | int) -> str:
    """Return the name of a trait, given by name or position, or raise an error that lists the names."""
    names = model[-1].trait_names_
    if isinstance(trait, int) and not isinstance(trait, bool):
        if not -len(names) <= trait < len(names):
            raise ValueError(f"trait must be a position below {len(names)} or one of {names}, got {trait}")
        return names[trait]
    check_choice(trait, names, name="trait")
    return str(trait)
