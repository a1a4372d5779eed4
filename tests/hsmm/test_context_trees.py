"""Decision trees of contexts, and the states that they tie."""

import json
import pickle
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm.accumulation import Statistics, accumulate_walk
from eigenwalker.hsmm.context_trees import GAIT_QUESTIONS, ContextTree, Question, Split, grow_tree
from eigenwalker.hsmm.inference import certain_posterior
from eigenwalker.hsmm.step_labels import CONTEXTS
from eigenwalker.hsmm.tying import (
    GAIT_GROUPS,
    pool_rows,
    sum_durations,
    tie_by,
    tie_durations,
    tie_states,
    untied,
)
from tests.hsmm.planted import draw_parameters, draw_walk

_RIGHT, _FIRST = GAIT_QUESTIONS[:2]
_A, _B, _C = ("a",), ("b",), ("c",)
_SINGLE = tuple(Question(f"{name}?", ((name,),)) for name in "abc")


def _sums(frames):
    """Return counts, sums and squares of contexts, from frames of shape (n_frames, n_features) of each."""
    counts = np.stack([np.isfinite(part).sum(axis=0) for part in frames]).astype(float)
    return counts, *(np.stack([np.nansum(part**power, axis=0) for part in frames]) for power in (1, 2))


def _draw_frames(random, n_frames, *, groups=GAIT_GROUPS, n_features=3, distance=1.0):
    """Return frames of the ten contexts, four times as many inside a walk; Gaussians are shared within groups."""
    means = random.normal(0, distance, (len(groups), n_features))
    deviations = random.uniform(0.7, 1.4, (len(groups), n_features))
    owners = [next(at for at, group in enumerate(groups) if context in group) for context in CONTEXTS]
    sizes = [n_frames * (4 if position == "inside" else 1) for _, position in CONTEXTS]
    return [
        random.normal(means[at], deviations[at], (size, n_features)) for at, size in zip(owners, sizes, strict=True)
    ]


def _grow(frames, contexts=CONTEXTS, questions=GAIT_QUESTIONS, **settings_of_trees):
    return grow_tree(*_sums(frames), contexts, questions, **({"floors": 1e-3} | settings_of_trees))


def _partition(tree):
    return {frozenset(leaf) for leaf in tree.leaves}


def _grow_plainly(frames, questions, *, floors, penalty, min_count):
    """Return leaves and gains from the frames themselves, and every question tried; `frames` by context."""
    whole = np.concatenate(list(frames.values()))
    threshold = penalty * whole.shape[1] * np.log(len(whole))

    def likelihood(contexts):
        data = np.concatenate([frames[context] for context in contexts])
        variances = np.maximum(data.var(axis=0), floors)
        return -0.5 * (np.log(2 * np.pi * variances) + (data - data.mean(axis=0)) ** 2 / variances).sum()

    def split(contexts):
        tried = []
        for question in questions:
            sides = [[c for c in contexts if (c in question.contexts) == answer] for answer in (True, False)]
            if all(side and sum(len(frames[c]) for c in side) >= min_count for side in sides):
                tried.append((sum(map(likelihood, sides)) - likelihood(contexts), sides))
        gain, sides = max(tried, key=lambda entry: entry[0], default=(-np.inf, None))
        if not gain > threshold:
            return [tuple(contexts)], []
        parts = [split(side) for side in sides]
        leaves, gains = ([*one, *other] for one, other in zip(*parts, strict=True))
        return leaves, [gain, *gains]

    return split(list(frames))


def test_planted_tying_is_found_the_more_often_the_more_frames():
    """The six groups of the paper. Of 40 worlds each: at 20 frames two thirds are wrong, at 320 one or so."""
    wrong = []
    for n_frames in (20, 80, 320):
        trees = [_grow(_draw_frames(np.random.default_rng(seed), n_frames)) for seed in range(40)]
        wrong.append(np.mean([_partition(tree) != set(map(frozenset, GAIT_GROUPS)) for tree in trees]))
    assert wrong[0] > 2 * wrong[1] > 4 * wrong[2], wrong
    assert wrong[2] <= 0.05, wrong


def test_contexts_that_are_alike_stay_together():
    """Of 100 worlds with one Gaussian none is split: chance gains 8 nats or so, and a split costs 53."""
    trees = [
        _grow(_draw_frames(np.random.default_rng(seed), 50, groups=[CONTEXTS], n_features=8)) for seed in range(100)
    ]
    assert {tree.n_leaves for tree in trees} == {1}


