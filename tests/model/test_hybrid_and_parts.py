"""Walks of a part of an axis, of two walkers, with traits that stay; and the names of blocks of features."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline

from eigenwalker.datasets import make_walkers
from eigenwalker.model import (
    BlockScaler,
    FourierLinearizer,
    TraitClassifier,
    TraitRegressor,
    axis_features,
    axis_shares,
    block_weights,
    feature_parts,
    hybrid_walk,
    make_eigenwalkers,
    walk_along_axis,
    walk_at,
)
from eigenwalker.model.blocks import fitting_weights, in_part, take_weights
from eigenwalker.motion import JointWalk, Skeleton, WalkPreparer

TRAITS = ["gender", "weight", "happy"]
EXACT = {"rtol": 0, "atol": 1e-9}


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(28, duration=4, frame_rate=50, random_state=0)


@pytest.fixture(scope="module", params=["pattern", "filter"])
def model(request, walkers):
    trait = TraitRegressor(direction=request.param)
    return make_eigenwalkers(n_components=6, trait=trait).fit(walkers.data, walkers.target[TRAITS])


@pytest.fixture(params=[None, 4], ids=["average", "walker"])
def base(request, walkers):
    return None if request.param is None else walkers.data[request.param]


def vectors_of(model, walks):
    return np.asarray(model[0].transform(walks))


def start_of(model, base):
    """Return the vector of the base, or of the average walker."""
    return model[0].transform([base])[0] if base else model[1:-1].inverse_transform(model[-1].mean_[np.newaxis])[0]


@pytest.mark.parametrize("hold", [(), ("gender",)])
def test_parts_move_their_features_only_and_add_up(model, base, hold):
    start, options = start_of(model, base), {"base": base, "hold": hold}
    whole, structure, dynamics = (
        vectors_of(model, walk_along_axis(model, "weight", [-1.5, 1.0], part=part, **options)) - start
        for part in (None, "structure", "dynamics")
    )
    is_structure = feature_parts(model[0].get_feature_names_out()) == "structure"
    assert is_structure.sum() == 45
    assert_allclose(structure[:, ~is_structure], 0, **EXACT)
    assert_allclose(dynamics[:, is_structure], 0, **EXACT)
    assert_allclose(structure[:, is_structure], whole[:, is_structure], **EXACT)
    assert_allclose(structure + dynamics, whole, **EXACT)
    assert np.abs(structure[:, is_structure]).max() > 1e-3
    assert np.abs(dynamics[:, ~is_structure]).max() > 1e-3


def test_parts_of_an_axis_along_its_filter_have_its_shares_of_alpha(walkers):
    """Along the filter displacement and squared length are the same."""
    trait = TraitRegressor(direction="filter")
    model = make_eigenwalkers(n_components=6, trait=trait).fit(walkers.data, walkers.target[TRAITS])
    shares = axis_shares(model).loc["happy"]
    for part in ("structure", "dynamics"):
        (walk,) = walk_along_axis(model, "happy", [2.0], part=part)
        assert_allclose(model.transform([walk])[0, 2], 2 * shares[part], **EXACT)


def test_the_change_is_that_of_the_axis(model):
    found = vectors_of(model, walk_along_axis(model, "happy", [2.0, -1.0])) - start_of(model, None)
    assert_allclose(found, np.outer([2, -1], axis_features(model).loc["happy"]), **EXACT)


def test_parts_of_several_traits_at_once(model, base):
    alphas = {"gender": 0.5, "happy": -1.0}
    whole, structure, dynamics = (
        vectors_of(model, [walk_at(model, alphas, base, part=part)])[0] - start_of(model, base)
        for part in (None, "structure", "dynamics")
    )
    assert_allclose(structure + dynamics, whole, **EXACT)


def test_size_is_structure_and_speed_dynamics(walkers):
    walks = [replace(walk, size=1 + number / 100) for number, walk in enumerate(walkers.data)]
    model = make_eigenwalkers(n_components=6, extras=("size", "speed")).fit(walks, walkers.target["weight"])
    average = start_of(model, None)
    (structure,) = walk_along_axis(model, "weight", [2.0], part="structure")
    (dynamics,) = walk_along_axis(model, "weight", [2.0], part="dynamics")
    (whole,) = walk_along_axis(model, "weight", [2.0])
    assert_allclose((structure.speed, dynamics.size), (average[-1], average[-2]), **EXACT)
    assert_allclose((structure.size, dynamics.speed), (whole.size, whole.speed), **EXACT)
    assert abs(whole.speed - average[-1]) > 1e-3


@pytest.mark.parametrize("names", ["default", "pandas"])
def test_parts_of_models_of_tables(walkers, names):
    """Distances to the training walkers are found with or without the names of features."""
    model = make_eigenwalkers(n_components=6, weights={"head": 0.5}).set_output(transform=names)
    model[0].set_output(transform="pandas")
    model.fit(walkers.data, walkers.target["weight"])
    (walk,) = walk_along_axis(model, "weight", [1.0], base=walkers.data[0], part="dynamics")
    assert_allclose(vectors_of(model, [walk])[0, :45], vectors_of(model, walkers.data[:1])[0, :45], **EXACT)


@pytest.mark.parametrize("hold", [("gender",), ("happy",), ("gender", "happy"), ("gender", "happy", "gender")])
def test_held_traits_stay(model, base, hold):
    walks = walk_along_axis(model, "weight", [-2.0, 0.3, 1.5], base=base, hold=hold)
    start = np.zeros(3) if base is None else model.transform([base])[0]
    found = model.transform(walks)
    assert_allclose(found[:, 1], [-2.0, 0.3, 1.5], **EXACT)
    for trait in hold:
        assert_allclose(found[:, TRAITS.index(trait)], start[TRAITS.index(trait)], **EXACT)
    free = [TRAITS.index(trait) for trait in TRAITS if trait != "weight" and trait not in hold]
    for trait in free:
        assert np.abs(found[:, trait] - start[trait]).max() > 0.01


def test_held_traits_stay_beside_several(model, base):
    found = model.transform([walk_at(model, {"gender": 1.0, "weight": -1.0}, base, hold=("happy",))])[0]
    start = 0.0 if base is None else model.transform([base])[0, 2]
    assert_allclose(found, [1.0, -1.0, start], **EXACT)


def test_no_alphas_make_no_walks(model, base):
    assert walk_along_axis(model, "weight", [], base=base) == []


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: walk_along_axis(m, "weight", [1.0], part="posture"), "part must be one of 'structure', 'dynamics'"),
        (lambda m: walk_at(m, {"weight": 1.0}, part="size"), "part must be one of 'structure', 'dynamics', got 'size'"),
        (lambda m: walk_along_axis(m, "weight", [1.0, np.nan, np.inf]), "alphas must be finite, got nan, inf"),
        (lambda m: walk_along_axis(m, "weight", [1.0], hold="gender"), r"sequence of traits, \('gender',\), got 'gen"),
        (lambda m: walk_along_axis(m, "weight", [1.0], hold=("age",)), "trait must be one of .*, got 'age'"),
        (lambda m: walk_at(m, {"weight": 1.0}, hold=("weight",)), "either set or held, got both for weight"),
        (lambda m: walk_at(m, {}), "alphas must have one trait or more"),
    ],
)
def test_wrong_requests_are_refused(model, call, message):
    with pytest.raises(ValueError, match=message):
        call(model)


def assert_hybrid(linearizer, walk, structure, dynamics):
    """Raise unless the walk has the mean of one and all else of the other."""
    found, one, other = np.asarray(linearizer.transform([walk, structure, dynamics]))
    is_structure = feature_parts(linearizer.get_feature_names_out()) == "structure"
    assert_allclose(found, np.where(is_structure, one, other), **EXACT)
    assert np.abs(one - other)[is_structure].max() > 1e-3
    assert np.abs(one - other)[~is_structure].max() > 1e-3


@pytest.mark.parametrize("extras", [(), ("size",), ("speed",), ("speed", "size")])
@pytest.mark.parametrize("table", [False, True])
def test_a_hybrid_has_the_structure_of_one_and_the_dynamics_of_the_other(walkers, extras, table):
    one, other = (replace(walk, size=size) for walk, size in zip(walkers.data, (1.2, 0.9), strict=False))
    linearizer = FourierLinearizer(extras=extras).fit([one, other])
    linearizer.set_output(transform="pandas" if table else "default")
    walk = hybrid_walk(linearizer, structure=one, dynamics=other)
    assert_hybrid(linearizer, walk, one, other)
    assert_allclose((walk.size, walk.speed), (one.size, other.speed), **EXACT)
    assert walk.name == "structure of walker_000, dynamics of walker_001"


def test_a_hybrid_of_a_walker_and_itself_is_that_walker(walkers):
    own = walkers.data[0]
    linearizer = FourierLinearizer().fit([own])
    walk = hybrid_walk(linearizer, structure=own, dynamics=own)
    assert_allclose(walk.positions, linearizer.inverse_transform(linearizer.transform([own]))[0].positions, **EXACT)
    assert (walk.size, walk.speed) == (own.size, own.speed)


@pytest.mark.parametrize("trait", [TraitRegressor(), TraitClassifier()])
def test_models_make_the_hybrids_of_their_linearizer(walkers, trait):
    model = make_eigenwalkers(n_components=5, trait=trait).fit(walkers.data, walkers.target["gender"])
    one, other = walkers.data[3], walkers.data[8]
    walk = hybrid_walk(model, structure=one, dynamics=other)
    assert_hybrid(model[0], walk, one, other)
    same = hybrid_walk(model[0], structure=one, dynamics=other)
    assert_allclose(walk.positions, same.positions, **EXACT)


def test_recordings_are_prepared_first():
    one, other, *more = make_walkers(8, duration=7, frame_rate=50, treadmill=False, random_state=1).data
    steps = [
        ("preparer", WalkPreparer(normalize_size=True)),
        ("linearizer", FourierLinearizer(extras=("speed",))),
        ("scaler", BlockScaler(2)),
        ("eigenwalkers", PCA(3)),
        ("trait", TraitRegressor()),
    ]
    model = Pipeline(steps).fit([one, other, *more], np.arange(8.0))
    walk = hybrid_walk(model, structure=one, dynamics=other)
    structure, dynamics = model[0].transform([one, other])
    assert_hybrid(model[1], walk, structure, dynamics)
    assert_allclose((walk.size, walk.speed), (structure.size, dynamics.speed), **EXACT)
    assert structure.size != dynamics.size


def test_joint_walks_have_hybrids():
    random = np.random.default_rng(0)
    skeleton = Skeleton(("hips", "left", "right"), [-1, 0, 0], np.zeros((3, 3)))
    walks = []
    for frequency, size in ((0.9, 1.0), (1.1, 1.3)):
        phase = 2 * np.pi * frequency * np.arange(300) / 50
        turns = random.normal(scale=0.1, size=(4, 3, 3))
        waves = np.stack((np.ones_like(phase), np.cos(phase), np.sin(phase), np.cos(2 * phase)))
        rotations = np.einsum("ht,hjc->tjc", waves, turns)
        rotations[:, 1, 0] += 0.5 * np.cos(phase)
        rotations[:, 2, 0] -= 0.5 * np.cos(phase)
        root = np.tile([0.0, 0.0, 0.9 * size], (300, 1))
        walks.append(JointWalk(rotations, root, skeleton, 50.0, f"at {frequency}", speed=frequency, size=size))
    one, other = walks
    linearizer = FourierLinearizer(phase_reference={"left_x": 1.0, "right_x": -1.0}).fit(walks)
    walk = hybrid_walk(linearizer, structure=one, dynamics=other)
    assert isinstance(walk, JointWalk)
    assert_hybrid(linearizer, walk, one, other)
    assert (walk.size, walk.speed) == (1.0, 1.1)


def test_features_are_structure_or_dynamics(walkers):
    names = FourierLinearizer(3, extras=("speed", "size")).fit(walkers.data[:1]).get_feature_names_out()
    parts = feature_parts(names)
    assert set(parts[:45]) == {"structure"}
    assert set(parts[45 : 7 * 45 + 2]) == {"dynamics"}
    assert parts[-1] == "structure"
    assert feature_parts(iter(["mean_LeftUpLeg_y", "size", "speed"])).tolist() == ["structure", "structure", "dynamics"]
    assert feature_parts([]).dtype.kind == "U"
    assert in_part(names, None).all()
    assert in_part(names, "dynamics").sum() == 6 * 45 + 2
    with pytest.raises(ValueError, match="part must be one of 'structure', 'dynamics', got 'mean'"):
        in_part(names, "mean")


BLOCKS = ("mean", "sin1", "cos1", "sin2", "cos2")
CHANNELS = ("head_x", "head_y", "left_hip_x", "left_hip_y")
NAMES = [*(f"{block}_{channel}" for block in BLOCKS for channel in CHANNELS), "frequency", "speed", "size"]


def doubled(key):
    """Return the features that a key doubles."""
    weights = block_weights(NAMES, {key: 2})
    assert set(weights) <= {1.0, 2.0}
    return [name for name, weight in zip(NAMES, weights, strict=True) if weight == 2]


def having(*words):
    return [name for name in NAMES if any(word in name for word in words)]


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        ("mean", having("mean")),
        ("sin1", having("sin1")),
        ("harmonic1", having("sin1", "cos1")),
        ("harmonic2", having("sin2", "cos2")),
        ("structure", having("mean", "size")),
        ("dynamics", having("sin", "cos", "frequency", "speed")),
        ("head", having("head")),
        ("left_hip", having("left_hip")),
        ("left_hip_x", having("left_hip_x")),
        ("cos2_left_hip_y", ["cos2_left_hip_y"]),
        ("frequency", ["frequency"]),
        ("speed", ["speed"]),
        ("size", ["size"]),
    ],
)
def test_keys_mean_their_features(key, expected):
    assert doubled(key) == expected
    assert expected


def test_keys_of_one_feature_are_multiplied():
    weights = {"dynamics": 2, "harmonic1": 3.0, "sin1": 5, "head": np.float32(7), "head_x": 11, "sin1_head_x": 13}
    found = dict(zip(NAMES, block_weights(NAMES, weights), strict=True))
    assert found["sin1_head_x"] == 2 * 3 * 5 * 7 * 11 * 13
    assert found["sin1_head_y"] == 2 * 3 * 5 * 7
    assert found["cos1_left_hip_x"] == 2 * 3
    assert found["mean_head_x"] == 7 * 11
    assert (found["mean_left_hip_x"], found["frequency"], found["size"]) == (1, 2, 1)


def test_names_of_every_number_of_harmonics(walkers):
    names = FourierLinearizer(11).fit(walkers.data[:1]).get_feature_names_out()
    assert (block_weights(names, {"harmonic11": 0}) == 0).sum() == 90
    assert (block_weights(names, {"harmonic1": 0}) == 0).sum() == 90
    assert block_weights(names, {}).tolist() == [1.0] * len(names)


def test_weights_that_fit_no_feature_can_be_left_out():
    assert fitting_weights(["mean_head_x", "frequency"], {"head": 2, "harmonic1": 3, "mean": 0}) == {
        "head": 2,
        "mean": 0,
    }
    assert fitting_weights(["frequency"], None) is None
    assert fitting_weights(["frequency"], [1.0, 2.0]) == [1.0, 2.0]


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ({"hat": 1}, "weights: 'hat' fits no feature; expected numbers of 0 or more for any of structure, mean, head"),
        ({"harmonic3": 1, "head": -1}, "'harmonic3' fits no feature; 'head' has the weight -1"),
        ({"head": np.nan, "mean": np.inf}, "'head' has the weight nan; 'mean' has the weight inf"),
        ({"head": "2", "mean": None}, "'head' has the weight '2'; 'mean' has the weight None"),
        ({"structure": 0, "dynamics": 0}, "weights leave no feature in"),
    ],
)
def test_wrong_weights_are_refused(weights, message):
    with pytest.raises(ValueError, match=message):
        block_weights(NAMES, weights)


def test_weights_by_name_or_by_number():
    assert take_weights(None, 3, None).tolist() == [1, 1, 1]
    assert take_weights([0, 2, 1], 3, None).tolist() == [0, 2, 1]
    assert take_weights({"head": 0}, 2, ["mean_head_x", "frequency"]).tolist() == [0, 1]
    with pytest.raises(ValueError, match="weights by name, head, need features with names"):
        take_weights({"head": 0}, 2, None)
    for wrong in ([1, 2], [1, 2, np.nan], [1, 2, -1]):
        with pytest.raises(ValueError, match="weights must be 3 numbers of 0 or more"):
            take_weights(wrong, 3, None)
    with pytest.raises(ValueError, match="leave no feature in"):
        take_weights([0, 0, 0], 3, None)
