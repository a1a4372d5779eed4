"""How well traits are predicted for people left out, beside what tempo alone gives."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.linear_model import LinearRegression
from sklearn.metrics import balanced_accuracy_score
from sklearn.model_selection import LeaveOneGroupOut, cross_val_predict
from sklearn.pipeline import Pipeline
from tqdm import tqdm

from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["report_prediction"]


def report_prediction(
    model: Pipeline,
    walks: Sequence[Walk | JointWalk],
    traits: pd.DataFrame,
    groups: NDArray,
    noise: Mapping[str, NDArray],
    *,
    who: str,
    styles: Mapping[str, list[str]],
) -> None:
    """Print how well each trait is predicted for persons left out.

    Parameters
    ----------
    model : Pipeline
        Fitted.
    walks : list of Walk or JointWalk
        What it was fitted to.
    traits : DataFrame
        Their labels.
    groups : ndarray of shape (n_walks,)
        Which walks are left out together.
    noise : mapping of str to ndarray
        Further arguments of `fit`, one entry a walk.
    who : {"person", "recording"}
        What is left out.
    styles : mapping of str to list of str
        Labels that are told by which of several traits is highest.
    """
    vectors = np.asarray(model["linearizer"].transform(walks))
    tempo = np.column_stack((vectors[:, -1], [walk.speed for walk in walks]))
    fitted = model["trait"]
    guesses = pd.DataFrame(index=traits.index)
    known_tempo = np.isfinite(tempo).all(axis=1)
    for names in tqdm(_alike(traits), desc="leaving out", delay=2):
        known = traits[names[0]].notna().to_numpy()
        poles = {name: fitted.poles_[name] for name in names if fitted.is_two_valued(name)}
        steps = Pipeline([*model.steps[1:-1], ("trait", TraitRegressor(poles=poles or None))])
        within = {name: values[known] for name, values in noise.items()}
        guesses.loc[known, names] = _leave_out(steps, vectors[known], traits.loc[known, names], groups[known], within)
    for name in traits:
        known = traits[name].notna().to_numpy()
        two_valued = fitted.is_two_valued(name)
        codes = fitted.encode(traits)[known, traits.columns.get_loc(name)]
        print(f"{name}, leaving out one {who} at a time: {_agreement(codes, guesses.loc[known, name], two_valued)}")
        if known_tempo[known].all():
            guess = _leave_out(LinearRegression(), tempo[known], codes, groups[known]).ravel()
            print(f"  frequency and speed alone: {_agreement(codes, guess, two_valued)}")
        if two_valued:
            means = fitted.alpha_means_[name]
            print("  mean alpha: " + ", ".join(f"{group} {alpha:+.2f}" for group, alpha in means.items()))
    for label, names in styles.items():
        known = traits[names].notna().all(axis=1).to_numpy()
        truth = _which(traits.loc[known, names])
        guess = guesses.loc[known, names].to_numpy().argmax(axis=1)
        print(f"{label}, the highest of {len(names)} axes: {_shares_right(truth, guess)}")
        if known_tempo[known].all():
            guess = _leave_out(LinearDiscriminantAnalysis(), tempo[known], truth, groups[known])
            print(f"  frequency and speed alone, discriminant analysis: {_shares_right(truth, guess)}")
    if who == "recording":
        print("every recording was taken for another person; if persons recur, name them with --group")


def _alike(traits: pd.DataFrame) -> list[list[str]]:
    """Return the traits in groups that are known of the same walks, which one model can predict at once."""
    groups: dict[bytes, list[str]] = {}
    for name in traits:
        groups.setdefault(traits[name].notna().to_numpy().tobytes(), []).append(str(name))
    return list(groups.values())


def _leave_out(
    steps: Any, X: NDArray, y: Any, groups: NDArray, within: Mapping[str, NDArray] | None = None
) -> NDArray[np.float64]:
    return cross_val_predict(steps, X, y, groups=groups, cv=LeaveOneGroupOut(), params=dict(within or {}))


def _agreement(codes: NDArray[np.float64], guess: ArrayLike, two_valued: bool) -> str:
    guess = np.asarray(guess, dtype=np.float64)
    if not two_valued:
        return f"r = {np.corrcoef(codes, guess)[0, 1]:.2f} over {len(codes)} walks"
    return _shares_right(codes, np.where(guess > 0, 1.0, -1.0))


def _which(traits: pd.DataFrame) -> NDArray[np.intp]:
    """Return which trait each walk is at the positive end of, "style=elderly" for elderly."""
    words = np.array([name.partition("=")[2] for name in traits])
    return (traits.to_numpy(dtype=str) == words).argmax(axis=1)


def _shares_right(truth: NDArray, guess: NDArray) -> str:
    larger = pd.Series(truth).value_counts(normalize=True).max()
    return (
        f"accuracy {np.mean(truth == guess):.1%}, balanced {balanced_accuracy_score(truth, guess):.1%} "
        f"over {len(truth)} walks (always the larger group: {larger:.1%})"
    )