@settings(deadline=None, max_examples=40)
@given(
    seed=st.integers(0, 2**32 - 1),
    penalty=st.sampled_from([0.0, 0.2, 1.0]),
    min_count=st.sampled_from([1, 5, 12]),
    floors=st.sampled_from([1e-3, 0.5, 4.0]),
    n_features=st.integers(1, 3),
)
def test_the_same_tree_as_from_the_frames(seed, penalty, min_count, floors, n_features):
    """Every question tried on the frames themselves, with variances above and below the floors."""
    random = np.random.default_rng(seed)
    contexts = [CONTEXTS[at] for at in random.permutation(10)[: random.integers(2, 10)]]
    questions = [
        Question(str(at), tuple(contexts[i] for i in random.permutation(len(contexts))[: random.integers(1, 4)]))
        for at in range(5)
    ]
    frames = {
        context: random.normal(random.normal(0, 1, n_features), 1, (random.integers(3, 9), n_features))
        for context in contexts
    }
    setting = {"floors": floors, "penalty": penalty, "min_count": min_count}
    tree = _grow(list(frames.values()), contexts, questions, **setting)
    leaves, gains = _grow_plainly(frames, questions, **setting)
    assert _partition(tree) == {frozenset(leaf) for leaf in leaves}
    # Questions that part a leaf alike may swap yes and no, and so the order of what follows.
    assert_allclose(sorted(split.gain for split in tree.splits), sorted(gains), rtol=1e-9)
    assert sum(tree.counts) == sum(map(len, frames.values()))


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 2**32 - 1), distance=st.sampled_from([0.0, 0.3, 2.0]), floors=st.sampled_from([1e-3, 3.0]))
def test_splits_raise_the_likelihood_and_a_larger_penalty_only_prunes(seed, distance, floors):
    frames = _draw_frames(np.random.default_rng(seed), 12, distance=distance)
    trees = [_grow(frames, floors=floors, penalty=penalty, min_count=1) for penalty in (np.inf, 2.0, 1.0, 0.3, 0.0)]
    assert trees[0].n_leaves == 1
    for one, other in pairwise(trees):
        assert other.log_likelihood >= one.log_likelihood - 1e-9
        assert all(any(finer <= coarser for coarser in _partition(one)) for finer in _partition(other))
    for tree in trees[1:]:
        gains = np.array([split.gain for split in tree.splits])
        assert (gains > tree.cost).all()
        assert_allclose(tree.log_likelihood, trees[0].log_likelihood + gains.sum(), rtol=1e-10)
        assert tree.description_length <= tree.cost - trees[0].log_likelihood + 1e-9


def test_without_a_penalty_all_that_differ_part():
    frames = _draw_frames(np.random.default_rng(0), 3, distance=0.0)
    frames[5:] = frames[:5]  # left steps are as right ones
    tree = _grow(frames, penalty=0.0, min_count=0)
    sides = [[(side, position) for side in ("right", "left")] for _, position in CONTEXTS[:5]]
    assert _partition(tree) == {frozenset(pair) for pair in sides}


def test_rounding_parts_nothing():
    """The same frames over and over, however often in each context."""
    frames = np.random.default_rng(11).normal(0.3, 1, (5, 40))
    repeated = [np.tile(frames, (times, 1)) for times in (1, 2, 3, 5, 7, 11, 13, 17, 19, 23)]
    assert _grow(repeated, penalty=0.0, min_count=0).n_leaves == 1


@pytest.mark.parametrize("min_count", [3, 4, 7, 100])
def test_both_sides_have_the_fewest_frames(min_count):
    """Three frames in each context but twelve inside; the next split of any leaf would leave too few."""
    frames = _draw_frames(np.random.default_rng(1), 3)
    tree = _grow(frames, penalty=0.0, min_count=min_count)
    assert all(count >= min_count for count in tree.counts) or tree.n_leaves == 1
    sizes = dict(zip(CONTEXTS, map(len, frames), strict=True))
    for leaf in tree.leaves:
        for question in GAIT_QUESTIONS:
            yes = sum(sizes[context] for context in leaf if context in question.contexts)
            assert min(yes, sum(sizes[context] for context in leaf) - yes) < min_count


