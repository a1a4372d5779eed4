"""How many observers a trait axis takes: ``python -m benchmarks.observers [--short]``.

Simulated observers see how happy synthetic walkers are, with noise, and rate them as in Troje 2002, section 4. Their
mean ratings become an axis, which is held against the axis that was planted: once that which the trait itself gives,
of the very same walkers, so that nothing but the ratings comes between both; and once that which goes along with the
trait in the whole population, which walkers that are few would miss even if their traits were known.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks._command import run
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table
from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.ratings.intraclass import intraclass_correlation
from eigenwalker.experiment.ratings.traits import ratings_to_traits
from eigenwalker.experiment.simulated.observers import simulate_answers
from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.study import Study, make_study
from eigenwalker.experiment.tasks import RatingTask
from eigenwalker.model import FourierLinearizer, TraitRegressor, make_eigenwalkers

_TRAIT = "happy"
_N_WALKERS, _N_OBSERVERS = 80, 3  # of the paper
_OBSERVERS = (1, 2, 3, 6, 12, 24)
_NOISES = (0.5, 1.0, 1.5, 2.5)  # in standard deviations of the trait, from trial to trial
_WALKERS = (40, 80, 160, 320)
_WANTED = 0.9


class _Pool(NamedTuple):
    """Walkers as vectors, their trait in standard deviations, and what goes along with it in all of them."""

    vectors: pd.DataFrame
    trait: pd.Series
    together: NDArray[np.float64]

    def draw(self, n_walkers: int, n_sets: int) -> Iterator[NDArray[np.intp]]:
        """Yield who is in each set."""
        random = np.random.default_rng(n_walkers)
        for _ in range(n_sets):
            yield random.permutation(len(self.vectors))[:n_walkers]


def findings(*, short: bool) -> list[Check]:
    """Print the tables, and return what was asked for."""
    with threadpool_limits(1):
        print(describe_machine())
        pool = _make_pool(400 if short else 2000)
        n_sets = 10 if short else 100
        print(
            f"Pool: {len(pool.vectors)} walkers of make_walkers(duration=4, frame_rate=60). Cosines of axes of 15 "
            f"Eigenwalkers, direction pattern,\nscaling blocks, in scaled features; median over {n_sets} sets of "
            "walkers, in brackets the 5 % quantile.\nThree viewpoints, six buttons; observers "
            f"with taste 0.5, bias 0.5 and gain 0.2 (simulate_answers).\nPlanted: the trait {_TRAIT!r}."
        )
        found = _by_observers(pool, n_sets)
        _by_walkers(pool, n_sets)
    return found


def _make_pool(n_walkers: int) -> _Pool:
    walkers = make_walkers(n_walkers, duration=4, frame_rate=60, random_state=0)
    vectors = FourierLinearizer().set_output(transform="pandas").fit_transform(walkers.data)
    traits = walkers.target.assign(gender=np.where(walkers.target["gender"] == "male", 1.0, -1.0))
    return _Pool(vectors, traits[_TRAIT], (walkers.feature_axes @ traits.corr())[_TRAIT].to_numpy())


def _make_study(n_walkers: int, n_observers: int) -> Study:
    stimuli = [Stimulus(f"walker_{number}") for number in range(n_walkers)]
    return make_study(RatingTask(("sad", _TRAIT)), walks=stimuli, n_participants=n_observers, random_state=0)


def _by_observers(pool: _Pool, n_sets: int) -> list[Check]:
    """Print cosines against the number of observers and their noise."""
    study = _make_study(_N_WALKERS, max(_OBSERVERS))
    cosines = np.empty((len(_NOISES), len(_OBSERVERS), n_sets, 2))
    agreements = np.empty((len(_NOISES), n_sets, 2))
    best = np.empty(n_sets)
    for number, some in enumerate(pool.draw(_N_WALKERS, n_sets)):
        walkers = _know(pool, some, study)
        best[number] = walkers.best
        for row, noise in enumerate(_NOISES):
            answers = simulate_answers(study, truth=walkers.trait, noise=noise, random_state=number)
            agreements[row, number] = _agreements(answers)
            for column, n_observers in enumerate(_OBSERVERS):
                asked = answers[answers["participant"] <= n_observers]
                cosines[row, column, number] = walkers.cosines(asked)
    header = ["observers", *[f"noise {noise:g}" for noise in _NOISES]]
    icc = [
        [name, *[f"{value:.2f}" for value in np.median(agreements[:, :, at], axis=1)]]
        for at, name in enumerate(("ICC(2,1), one view", "ICC(2,1), three views"))
    ]
    titles = (
        f"Axes of {_N_WALKERS} rated walkers, and the axis of the same walkers' trait itself",
        f"The same, and what goes along with the trait in the population; the trait itself: {_summary(best)}",
    )
    for at, title in enumerate(titles):
        rows = [[f"{n}", *map(_summary, cosines[:, row, :, at])] for row, n in enumerate(_OBSERVERS)]
        print_table(title, header, [*icc, *rows])
    return _checks(cosines, agreements)


def _checks(cosines: NDArray[np.float64], agreements: NDArray[np.float64]) -> list[Check]:
    noise, observers = _NOISES.index(1.0), _OBSERVERS.index(_N_OBSERVERS)
    paper = cosines[noise, observers, :, 0]
    icc = float(np.median(agreements[noise, :, 0]))
    enough = cosines.shape[2] >= 50  # of fewer sets of walkers the order of near means says nothing
    means = cosines[..., 0].mean(axis=2)[:, [_OBSERVERS.index(n) for n in (1, 3, 12)]]  # (n_noises, 3)
    return [
        Check(
            f"{_N_WALKERS} walkers, {_N_OBSERVERS} observers, 3 views, noise 1 (ICC {icc:.2f}): cosine above {_WANTED}",
            _summary(paper),
            bool(np.median(paper) > _WANTED),
        ),
        Check(
            "1, 3 and 12 observers find the axis the better the more they are, and the less noise, on average",
            f"{means.min():.2f} to {means.max():.3f}",
            bool((np.diff(means, axis=1) > 0).all() and (np.diff(means, axis=0) < 0).all()) if enough else None,
        ),
    ]


def _by_walkers(pool: _Pool, n_sets: int) -> None:
    """Print cosines of three observers against the number of walkers."""
    rows = []
    for n_walkers in _WALKERS:
        study = _make_study(n_walkers, _N_OBSERVERS)
        found = np.empty((n_sets, 3))
        for number, some in enumerate(pool.draw(n_walkers, n_sets)):
            walkers = _know(pool, some, study)
            answers = simulate_answers(study, truth=walkers.trait, random_state=number)
            found[number] = [*walkers.cosines(answers), walkers.best]
        rows.append([str(n_walkers), *map(_summary, found.T)])
    header = ["walkers", "with the same walkers' trait", "with the population", "trait itself, with the population"]
    print_table(f"More walkers, {_N_OBSERVERS} observers, noise 1", header, rows)


class _Walkers(NamedTuple):
    """Walkers of a study as scores of Eigenwalkers, their trait, and what ratings should find, in scaled features."""

    scores: NDArray[np.float64]
    components: NDArray[np.float64]
    trait: pd.Series
    own: NDArray[np.float64]
    population: NDArray[np.float64]

    @property
    def best(self) -> float:
        """Cosine of the trait's own axis with that of the population."""
        return _cosine(self.own, self.population)

    def cosines(self, answers: pd.DataFrame) -> tuple[float, float]:
        """Return how near the axis of ratings is to that of the trait itself, and to that of the population."""
        rated = ratings_to_traits(answers, walks=self.trait.index.tolist())[_TRAIT]
        found = _axis(self.scores, rated) @ self.components
        return _cosine(found, self.own), _cosine(found, self.population)


