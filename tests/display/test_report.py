"""The report: all numbers, all words, one page that needs nothing else."""

import base64
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot
from numpy.testing import assert_array_equal

import eigenwalker
from eigenwalker.datasets import make_walkers
from eigenwalker.display import AxisReport, axis_report
from eigenwalker.model import LeakageWarning, TraitRegressor, axis_statistics, make_eigenwalkers
from eigenwalker.motion import JointWalk, Skeleton

FAST = {"n_harmonics": [1, 2], "n_permutations": 99, "n_resamples": 10, "random_state": 0}
STRANGE = "a<b&c"
VOID = {"img", "meta", "br"}


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(24, duration=4, frame_rate=50, random_state=0)


@pytest.fixture(scope="module")
def report(walkers):
    """Return the report on two traits, one with a name that is no HTML, that go along with their source."""
    y = walkers.target[["gender"]].assign(**{STRANGE: walkers.target["weight"]})
    model = make_eigenwalkers(n_components=5, trait=TraitRegressor(poles={STRANGE: ("<light>", "heavy")}))
    options = {"control": walkers.target["happy"], "sources": walkers.target["gender"]}
    return axis_report(model, walkers.data, y, **options, **FAST)


@pytest.fixture(scope="module")
def html(report):
    return report._repr_html_()


@pytest.fixture(scope="module")
def single(walkers):
    """Return the report on one trait, whose alpha has another unit."""
    model = make_eigenwalkers(n_components=5, trait=TraitRegressor(alpha_unit="coefficient"))
    return axis_report(model, walkers.data, walkers.target["weight"], **FAST | {"n_harmonics": []})


class Page(HTMLParser):
    """A page whose elements are closed in the order in which they were opened."""

    def __init__(self, text):
        super().__init__()
        self.open, self.attributes, self.texts, self.tags = [], [], [], []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] != ["style"]:
            self.texts.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.texts).split())

    def pictures(self):
        """Return the drawings, and what is said of them."""
        start = "data:image/svg+xml;base64,"
        sources = [value for name, value in self.attributes if name == "src"]
        assert all(source.startswith(start) for source in sources)
        drawings = [base64.b64decode(source.removeprefix(start)).decode() for source in sources]
        return dict(zip([value for name, value in self.attributes if name == "alt"], drawings, strict=True))


def test_the_table_has_all_numbers(report):
    table, found = report.to_frame(), report.statistics
    shares = ["structure_share", "structure_alone", "dynamics_share", "dynamics_alone"]
    assert list(table) == [*found.summary, *shares]
    assert table.index.tolist() == ["gender", STRANGE]
    pd.testing.assert_frame_equal(table[list(found.summary)], found.summary)
    for name in shares:
        part, what = name.split("_")
        assert_array_equal(table[name], [found.parts.loc[(trait, part), what] for trait in table.index])
    assert np.allclose(table["structure_share"] + table["dynamics_share"], 1)


def test_the_table_of_a_report_is_a_copy(report):
    table = report.to_frame()
    table["p"] = 0.0
    assert (report.to_frame()["p"] > 0).all()


def test_axis_report_is_the_report_on_axis_statistics(walkers, single):
    model = make_eigenwalkers(n_components=5, trait=TraitRegressor(alpha_unit="coefficient"))
    found = axis_statistics(model, walkers.data, walkers.target["weight"], **FAST | {"n_harmonics": []})
    pd.testing.assert_frame_equal(AxisReport(found).to_frame(), single.to_frame())
    assert (single.faults, single.notes) == (found.faults, found.notes)
    assert str(AxisReport(found)) == str(single)


def _with(report, trait, alpha_unit="sd", n_permutations=9999, **row):
    """Return the report with other numbers of one trait."""
    found = report.statistics
    summary = found.summary.astype(object).copy()
    for name, value in row.items():
        summary.loc[trait, name] = value
    settings = found.settings | {"alpha_unit": alpha_unit, "n_permutations": n_permutations}
    return AxisReport(replace(found, summary=summary, settings=settings))


NUMBERS = {
    "unit": 0.8113,
    "n_persons": 24,
    "left_out": 0.904,
    "left_out_low": 0.7,
    "left_out_high": 0.996,
    "nested": -0.256,
    "nested_low": -0.5,
    "nested_high": 0.1,
    "p": 0.0123,
}