def test_by_hand():
    """Variances 1 and 1 apart, 26 together: (4 log 26) / 2 is gained. A Gaussian more costs log 4: 4.7004 of it."""
    frames = [np.array([[0.0], [2.0]]), np.array([[10.0], [12.0]])]
    tree = _grow(frames, [_A, _B], _SINGLE[:1], penalty=4.700, min_count=2)
    assert tree.splits == (Split(_SINGLE[0], -1, -2, pytest.approx(2 * np.log(26))),)
    assert tree.leaves == ((_A,), (_B,))
    assert tree.counts == (2.0, 2.0)
    assert tree.cost == pytest.approx(4.7 * np.log(4))
    assert tree.log_likelihood == pytest.approx(-2 * (np.log(2 * np.pi) + 1))
    assert tree.description_length == pytest.approx(2 * tree.cost - tree.log_likelihood)
    assert _grow(frames, [_A, _B], _SINGLE[:1], penalty=4.701, min_count=2).n_leaves == 1
    assert _grow(frames, [_A, _B], _SINGLE[:1], min_count=3).n_leaves == 1
    # Floors of 4: 2 log(26 / 4) is gained by the logs, and (4 - 2 / 4 - 2 / 4) / 2 lost by the squares.
    floored = _grow(frames, [_A, _B], _SINGLE[:1], floors=4.0, min_count=2)
    assert floored.splits[0].gain == pytest.approx(2 * np.log(6.5) + 0.5 * (4 - 1))


def test_order_of_contexts_does_not_matter():
    random = np.random.default_rng(2)
    frames = _draw_frames(random, 40)
    tree = _grow(frames, penalty=0.1)
    for _ in range(5):
        order = random.permutation(10)
        other = _grow([frames[at] for at in order], [CONTEXTS[at] for at in order], penalty=0.1)
        assert [set(leaf) for leaf in other.leaves] == [set(leaf) for leaf in tree.leaves]
        assert [split[:3] for split in other.splits] == [split[:3] for split in tree.splits]
        assert_allclose([split.gain for split in other.splits], [split.gain for split in tree.splits], rtol=1e-10)


@pytest.mark.parametrize("floors", [1e-3, 1.0])
def test_units_and_origin_do_not_matter(floors):
    frames, units = _draw_frames(np.random.default_rng(3), 40), np.array([1e-3, 1.0, 50.0])
    tree = _grow(frames, floors=floors, penalty=0.3)
    other = _grow([part * units + 3 * units for part in frames], floors=floors * units**2, penalty=0.3)
    assert other.leaves == tree.leaves
    assert [split[:3] for split in other.splits] == [split[:3] for split in tree.splits]
    assert_allclose([split.gain for split in other.splits], [split.gain for split in tree.splits], rtol=1e-8)
    n_frames = sum(map(len, frames))
    assert_allclose(other.log_likelihood, tree.log_likelihood - n_frames * np.log(units).sum(), rtol=1e-9)


def test_features_count_by_their_own_frames():
    """The second feature lacks the edges of walks: its Gaussians are of what was seen, the cost is of all frames."""
    frames = [np.random.default_rng(at).normal(3 * at, 1, (30, 2)) for at in range(2)]
    parts = [_grow([part[:, :1] for part in frames], [_A, _B], _SINGLE[:1])]
    for part in frames:
        part[:4, 1] = np.nan
    parts.append(_grow([part[4:, 1:] for part in frames], [_A, _B], _SINGLE[:1]))
    both = _grow(frames, [_A, _B], _SINGLE[:1])
    assert both.counts == (30.0, 30.0)
    assert both.cost == pytest.approx(2 * np.log(60))
    assert both.splits[0].gain == pytest.approx(sum(part.splits[0].gain for part in parts))
    never = [np.column_stack((part, np.full(30, np.nan))) for part in frames]
    assert _grow(never, [_A, _B], _SINGLE[:1]) == both  # a feature never seen has no parameters


def test_the_first_of_equally_good_questions_is_asked():
    """The second one parts alike with yes and no swapped, the third but for a context that was never seen."""
    frames = [np.zeros((20, 1)), np.full((20, 1), 5.0), np.zeros((0, 1))]
    questions = (Question("a?", (_A,)), Question("not a?", (_B, _C)), Question("a or c?", (_A, _C)))
    for asked in (questions, questions[::-1], questions[1:]):
        tree = _grow(frames, [_A, _B, _C], asked)
        assert [split.question for split in tree.splits] == [asked[0]]
        assert tree.leaf_of(_C) == (0 if _C in asked[0].contexts else 1)


