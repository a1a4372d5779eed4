"""The page of a study as a file: what it is made of, and what it lets in."""

import base64
import hashlib
import json
import re
from html.parser import HTMLParser
from importlib.resources import files

import pytest

from eigenwalker.experiment.running.study_page import study_page
from tests.experiment.running.study_pages import five_tasks, rating

VENDORED = files("eigenwalker.experiment.running.study_page") / "vendored"
MANIFEST = json.loads((VENDORED / "manifest.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def contents():
    return rating()[0]


class _Elements(HTMLParser):
    """Attributes of all elements, and texts of those that hold scripts or styles."""

    def __init__(self, page):
        super().__init__()
        self.elements, self.texts, self.is_inside = [], [], False
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        self.is_inside = tag in ("script", "style")
        if self.is_inside:
            self.texts.append((tag, dict(attributes).get("type"), ""))

    def handle_endtag(self, tag):
        self.is_inside = False

    def handle_data(self, data):
        if self.is_inside:
            tag, kind, text = self.texts[-1]
            self.texts[-1] = tag, kind, text + data


def _policy(page):
    return re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]


@pytest.mark.parametrize("entry", MANIFEST, ids=lambda entry: entry["file"])
def test_vendored_files_are_those_of_the_manifest(entry):
    assert hashlib.sha256((VENDORED / entry["file"]).read_bytes()).hexdigest() == entry["sha256"]
    assert entry["license"] == "MIT"


def test_vendored_files_have_their_license_beside_them():
    text = (VENDORED / "LICENSE").read_text(encoding="utf-8")
    assert "The MIT License" in text
    assert all(entry["file"] in text for entry in MANIFEST)
    assert {path.name for path in VENDORED.iterdir()} == {"LICENSE", "manifest.json", *(e["file"] for e in MANIFEST)}


def test_versions_are_those_that_the_files_say(contents):
    page = study_page(contents)
    assert {entry["package"]: entry["version"] for entry in MANIFEST} == {
        "jspsych": re.search(r'"(8\.\d+\.\d+)"', page)[1],
        "@jspsych/plugin-html-button-response": re.search(r'name:"html-button-response",version:(\w+)', page)
        and re.search(r'var \w+="(2\.\d+\.\d+)"', page)[1],
    }


def test_the_policy_allows_these_scripts_and_this_style_and_nothing_else(contents):
    page = study_page(contents)
    texts = _Elements(page).texts
    digests = {
        f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
        for _, kind, text in texts
        if kind != "application/json"
    }
    policy = dict(part.strip().split(" ", 1) for part in _policy(page).split(";"))
    assert policy.pop("default-src") == "'none'"
    assert {*policy.pop("script-src").split(), policy.pop("style-src")} == digests
    assert policy == {"img-src": "data:", "media-src": "'self' file:"}


def test_the_page_refers_to_nothing_outside(contents):
    page = study_page(contents)
    referred = [a[name] for _, a in _Elements(page).elements for name in ("src", "href", "action") if name in a]
    assert referred == ["data:,"]
    assert "sourceMappingURL" not in page


def test_a_page_for_jatos_loads_the_script_that_its_server_has(contents):
    page = study_page(contents, jatos=True)
    scripts = [attributes.get("src") for tag, attributes in _Elements(page).elements if tag == "script"]
    assert scripts == ["jatos.js", None, None, None, None]
    policy = _policy(page)
    assert "default-src 'none'" in policy
    assert not re.search(r"https?:|\*", policy)


def test_the_same_study_is_the_same_page(contents):
    assert study_page(contents) == study_page(rating()[0])


def test_contents_come_out_as_they_went_in(contents):
    page = study_page(contents)
    inside = next(text for _, kind, text in _Elements(page).texts if kind == "application/json")
    assert json.loads(inside) == contents


def test_words_of_a_study_end_no_element(contents):
    attack = "</script></title><script>alert(1)</script><!-- <script>"
    hostile = {**contents, "title": attack, "consent": attack}
    names = [tag for tag, _ in _Elements(study_page(hostile)).elements]
    assert names == [tag for tag, _ in _Elements(study_page(contents)).elements]


def test_no_script_is_longer_than_one_idea():
    folder = files("eigenwalker.experiment.running.study_page")
    lengths = {
        path.name: len(path.read_text(encoding="utf-8").splitlines())
        for path in folder.iterdir()
        if path.name.endswith(".js")
    }
    assert len(lengths) > 10
    assert max(lengths.values()) <= 300


def test_modules_know_only_what_they_import():
    """Each is in a scope of its own on the page, so that what it needs of others must be among their exports."""
    folder = files("eigenwalker.experiment.running.study_page")
    viewer = files("eigenwalker.display.viewer")
    for path in folder.iterdir():
        if not path.name.endswith(".js"):
            continue
        for names, source in re.findall(r"import \{([^}]*)\} from \"\./([\w.]+)\"", path.read_text(encoding="utf-8")):
            home = viewer if source in ("walker.js", "stage.js") else folder
            exported = re.findall(
                r"^export (?:async )?(?:class|const|function) (\w+)", (home / source).read_text(), re.M
            )
            assert {name.strip() for name in names.split(",") if name.strip()} <= set(exported)


def test_contents_of_another_format_are_refused(contents):
    with pytest.raises(ValueError, match="contents of format 1, as page_contents makes them, got 2"):
        study_page({**contents, "format": 2})


def test_pages_are_small():
    assert len(study_page(five_tasks())) < 300_000
