"""Answers of rating studies, made of arrays."""

import numpy as np
import pandas as pd


def rating_answers(ratings, trait="happy", *, views=(0.0, 30.0, 90.0), first_participant=1):
    """Return answers for ratings of shape (n_walkers, n_observers, n_views), in random order; NaN is no row."""
    ratings = np.asarray(ratings, dtype=float)
    walker, observer, view = (axis.ravel() for axis in np.indices(ratings.shape))
    answers = pd.DataFrame(
        {
            "study": "0123456789ab",
            "participant": observer + first_participant,
            "session": view + 1,
            "trial": walker + 1,
            "task": "rating",
            "part": "main",
            "trait": trait,
            "stimulus": [f"walker {number:02d}" for number in walker],
            "view": np.asarray(views, dtype=float)[view],
            "kind": "original",
            "style": "",
            "expected": "",
            "answer": [f"{value:g}" for value in ratings.ravel()],
            "value": ratings.ravel(),
        }
    )
    return answers.dropna(subset="value").sample(frac=1, random_state=0)


def random_ratings(shape, *, walkers=1.0, observers=1.0, error=1.0, random_state=0):
    """Return ratings on six buttons, of effects with these standard deviations."""
    random = np.random.default_rng(random_state)
    effects = [
        walkers * random.normal(size=(shape[0], 1, 1)),
        observers * random.normal(size=(1, shape[1], 1)),
        error * random.normal(size=shape),
    ]
    return np.clip(np.rint(3.5 + sum(effects)), 1, 6)


def special_answers(answers, part, **changes):
    """Return the first rows as those of another part, with columns changed."""
    rows = answers.iloc[: len(next(iter(changes.values())))].assign(part=part, **changes)
    return rows.assign(trial=rows["trial"] + 1000)
