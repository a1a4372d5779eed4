"""Permutation tests: exact p, the scores of scikit-learn, and who is shuffled with whom."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import pearsonr
from sklearn.metrics import accuracy_score, balanced_accuracy_score, roc_auc_score

from eigenwalker.model import loo_matrix, loo_predict, permutation_test
from eigenwalker.model._scores import score_columns

SCORES = {
    "accuracy": lambda truth, guess: accuracy_score(truth, np.where(guess > 0, 1.0, -1.0)),
    "balanced_accuracy": lambda truth, guess: balanced_accuracy_score(truth, np.where(guess > 0, 1.0, -1.0)),
    "auc": roc_auc_score,
    "r": lambda truth, guess: pearsonr(truth, guess)[0],
}


@pytest.mark.parametrize("name", SCORES)
@pytest.mark.parametrize("tied", [False, True])
def test_scores_are_those_of_scikit_learn(name, tied):
    random = np.random.default_rng(0)
    guesses = random.normal(size=(30, 6))
    truths = np.where(random.random((30, 6)) < 0.3, 1.0, -1.0)
    if tied:
        guesses = guesses.round(1)
        guesses[guesses == 0] = 0.1
    expected = [SCORES[name](truth, guess) for truth, guess in zip(truths.T, guesses.T, strict=True)]
    assert_allclose(score_columns(guesses, truths, name), expected)


def test_each_shuffle_is_a_leave_one_out_of_its_own():
    random = np.random.default_rng(1)
    vectors, labels = random.normal(size=(15, 6)), random.normal(size=15)
    result = permutation_test(
        vectors, labels, n_components=3, scaling="blocks", score="r", n_permutations=20, random_state=0
    )
    predicted = loo_predict(vectors, labels, n_components=3, scaling="blocks")
    assert_allclose(result.score, pearsonr(labels, predicted)[0])
    assert_allclose(result.p_value, (1 + np.sum(result.null >= result.score)) / 21)
    # The shuffles that random_state=0 stands for.
    keys = np.random.RandomState(np.random.RandomState(0).randint(2**31 - 1)).random_sample((20, 15))
    for null, order in zip(result.null, np.argsort(keys, axis=1), strict=True):
        predicted = loo_predict(vectors, labels[order], n_components=3, scaling="blocks")
        assert_allclose(null, pearsonr(labels[order], predicted)[0])


def test_ties_count_against_the_labels():
    """With predictions that do not depend on the labels all scores are equal, and p is 1."""
    result = permutation_test(np.zeros((6, 6)), [-1, 1] * 3, n_permutations=99, random_state=0)
    assert result.score == 0.0
    assert result.p_value == 1.0


def test_a_clear_difference_gives_the_smallest_p():
    codes = np.repeat([-1.0, 1.0], 15)
    vectors = np.random.default_rng(2).normal(size=(30, 8))
    vectors[:, 0] += 6 * codes
    words = np.where(codes > 0, "male", "female")
    clear = permutation_test(vectors, words, n_components=3, n_permutations=500, random_state=0)
    assert clear.score == 1.0
    assert_allclose(clear.p_value, 1 / 501)
    assert clear.null.shape == (500,)


def test_persons_keep_one_label():
    random = np.random.default_rng(4)
    persons = np.repeat(np.arange(20), 2)
    codes = np.where(np.arange(20) < 6, 1.0, -1.0)
    matrix = random.normal(size=(40, 40))
    result = permutation_test(matrix, codes[persons], persons, score="auc", n_permutations=50, random_state=0)
    assert_allclose(result.score, roc_auc_score(codes, (matrix @ codes[persons]).reshape(20, 2).mean(axis=1)))
    assert result.null.shape == (50,)
    with pytest.raises(ValueError, match="labels must be the same for all walks of a person"):
        permutation_test(np.zeros((2, 2)), [-1, 1], ["anna", "anna"])


def test_strata_are_shuffled_by_themselves():
    """With one label a stratum every shuffle is the labels themselves."""
    strata = np.array(["b", "a", "b", "a", "c", "c"])
    labels = np.where(strata == "a", 1.0, -1.0)
    matrix = np.random.default_rng(5).normal(size=(6, 6))
    result = permutation_test(matrix, labels, strata=strata, n_permutations=30, random_state=0)
    assert (result.null == result.score).all()
    # Sums over strata stay as they are, sums over anything else do not.
    numbers = np.arange(6.0)
    for weights, changes in (((strata[:, np.newaxis] == strata) * 1.0, False), (matrix, True)):
        shuffled = permutation_test(weights, numbers, strata=strata, score="r", n_permutations=30, random_state=0)
        assert (np.ptp(shuffled.null) > 1e-9) == changes


def test_several_traits_see_the_same_shuffles():
    random = np.random.default_rng(6)
    vectors, labels = random.normal(size=(14, 5)), random.normal(size=(14, 2))
    both = permutation_test(vectors, labels, n_components=2, score="r", n_permutations=60, random_state=1)
    assert both.null.shape == (60, 2)
    for trait in range(2):
        alone = permutation_test(
            vectors, labels[:, trait], n_components=2, score="r", n_permutations=60, random_state=1
        )
        assert_allclose(alone.null, both.null[:, trait])
        assert_allclose(alone.p_value, both.p_value[trait])


def test_a_walk_without_a_label_keeps_none():
    random = np.random.default_rng(7)
    vectors, labels = random.normal(size=(14, 5)), random.normal(size=(14, 2))
    labels[:4, 1] = np.nan
    result = permutation_test(vectors, labels, n_components=2, score="r", n_permutations=60, random_state=1)
    predicted = loo_predict(vectors, labels, n_components=2)
    assert_allclose(result.score[1], pearsonr(predicted[4:, 1], labels[4:, 1])[0])
    with pytest.raises(ValueError, match="pass vectors and n_components instead"):
        permutation_test(loo_matrix(vectors, n_components=2), labels, score="r")


def test_arguments_are_checked():
    with pytest.raises(ValueError, match=r"score='accuracy' needs two groups, as two words or -1 and \+1"):
        permutation_test(np.zeros((3, 3)), [0, 1, 1])
    with pytest.raises(ValueError, match=r"square matrix of loo_matrix, got shape \(3, 2\)"):
        permutation_test(np.zeros((3, 2)), [-1, 1, 1])
    with pytest.raises(ValueError, match="score must be one of"):
        permutation_test(np.zeros((3, 3)), [-1, 1, 1], score="f1")
    with pytest.raises(ValueError, match="n_permutations must be at least 1"):
        permutation_test(np.zeros((3, 3)), [-1, 1, 1], n_permutations=0)