@pytest.mark.parametrize("seed", range(10))
def test_rounding_does_not_choose_a_question(seed):
    """The first and the fourth context are the same, so that both questions gain the same but for rounding."""
    contexts = [(word,) for word in "abcde"]
    frames = [np.random.default_rng((seed, at % 3)).normal(2 * (at % 3), 1, (30, 4)) for at in range(5)]
    questions = [Question(words, tuple((word,) for word in words)) for words in ("abc", "bcd")]
    for asked in (questions, questions[::-1]):
        assert _grow(frames, contexts, asked).splits[0].question == asked[0]


def test_contexts_never_seen_follow_the_questions():
    """Left first steps are like no others, and else sides differ: what was never seen is with those, or its side."""
    unseen = [("right", "first"), ("left", "second"), ("right", "last but one")]
    random = np.random.default_rng(4)
    frames = [
        random.normal(50 if context == ("left", "first") else 5 * (context[0] == "left"), 1, (30, 2))
        for context in CONTEXTS
        if context not in unseen
    ]
    seen = [context for context in CONTEXTS if context not in unseen]
    everything = [frames[seen.index(context)] if context in seen else np.zeros((0, 2)) for context in CONTEXTS]
    for tree in (_grow(everything), _grow(frames, seen)):  # unseen ones given, or only named by questions
        assert [split.question for split in tree.splits] == [_FIRST, _RIGHT]
        assert _partition(tree) == {
            frozenset(context for context in CONTEXTS if context[1] == "first"),
            *(frozenset((side, position) for _, position in CONTEXTS[1:5]) for side in ("right", "left")),
        }
        for number, leaf in enumerate(tree.leaves):
            assert [tree.leaf_of(context) for context in leaf] == [number] * len(leaf)
        assert tree.counts == (30.0, 90.0, 90.0)


def test_a_context_that_nobody_knows_is_refused():
    tree = _grow(_draw_frames(np.random.default_rng(5), 20))
    with pytest.raises(ValueError, match=r"one of the contexts \('.*got \('Right', 'first'\); grow the tree with it"):
        tree.leaf_of(("Right", "first"))


def test_how_it_reads():
    frames = [np.zeros((20, 1)), np.full((20, 1), 5.0), np.full((20, 1), 9.0)]
    # 30 (log(813.3 / 60) + 1) - 20 (log 4 + 1), and the latter, as three leaves do not vary and 1 is the floor.
    tree = _grow(frames, [_A, _B, _C], _SINGLE, floors=1.0)
    assert str(tree).splitlines() == [
        "a? (gain 60.5, cost 4.1)",
        "|--- yes: leaf 0 (n = 20): a",
        "|--- no: b? (gain 47.7, cost 4.1)",
        "|   |--- yes: leaf 1 (n = 20): b",
        "|   |--- no: leaf 2 (n = 20): c",
    ]
    assert str(_grow(frames, [_A, _B, _C], [])) == "leaf 0 (n = 60): a, b, c"


def test_trees_are_plain_data():
    tree = _grow(_draw_frames(np.random.default_rng(6), 100))
    assert tree.n_leaves > 2
    assert pickle.loads(pickle.dumps(tree)) == tree
    assert ContextTree(**tree._asdict()) == tree
    assert json.loads(json.dumps(tree)) == json.loads(json.dumps(list(tree)))
    skops = pytest.importorskip("skops.io")
    data = skops.dumps(tree)
    names = {f"eigenwalker.hsmm.context_trees.{name}" for name in ("ContextTree", "Question", "Split")}
    assert set(skops.get_untrusted_types(data=data)) == names
    assert skops.loads(data, trusted=sorted(names)) == tree


def test_gait_questions_part_every_two_contexts():
    for one, other in combinations(CONTEXTS, 2):
        assert any((one in question.contexts) != (other in question.contexts) for question in GAIT_QUESTIONS)
    sides = {
        frozenset([frozenset(question.contexts), frozenset(CONTEXTS) - set(question.contexts)])
        for question in GAIT_QUESTIONS
    }
    assert len(sides) == len(GAIT_QUESTIONS)  # none asks what another does