def test_an_axis_in_words(report):
    lines = str(_with(report, "gender", **NUMBERS)).splitlines()
    assert lines[0] == f"Trait axes: gender, {STRANGE}"
    assert lines[1] == (
        "24 walks of 24 persons; 2 harmonics, 5 components, scaling blocks, controlled for happy; intervals of 95%, "
        "9999 shuffles, 10 resamples"
    )
    assert lines[2] == (
        "gender: minus is female, plus is male; alpha = 1 is one SD over persons, 0.811 units of the label. "
        "Area under the curve of 24 persons left out: 0.90 [0.70, 1.00], p = 0.0123; nested −0.26 [−0.50, 0.10]."
    )
    assert lines[3].startswith(f"{STRANGE}: minus is <light>, plus is heavy; alpha = 1 is one SD over persons, ")
    assert "Correlation of 24 persons left out: " in lines[3]
    assert [line for line in lines if line.startswith("Warning: ")] == [f"Warning: {text}" for text in report.faults]
    assert lines[-len(report.notes) :] == list(report.notes)


@pytest.mark.parametrize(
    ("unit", "words"),
    [
        ("sd", "alpha = 1 is one SD over persons, 0.811 units of the label."),
        ("label", "alpha = 1 is one unit of the label."),
        ("coefficient", "alpha = 1 is one filter c, 0.811 units of the label."),
    ],
)
def test_each_unit_in_words(report, unit, words):
    assert words in str(_with(report, "gender", alpha_unit=unit, **NUMBERS))


@pytest.mark.parametrize("n_permutations", [19, 99, 500, 999, 1000, 9999, 10_000])
def test_no_p_is_written_as_zero(report, n_permutations):
    text = str(_with(report, "gender", n_permutations=n_permutations, p=1 / (1 + n_permutations)))
    written = float(text.split("p = ")[1].split(";")[0])
    assert written > 0
    assert abs(written - 1 / (1 + n_permutations)) < 0.2 / n_permutations


def test_the_page_is_whole(html, report):
    page = Page(html)
    assert page.tags[:2] == ["div", "style"]
    assert f"Trait axes: gender, {STRANGE}" in page.text
    for text in (*report.faults, *report.notes, *(line for line in str(report).splitlines())):
        assert text.removeprefix("Warning: ") in page.text
    assert page.text.count("Warnings") == 1
    assert "$" not in page.text
    assert "nan" not in page.text


def test_names_are_escaped(html):
    assert "a<b" not in html
    assert "<light>" not in html
    assert "a&lt;b&amp;c" in html
    assert "minus is &lt;light&gt;" in html


def test_tables_have_the_numbers(html, report):
    text, summary = Page(html).text, report.statistics.summary
    for trait, row in summary.iterrows():
        for name in ("left_out", "nested", "tempo", "stability", "stability_low", "left_out_high"):
            assert f"{row[name]:.2f}".replace("-", "−") in text, (trait, name)
        for share in report.statistics.parts.loc[trait, "share"]:
            assert f"{share:.0%}" in text
    assert f"{report.statistics.cosines.iloc[0, 1]:.2f}".replace("-", "−") in text
    assert "– " in text  # no accuracy of numbers


def test_the_page_asks_for_nothing(html):
    page = Page(html)
    assert not {"script", "link", "iframe", "object", "base"} & set(page.tags)
    assert not [value for name, value in page.attributes if name in ("href", "srcset", "data", "style")]
    assert "url(" not in html
    assert "@import" not in html
    pictures = page.pictures()
    said = [*(f"what the axis of {trait} moves" for trait in ("gender", STRANGE)), "score against number of components"]
    assert [text for text in said if text in pictures] == said
    assert len(pictures) == 7
    for drawing in pictures.values():
        links = [
            value
            for element in ElementTree.fromstring(drawing).iter()
            for name, value in element.attrib.items()
            if name.endswith("href")
        ]
        assert all(link.startswith(("#", "data:")) for link in links)
        assert "@import" not in drawing


def test_what_is_saved_is_what_a_notebook_shows(report, html, tmp_path):
    """To the last bit, although pictures are drawn anew; and with a name that says the encoding."""
    report.save(tmp_path / "report.html")
    text = (tmp_path / "report.html").read_bytes().decode("utf-8")
    assert html in text
    page = Page(text)
    assert page.tags[:6] == ["html", "head", "meta", "meta", "title", "body"]
    assert ("charset", "utf-8") in page.attributes
    assert "<title>Trait axes: gender, a&lt;b&amp;c</title>" in text


def test_no_figure_is_left_behind(html):
    assert html
    assert not pyplot.get_fignums()


@pytest.fixture
def blank(monkeypatch):
    """Leave the pictures out, which take their time, but for what is said of them."""
    monkeypatch.setattr("eigenwalker.display.report._picture", lambda figure, text: f"<p>[{text}]</p>")


def test_a_single_trait_has_no_cosines(single, html, blank):
    text = Page(single._repr_html_()).text
    assert "Cosines between axes" in Page(html).text
    assert "Cosines between axes" not in text
    assert text.count("of weight moves]") == text.count("labels of weight]") == 1
    assert single.statistics.cosines.shape == (1, 1)


