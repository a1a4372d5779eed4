"""From ratings back to the axis that was planted, at the size of Troje 2002, section 4.

80 walkers, 3 observers a label group, 3 viewpoints. What is planted is a trait of synthetic walkers: observers see how
happy each is, with noise. The axis of the ratings is held against that of the trait itself among the same walkers:
cosines in the scaled features of the Eigenwalkers, of what alpha = 1 changes (direction "pattern"). For other numbers
of observers, and other noise, see `python -m benchmarks.observers`.
"""

import numpy as np
import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.answers.files import read_answers, write_answers
from eigenwalker.experiment.ratings.intraclass import intraclass_correlation
from eigenwalker.experiment.ratings.traits import ratings_to_traits
from eigenwalker.experiment.simulated.observers import simulate_answers
from eigenwalker.experiment.study import make_study
from eigenwalker.experiment.tasks import RatingTask
from eigenwalker.model import FourierLinearizer, make_eigenwalkers
from eigenwalker.model.eigenwalkers import axis_features, scale_changes

MOODS = [RatingTask(("sad", "happy")), RatingTask(("relaxed", "nervous"))]
TRAITS = ["happy", "nervous"]


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(80, duration=4, frame_rate=60, random_state=0)


@pytest.fixture(scope="module")
def vectors(walkers):
    return FourierLinearizer().set_output(transform="pandas").fit_transform(walkers.data)


def study_of(walkers, n_participants, tasks=MOODS[0], seed=0):
    return make_study(tasks, walks=walkers.data, n_participants=n_participants, random_state=seed)


def axes(vectors, labels):
    """Return the axes of labels in scaled features, one row a trait."""
    reduction = make_eigenwalkers()[1:-1].fit(vectors)
    trait = make_eigenwalkers()[-1].fit(reduction.transform(vectors), labels)
    return np.vstack([trait.step([[1.0]], [name]) for name in trait.trait_names_]) @ reduction[-1].components_


def cosines(one, other):
    one, other = np.atleast_2d(one), np.atleast_2d(other)
    return (one * other).sum(axis=1) / np.linalg.norm(one, axis=1) / np.linalg.norm(other, axis=1)


def test_a_mood_that_observers_see_becomes_its_axis(walkers, tmp_path):
    # All the way: six observers in two label groups, files, the vector r, and the model of the walks themselves.
    study = study_of(walkers, 6, MOODS)
    answers = simulate_answers(study, truth=walkers.target[TRAITS], random_state=0)
    write_answers(answers, tmp_path, study=study)
    labels = ratings_to_traits(read_answers(tmp_path, study=study), walks=walkers.data)
    assert labels.shape == (80, 2)
    seen = make_eigenwalkers().fit(walkers.data, labels)
    planted = make_eigenwalkers().fit(walkers.data, walkers.target[TRAITS])
    found, wanted = (scale_changes(model, axis_features(model)) for model in (seen, planted))
    assert list(found.index) == TRAITS
    assert (cosines(found.to_numpy(), wanted.to_numpy()) > 0.9).all()


def test_the_median_over_sets_of_observers_is_above_nine_tenths(walkers, vectors):
    # Observers agree as people do: of single ratings the intraclass correlation is between 0.3 and 0.5.
    truth = walkers.target["happy"]
    wanted, study, found, agreement = axes(vectors, truth), study_of(walkers, 3), [], []
    for seed in range(15):
        answers = simulate_answers(study, truth=truth, random_state=seed)
        labels = ratings_to_traits(answers, walks=walkers.data)
        found.append(cosines(axes(vectors, labels), wanted)[0])
        for _, view in answers.groupby("view"):
            ratings = view.pivot(index="stimulus", columns="participant", values="value")
            agreement.append(intraclass_correlation(ratings).value)
    assert 0.3 < np.median(agreement) < 0.5
    assert np.median(found) > 0.95
    assert min(found) > 0.85


def test_observers_without_noise_and_with_many_buttons_give_the_very_axis(walkers, vectors):
    # Steps of 0.06 standard deviations remain.
    study = study_of(walkers, 1, RatingTask(("sad", "happy"), n_buttons=100))
    truth = walkers.target["happy"].clip(-2.9, 2.9)
    exact = {"noise": 0.0, "taste": 0.0, "bias": 0.0, "gain": 0.0}
    labels = ratings_to_traits(simulate_answers(study, truth=truth, **exact), walks=walkers.data)
    assert cosines(axes(vectors, labels), axes(vectors, truth)) > 0.9999


def test_more_observers_and_less_noise_bring_it_nearer(walkers, vectors):
    truth, study = walkers.target["happy"], study_of(walkers, 12)
    wanted, found = axes(vectors, truth), {}
    for noise in (1.0, 3.0):
        sets = [simulate_answers(study, truth=truth, noise=noise, random_state=seed) for seed in range(8)]
        for n_observers in (1, 3, 12):
            first = [answers[answers["participant"] <= n_observers] for answers in sets]
            labels = [ratings_to_traits(answers, walks=walkers.data) for answers in first]
            found[noise, n_observers] = np.mean([cosines(axes(vectors, one), wanted) for one in labels])
    for noise in (1.0, 3.0):
        assert found[noise, 1] < found[noise, 3] < found[noise, 12]
    for n_observers in (1, 3, 12):
        assert found[3.0, n_observers] < found[1.0, n_observers]


def test_what_goes_along_with_the_mood_in_the_population_is_found_as_well_as_by_the_mood_itself(walkers, vectors):
    # 80 walkers are too few for a cosine of 0.9 with it, even where their moods are known.
    numbers = walkers.target.assign(gender=np.where(walkers.target["gender"] == "male", 1.0, -1.0))
    scale = make_eigenwalkers()[1:-1].fit(vectors)[0].scale_
    population = (walkers.feature_axes @ numbers.corr())["happy"].to_numpy() / scale
    known = cosines(axes(vectors, walkers.target["happy"]), population)[0]
    answers = simulate_answers(study_of(walkers, 3), truth=walkers.target["happy"], random_state=0)
    seen = cosines(axes(vectors, ratings_to_traits(answers, walks=walkers.data)), population)[0]
    assert known > 0.8
    assert seen > known - 0.05


def test_without_a_planted_mood_there_is_no_axis_of_it(walkers, vectors):
    study, wanted = study_of(walkers, 3), axes(vectors, walkers.target["happy"])
    found = []
    for seed in range(20):
        labels = ratings_to_traits(simulate_answers(study, random_state=seed), walks=walkers.data)
        found.append(cosines(axes(vectors, labels), wanted)[0])
    assert max(found) < 0.9
    assert abs(np.mean(found)) < 4 * np.std(found) / np.sqrt(len(found))  # as often one way as the other