def test_faults_of_contexts_and_questions_are_told_at_once():
    sums = np.ones((3, 3, 1))
    with pytest.raises(ValueError, match=r"(?s)must differ, got \('a',\) more than once.*'d\?': expected.*leave"):
        grow_tree(*sums, [_A, _A, _B], [*_SINGLE[:2], Question("d?", (("d",),))], floors=1.0)
    with pytest.raises(ValueError, match="at least one context, got none"):
        grow_tree(*np.zeros((3, 0, 1)), [], [], floors=1.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"counts": np.ones((2, 1))}, r"with 3 contexts, got \(2, 1\), \(3, 1\) and \(3, 1\)"),
        ({"sums": np.ones((3, 2))}, r"got \(3, 1\), \(3, 2\) and \(3, 1\)"),
        ({"counts": np.ones(3), "sums": np.ones(3), "squares": np.ones(3)}, r"got \(3,\), \(3,\) and \(3,\)"),
        ({"squares": np.full((3, 1), np.nan)}, "must be finite, got NaN or infinity"),
        ({"counts": np.array([[1.0], [-1.0], [1.0]])}, r"zero or more, got less in context \('b',\)$"),
        ({"squares": np.array([[1.0], [1.0], [0.5]])}, r"at least sums\*\*2 / counts, got less in context \('c',\)"),
        ({"counts": np.array([[1.0], [1.0], [0.0]])}, r"at least sums\*\*2 / counts, got less in context \('c',\)"),
        ({name: np.zeros((3, 1)) for name in ("counts", "sums", "squares")}, "frames in at least one context"),
        ({"floors": 0.0}, "floors must be one positive number, or one of each of 1 features, got 0.0"),
        ({"floors": [1.0, 1.0]}, "one of each of 1 features"),
        ({"penalty": -1.0}, "penalty must be zero or more, got -1.0"),
        ({"penalty": np.nan, "min_count": -2}, "(?s)penalty must be zero or more, got nan.*min_count .* got -2"),
    ],
)
def test_faults_of_numbers_are_named(changes, message):
    arguments = dict.fromkeys(("counts", "sums", "squares"), np.ones((3, 1)))
    arguments |= {"contexts": [_A, _B, _C], "questions": _SINGLE, "floors": 1.0}
    with pytest.raises(ValueError, match=message):
        grow_tree(**(arguments | changes))


def _statistics(frames_of_states):
    """Return the sums of untied states, from frames of each context of each state."""
    parts = [np.stack(part, axis=1) for part in zip(*map(_sums, frames_of_states), strict=True)]
    rows = [part.reshape(-1, part.shape[-1]) for part in parts]  # (n_contexts, n_states, n_features) before
    return Statistics(0.0, 0, *rows, np.zeros((len(rows[0]), 1)))


def test_each_state_has_its_own_tree():
    """The first state tells all six groups apart, the second only sides, the third nothing."""
    random = np.random.default_rng(7)
    plans = (GAIT_GROUPS, (CONTEXTS[:5], CONTEXTS[5:]), (CONTEXTS,))
    frames = [_draw_frames(random, 200, groups=groups) for groups in plans]
    tying = tie_states(_statistics(frames), CONTEXTS, floors=1e-3)
    assert [tree.n_leaves for tree in tying.trees] == [6, 2, 1]
    assert tying.trees == tuple(_grow(part) for part in frames)
    assert tying.n_tied == 9
    assert_array_equal(np.unique(tying.states), np.arange(9))
    for state, groups in enumerate(plans):
        for group in groups:
            numbers = {int(tying.states[CONTEXTS.index(context), state]) for context in group}
            assert len(numbers) == 1
    assert set(tying.states[:, 1]) == {6, 7}
    assert set(tying.states[:, 2]) == {8}


def test_durations_of_a_step_are_one_gaussian():
    """Right steps linger in the second of two states; neither state alone has enough steps to show it."""
    random = np.random.default_rng(8)
    counts = np.zeros((20, 12))
    for at, (side, _) in enumerate(CONTEXTS):
        for state in range(2):
            lengths = random.integers(4, 7, 15) + (3 if side == "right" and state else 0)
            np.add.at(counts[2 * at + state], lengths - 1, 1)
    tying = tie_durations(Statistics(0.0, 0, *np.zeros((3, 20, 1)), counts), CONTEXTS)
    assert _partition(tying.trees[0]) == {frozenset(CONTEXTS[:5]), frozenset(CONTEXTS[5:])}
    assert_array_equal(tying.states, np.repeat([[0, 1], [2, 3]], 5, axis=0))


