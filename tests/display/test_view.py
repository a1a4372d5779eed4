"""What a page of walkers is told, and what Python says of it."""

import base64
import re
import subprocess
import sys
import warnings
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from sklearn.base import clone
from sklearn.decomposition import PCA
from sklearn.exceptions import NotFittedError
from sklearn.pipeline import Pipeline

from eigenwalker import FourierLinearizer, JointWalk, TraitClassifier, make_eigenwalkers
from eigenwalker.display import view
from eigenwalker.model import TraitRegressor
from eigenwalker.motion import Skeleton
from tests.viewer_pages import POLES, four_axes


@pytest.fixture(scope="module")
def model():
    return four_axes()[0]


@pytest.fixture(scope="module")
def walks():
    return four_axes()[1]


def _array(contents, name, columns):
    return np.frombuffer(base64.b64decode(contents[name]), "<f8").reshape(-1, contents[columns])


def test_a_page_with_80_walkers_and_four_axes_is_small(model, walks, tmp_path):
    view(model, walks).save(tmp_path / "walker.html")
    assert (tmp_path / "walker.html").stat().st_size < 120_000


def test_contents_are_the_model(model, walks):
    contents = view(model, walks)._contents
    center, basis, scores = (
        _array(contents, name, columns)
        for name, columns in (("center", "n_features"), ("basis", "n_features"), ("scores", "n_components"))
    )
    reduced = model[:-1].transform(walks)
    assert_allclose(scores, reduced - model[-1].mean_, atol=1e-12)
    assert_allclose(center + scores @ basis, model[1:-1].inverse_transform(reduced), atol=1e-12)
    assert_allclose(scores @ _array(contents, "filters", "n_components").T, model.transform(walks), atol=1e-12)
    distances = np.linalg.norm(scores @ _array(contents, "whitener", "n_components").T, axis=1)
    assert_allclose(distances, model[-1].distance(reduced), rtol=1e-9)
    assert contents["distance_limit"] == model[-1].distance_limit()
    assert [trait["name"] for trait in contents["traits"]] == list(POLES)
    assert contents["traits"][0] | {"low": 0, "high": 0} == {
        "name": "gender",
        "negative": "female",
        "positive": "male",
        "low": 0,
        "high": 0,
        "reach": 6.0,
    }


@pytest.mark.parametrize("unit", ["sd", "label", "coefficient"])
def test_sliders_go_to_six_standard_deviations_in_any_unit(model, walks, unit):
    last = clone(model[-1]).set_params(alpha_unit=unit)
    scores = model[:-1].transform(walks)
    labels = pd.DataFrame({"height": np.random.default_rng(0).normal(172, 8, len(scores))})
    other = Pipeline([*model.steps[:-1], ("trait", last.set_params(poles=None).fit(scores, labels))])
    trait = view(other)._contents["traits"][0]
    spread = other[-1].alphas_.std(ddof=1)
    assert 6 * spread <= trait["reach"] <= 6.7 * spread
    assert trait["low"] == other[-1].alphas_.min()


def test_alphas_are_kept_and_checked(model):
    shown = view(model, alphas={"happy": 2, "gender": np.float64(-1)})
    assert shown.alphas == {"happy": 2.0, "gender": -1.0}
    shown.alphas = {"weight": 3}
    assert shown.alphas == {"weight": 3.0}
    with pytest.raises(
        ValueError,
        match=r"alphas: no trait 'mood'; happy = 9 is no number from -6 to 6; gender = '1' is no .*gender \(±6\)",
    ):
        shown.alphas = {"mood": 1, "happy": 9, "gender": "1"}
    with pytest.raises(TypeError, match="alphas must be a mapping such as"):
        shown.alphas = [("happy", 1)]
    with pytest.raises(ValueError, match="at most 12 walkers, got 13"):
        view(model, alphas=[{}] * 13)
    assert shown.alphas == {"weight": 3.0}


def test_traits_that_depend_on_each_other_are_not_held_together(walks):
    labels = np.random.default_rng(0).normal(size=80)
    twins = pd.DataFrame({"one": labels, "same": 2 * labels})
    model = make_eigenwalkers(n_components=5).fit(walks, twins)
    with pytest.raises(ValueError, match="one, same cannot be set independently"):
        view(model, alphas={"one": 1, "same": -1})


def test_models_without_axes_are_refused(model, walks):
    with pytest.raises(TypeError, match=r"ends with trait axes.*got PCA at its end; fit make_eigenwalkers"):
        view(Pipeline([("linearizer", FourierLinearizer()), ("pca", PCA(2))]).fit(walks))
    with pytest.raises(NotFittedError, match="call fit"):
        view(make_eigenwalkers())
    flat = make_eigenwalkers(n_components=5).fit(walks, pd.DataFrame({"rank": np.ones(80)}))
    with pytest.raises(ValueError, match="none for rank; fit the model without"):
        view(flat)


