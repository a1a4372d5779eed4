"""How well traits are predicted for people left out, beside what tempo alone gives."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
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
    guesses, plain = pd.DataFrame(index=traits.index), pd.DataFrame(index=traits.index)
    for trait in tqdm(traits.columns, desc="leaving out", delay=2):
        known = traits[trait].notna().to_numpy()
        labels, parts = traits.loc[known, [trait]], groups[known]
        two_valued = model["trait"].is_two_valued(trait)
        regressor = TraitRegressor(poles={trait: model["trait"].poles_[trait]} if two_valued else None)
        codes = regressor.fit(vectors[known], labels).encode(labels)[:, 0]
        within = {name: values[known] for name, values in noise.items()}
        guess = _leave_out(Pipeline([*model.steps[1:-1], ("trait", regressor)]), vectors[known], labels, parts, within)
        guesses.loc[known, trait] = guess
        print(f"{trait}, leaving out one {who} at a time: {_agreement(codes, guess, two_valued)}")
        if np.isfinite(tempo[known]).all():
            guess = _leave_out(LinearRegression(), tempo[known], codes, parts, {})
            plain.loc[known, trait] = guess
            print(f"  frequency and speed alone: {_agreement(codes, guess, two_valued)}")
        if two_valued:
            means = model["trait"].alpha_means_[trait]
            print("  mean alpha: " + ", ".join(f"{group} {alpha:+.2f}" for group, alpha in means.items()))
    for label, names in styles.items():
        print(f"{label}, the highest of {len(names)} axes: {_highest(traits[names], guesses[names])}")
        if set(names) <= set(plain):
            print(f"  frequency and speed alone: {_highest(traits[names], plain[names])}")
    if who == "recording":
        print("every recording was taken for another person; if persons recur, name them with --group")


def _leave_out(axis: Any, X: NDArray, y: Any, groups: NDArray, within: Mapping[str, NDArray]) -> NDArray[np.float64]:
    return cross_val_predict(axis, X, y, groups=groups, cv=LeaveOneGroupOut(), params=dict(within)).ravel()


def _agreement(codes: NDArray[np.float64], guess: NDArray[np.float64], two_valued: bool) -> str:
    if not two_valued:
        return f"r = {np.corrcoef(codes, guess)[0, 1]:.2f} over {len(codes)} walks"
    return _shares_right(codes, np.where(guess > 0, 1.0, -1.0))


def _highest(traits: pd.DataFrame, guesses: pd.DataFrame) -> str:
    """Return how often the highest guess is that of the trait's positive end, "style=elderly" of elderly."""
    known = guesses.notna().all(axis=1).to_numpy()
    positive = np.array([name.partition("=")[2] for name in traits])
    truth = (traits[known] == positive).to_numpy().argmax(axis=1)
    return _shares_right(truth, guesses[known].to_numpy().argmax(axis=1))


def _shares_right(truth: NDArray, guess: NDArray) -> str:
    larger = pd.Series(truth).value_counts(normalize=True).max()
    return (
        f"accuracy {np.mean(truth == guess):.1%}, balanced {balanced_accuracy_score(truth, guess):.1%} "
        f"over {len(truth)} walks (always the larger group: {larger:.1%})"
    )