def test_sums_of_durations_are_those_of_each():
    lengths = np.random.default_rng(9).integers(1, 8, (6, 20))  # of 3 contexts, 2 states
    counts = np.stack([np.bincount(row - 1, minlength=9) for row in lengths]).astype(float)
    for power, sums in enumerate(sum_durations(counts, 2)):
        assert_array_equal(sums, (lengths**power).sum(axis=1).reshape(3, 2))


@pytest.mark.parametrize("tying", [untied(CONTEXTS, 2), tie_by(CONTEXTS, GAIT_GROUPS, 2)], ids=["untied", "paper"])
def test_pooled_rows_are_the_sums_of_the_tied_model(tying):
    random = np.random.default_rng(10)
    parameters = draw_parameters(random, n_states=20, n_features=3)
    steps = [CONTEXTS.index(step) for step in [("right", "first"), ("left", "inside"), ("right", "last but one")]]
    before = untied(CONTEXTS, 2)
    walk, edges = draw_walk(random, parameters, before.states[steps].ravel())
    posterior = certain_posterior(edges)
    free = accumulate_walk(walk, posterior, n_states=20, n_duration_states=20)
    chain = tying.states[steps].ravel()
    tied = accumulate_walk(
        walk._replace(states=chain, duration_states=chain),
        posterior,
        n_states=tying.n_tied,
        n_duration_states=tying.n_tied,
    )
    for name in ("counts", "sums", "squares", "duration_counts"):
        assert_allclose(pool_rows(getattr(free, name), tying.states, tying.n_tied), getattr(tied, name), atol=1e-12)


def test_ten_contexts_become_six_as_in_the_paper():
    tying = tie_by(CONTEXTS, GAIT_GROUPS, 5)
    assert tying.states.shape == (10, 5)
    assert tying.n_tied == 30
    assert untied(CONTEXTS, 5).n_tied == 50
    rows = {context: tuple(row) for context, row in zip(CONTEXTS, tying.states.tolist(), strict=True)}
    for side in ("right", "left"):
        assert rows[side, "second"] == rows[side, "inside"] == rows[side, "last but one"]
    assert len(set(rows.values())) == 6


def test_faults_of_tying_are_named():
    with pytest.raises(ValueError, match=r"(?s)must differ, got \('a',\).*n_states must be at least 1, got 0"):
        untied([_A, _A], 0)
    with pytest.raises(ValueError, match="at least one context"):
        untied([], 5)
    message = (
        r"(?s)context \('a',\) in one group, got it in 2.*\('c',\) in one group, got it in 0.*\[\('d',\)\], got none"
    )
    with pytest.raises(ValueError, match=message):
        tie_by([_A, _B, _C], [[_A, _B], [_A], [("d",)]], 1)
    rows = np.zeros((3, 7, 2))
    with pytest.raises(ValueError, match="same number of rows for each of 3 contexts, got 7 rows"):
        tie_states(Statistics(0.0, 0, *rows, np.zeros((7, 3))), [_A, _B, _C], _SINGLE, floors=1.0)
    with pytest.raises(ValueError, match="same number of rows for each of 3 contexts, got 7 rows"):
        tie_durations(Statistics(0.0, 0, *rows, np.zeros((7, 3))), [_A, _B, _C], _SINGLE)
    rows = np.ones((3, 6, 2))
    rows[:, 1::2] = 0
    with pytest.raises(ValueError, match=r"every state in at least one context, got none of state \[1\]"):
        tie_states(Statistics(0.0, 0, *rows, np.zeros((6, 3))), [_A, _B, _C], _SINGLE, floors=1.0)
    with pytest.raises(ValueError, match="one id a row, got 2 ids for 3 rows"):
        pool_rows(np.ones((3, 1)), [0, 1], 2)
    with pytest.raises(ValueError, match=r"ids from 0 to 1, got \[-1, 2\]"):
        pool_rows(np.ones((3, 1)), [0, 2, -1], 2)