def test_no_faults_no_warnings(single, blank):
    page = AxisReport(replace(single.statistics, faults=()))._repr_html_()
    assert 'class="faults"' not in page
    assert "Warning" not in Page(page).text


def test_bodies_are_drawn_at_two_sds_in_any_unit(single, report, walkers, monkeypatch):
    for one in (single, report):
        drawn = {}
        monkeypatch.setattr(
            AxisReport, "plot_axis", lambda self, trait, alpha, drawn=drawn: drawn.update({trait: alpha}) or _Empty()
        )
        one._bodies(list(one.statistics.summary.index))
        spread = one.statistics.model.transform(walkers.data).std(axis=0, ddof=1)
        assert np.allclose(list(drawn.values()), 2 * spread, rtol=0.005)
    assert drawn == {"gender": 2.0, STRANGE: 2.0}


class _Empty:
    @property
    def figure_(self):
        from matplotlib.figure import Figure

        return Figure()


def test_plots_are_of_the_report(report):
    found = report.statistics
    assert report.plot_components().chosen == 5
    assert report.plot_components().curve is found.components
    assert report.plot_components().ylabel == "area under the curve or correlation"
    assert report.plot_harmonics().chosen == 2
    assert report.plot_harmonics().curve is found.harmonics
    assert report.plot_permutations("gender").score == found.permutations["gender"].score
    assert report.plot_permutations("gender").score_name == "gender: area under the curve"
    assert report.plot_permutations(STRANGE).score_name == f"{STRANGE}: correlation"
    (panel,) = report.plot_axis("gender", alpha=1.0, views=("side",)).axes_
    assert "gender: from female (alpha = −1) to male (alpha = +1)" in panel.get_title(loc="left")
    assert_array_equal(report.plot_scree().shares, found.model["eigenwalkers"].explained_variance_ratio_)


@pytest.mark.parametrize("plot", ["plot_axis", "plot_permutations"])
def test_unknown_traits_are_refused(report, plot):
    with pytest.raises(ValueError, match="trait must be one of 'gender', 'a<b&c', got 'age'"):
        getattr(report, plot)("age")


def test_the_chosen_number_is_in_every_curve(walkers, single):
    """Also where it is one that the curve would leave out, and where there is no curve."""
    options = FAST | {"n_harmonics": [3]}
    report = axis_report(make_eigenwalkers(n_components=23), walkers.data, walkers.target["gender"], **options)
    assert report.plot_components().chosen == 23
    assert report.plot_harmonics().chosen is None
    assert single.plot_harmonics().curve.empty


def test_joint_walks_have_no_bodies(blank):
    random = np.random.default_rng(0)
    skeleton = Skeleton(("hips", "left", "right"), [-1, 0, 0], np.zeros((3, 3)))
    phase = 2 * np.pi * 0.9 * np.arange(150) / 50
    walks, swings = [], random.uniform(0.3, 0.6, size=12)
    for number, swing in enumerate(swings):
        rotations = random.normal(scale=0.1, size=(3, 3)) + 0.01 * random.normal(size=(150, 3, 3))
        rotations[:, 1, 0] += swing * np.cos(phase)
        rotations[:, 2, 0] -= swing * np.cos(phase)
        walks.append(JointWalk(rotations, np.zeros((150, 3)), skeleton, 50.0, f"walker_{number:02d}"))
    model = make_eigenwalkers(n_components=3)
    model.set_params(linearizer__phase_reference={"left_x": 1.0, "right_x": -1.0})
    text = Page(axis_report(model, walks, swings, **FAST)._repr_html_()).text
    assert "Axes of joint angles are not drawn on the body." in text
    assert "[scores of shuffled labels of trait]" in text
    assert "[what the axis" not in text


def test_groups_and_warnings_reach_the_report(walkers):
    walks = [replace(walk, name=f"S{number // 2:02d}_{number % 2:02d}") for number, walk in enumerate(walkers.data)]
    weight, model = walkers.target["weight"].to_numpy(), make_eigenwalkers(n_components=4)
    with pytest.warns(LeakageWarning, match="24 walks look like those of 12 persons"):
        report = axis_report(model, walks, weight, **FAST)
    assert "Warning: 24 walks look like those of 12 persons" in str(report)
    persons = np.repeat(np.arange(12), 2)
    report = axis_report(model, walks, np.repeat(weight[::2], 2), groups=persons, **FAST)
    assert "24 walks of 12 persons" in str(report)
    assert report.to_frame()["n_persons"].tolist() == [12]


def test_importing_draws_nothing():
    code = (
        "import sys, eigenwalker; assert 'matplotlib' not in sys.modules; "
        "import eigenwalker.display, eigenwalker.model; assert 'matplotlib' not in sys.modules"
    )
    root = str(Path(eigenwalker.__file__).parents[1])
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True, env={"PYTHONPATH": root})