def _know(pool: _Pool, some: NDArray[np.intp], study: Study) -> _Walkers:
    """Return walkers of the pool as those of a study; Eigenwalkers do not depend on what is rated."""
    trait = pool.trait.iloc[some].set_axis([one.name for one in study.stimuli])
    reduction = make_eigenwalkers()[1:-1]
    scores = reduction.fit_transform(pool.vectors.iloc[some])
    components = reduction["eigenwalkers"].components_
    population = pool.together / reduction["scaler"].scale_
    return _Walkers(scores, components, trait, _axis(scores, trait) @ components, population)


def _axis(scores: NDArray[np.float64], labels: pd.Series) -> NDArray[np.float64]:
    """Return what alpha = 1 changes in the scores."""
    axis = TraitRegressor().fit(scores, labels.to_numpy())
    return axis.step([[1.0]], axis.trait_names_)[0]


def _agreements(answers: pd.DataFrame) -> tuple[float, float]:
    """Return the intraclass correlations of single observers: of a rating, and of the mean over views."""
    table = answers.pivot(index="stimulus", columns=["view", "participant"], values="value")
    single = [intraclass_correlation(table[view]).value for view in table.columns.levels[0]]
    means = table.T.groupby(level="participant").mean().T
    return float(np.mean(single)), intraclass_correlation(means).value


def _cosine(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    return float(one @ other / np.linalg.norm(one) / np.linalg.norm(other))


def _summary(values: Sequence[float] | NDArray[np.float64]) -> str:
    return f"{np.median(values):.3f} ({np.quantile(values, 0.05):.3f})"


if __name__ == "__main__":
    run(findings, __doc__, short="400 walkers and 10 sets instead of 2,000 and 100")