def test_joint_walks_are_refused_with_advice():
    skeleton = Skeleton(("hips",), np.array([-1]), np.zeros((1, 3)))
    walk = JointWalk(np.zeros((240, 1, 3)), np.zeros((240, 3)), skeleton, 120)
    with pytest.raises(TypeError, match=r"have a body to draw, got JointWalk; .*to_markers\(\)"):
        view([walk])


def test_wrong_walks_are_refused(model, walks):
    with pytest.raises(TypeError, match=r"walks to load need a model, view\(model, walks\)"):
        view(walks[:2], walks[2:4])
    with pytest.raises(TypeError, match="wrap it"):
        view(model, walks[0])
    with pytest.raises(TypeError, match="expected a list of Walk"):
        view("model.skops")
    with pytest.raises(ValueError, match="empty list"):
        view([])


def test_a_classifier_has_an_axis(walks):
    sex = np.where(np.arange(80) % 2, "female", "male")
    model = make_eigenwalkers(n_components=5, trait=TraitClassifier()).fit(walks, pd.Series(sex, name="sex"))
    trait = view(model)._contents["traits"][0]
    assert (trait["name"], trait["negative"], trait["positive"]) == ("sex", "female", "male")


def test_walks_without_a_model(walks, tmp_path):
    shown = view([*walks[:2], replace(walks[2], name="")], n_harmonics=3)
    contents = shown._contents
    assert (contents["names"][2], contents["n_harmonics"], contents["traits"]) == ("walk 3", 3, [])
    vectors = FourierLinearizer(3).fit_transform(walks[:3])
    made = _array(contents, "center", "n_features") + _array(contents, "basis", "n_features")
    assert_allclose(made, vectors, atol=1e-12)
    assert shown._told()["state"]["walkers"] == [{"walker": 0}, {"walker": 1}, {"walker": 2}]
    shown.save(tmp_path / "walks.html")
    assert "<title>Walkers: 3 walks</title>" in (tmp_path / "walks.html").read_text()


def test_the_same_view_is_the_same_page(model, walks, tmp_path):
    for name in ("one.html", "two.html"):
        view(model, walks[:3], alphas={"happy": 1}, title="A & <b>").save(tmp_path / name)
    page = (tmp_path / "one.html").read_text(encoding="utf-8")
    assert page == (tmp_path / "two.html").read_text(encoding="utf-8")
    assert "<title>A &amp; &lt;b&gt;</title>" in page
    assert "<b>" not in page


def test_what_is_written_by_users_ends_no_element(model, walks, tmp_path):
    name = "</script><img src=x onerror=alert(1)>"
    shown = view(model, [replace(walks[0], name=name)], note="</script>", title="</title><script>")
    shown.save(tmp_path / "walker.html")
    page = (tmp_path / "walker.html").read_text(encoding="utf-8")
    assert re.findall(r"</?(script|title)\b", page) == ["title"] * 2 + ["script"] * 4
    assert page.count("<img") == 0
    assert re.findall(r"</?(script|title|img|iframe)\b", shown._repr_html_()) == ["iframe"] * 2


def test_a_frame_is_shown_where_there_are_no_widgets(model, monkeypatch):
    shown = view(model, alphas={"happy": 1})
    html = shown._repr_html_()
    assert html.startswith("<iframe srcdoc=")
    assert 'sandbox="allow-scripts allow-downloads"' in html
    monkeypatch.setattr("eigenwalker.display.walker_view.find_spec", lambda name: None)
    assert set(shown._repr_mimebundle_()) == {"text/html", "text/plain"}


def test_the_widget_asks_for_anywidget(model, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(ImportError, match=r'pip install "eigenwalker\[notebook\]"'):
        view(model).widget()


def test_showing_loads_no_widgets():
    code = "import sys, eigenwalker.display; assert not {'anywidget', 'ipywidgets'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_axes_in_the_filters_direction(walks):
    labels = np.random.default_rng(0).normal(size=(80, 2))
    model = make_eigenwalkers(n_components=6, trait=TraitRegressor(direction="filter")).fit(walks, labels)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        steps = _array(view(model)._contents, "steps", "n_components")
    assert_allclose(steps / np.linalg.norm(steps, axis=1, keepdims=True), _unit(model[-1].coef_), atol=1e-12)


def _unit(rows):
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)
