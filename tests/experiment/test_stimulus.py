import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.stimulus import Stimulus, as_stimuli, cross_stimuli

WALKS = make_walkers(6, random_state=0).data
STYLES = [f"style{number}" for number in range(11)]


def test_the_paper_has_44_and_2():
    originals = dict.fromkeys(STYLES, WALKS[0])
    stimuli = cross_stimuli(originals, dict.fromkeys(STYLES, WALKS[1]), average=WALKS[2])
    assert len(stimuli) == 44 + 2
    assert len({stimulus.name for stimulus in stimuli}) == 46
    assert sum(stimulus.kind == "original" for stimulus in stimuli) == 22
    assert [stimulus.name for stimulus in stimuli if stimulus.style == "average walk"] == [
        "average_static",
        "average_displacement",
    ]


def test_a_synthetic_walk_refers_to_the_original_of_its_style_and_condition():
    stimuli = cross_stimuli({"sad": WALKS[:2]}, {"sad": WALKS[2:4]}, average=WALKS[4])
    known = {stimulus.name: stimulus for stimulus in as_stimuli(stimuli)}
    paired = [stimulus for stimulus in stimuli if stimulus.reference]
    assert len(paired) == 4
    for stimulus in paired:
        original = known[stimulus.reference]
        assert (original.style, original.condition) == (stimulus.style, stimulus.condition)
        assert (WALKS.index(original.walk), WALKS.index(stimulus.walk)) in {(0, 2), (1, 3)}


def test_several_synthetic_walks_share_a_single_original():
    stimuli = cross_stimuli({"sad": WALKS[0]}, {"sad": WALKS[1:4]}, conditions=["static"])
    assert [stimulus.reference for stimulus in stimuli] == ["", *["sad_original_static"] * 3]


def test_walks_are_stimuli_of_their_names():
    assert [stimulus.name for stimulus in as_stimuli(WALKS[:2])] == ["walker_000", "walker_001"]


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: cross_stimuli([WALKS[0]], {}), "originals must be a mapping of styles to walks"),
        (lambda: cross_stimuli({}, {}), "original walks of at least one style"),
        (lambda: cross_stimuli({"sad": WALKS[0]}, {"cool": WALKS[1]}), "none of: cool"),
        (lambda: cross_stimuli({"sad": WALKS[:2]}, {"sad": WALKS[:3]}), r"sad \(2 and 3\)"),
        (lambda: cross_stimuli({"sad": WALKS[0]}, {}, conditions=["moving"]), "conditions must be one of"),
        (lambda: Stimulus(""), "non-empty strings"),
        (lambda: Stimulus("a\nb"), "without line breaks and other control characters"),
        (lambda: Stimulus("a", style="b\0"), "style must be without line breaks"),
        (lambda: Stimulus("a", kind="real"), "kind must be one of"),
        (lambda: Stimulus("a", WALKS[0], movie="a.mp4"), "a walk or a movie, got both"),
        (lambda: Stimulus("a", movie="a.avi"), "ends in .mp4, got a.avi"),
        (lambda: Stimulus("a", "walk"), "expected a Walk or JointWalk, got str"),
        (lambda: as_stimuli([WALKS[0], WALKS[0]]), "these repeat: walker_000"),
        (lambda: as_stimuli([Stimulus("a", reference="b")]), "expected references among the stimuli, these are not: b"),
        (lambda: as_stimuli([]), "at least one walk"),
    ],
)
def test_what_is_wrong_is_said(make, match):
    with pytest.raises((ValueError, TypeError), match=match):
        make()
