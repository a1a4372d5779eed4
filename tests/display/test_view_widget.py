"""The widget of a notebook: Python to JavaScript and back, with the module that anywidget gives to notebooks."""

from pathlib import Path

import pytest

from eigenwalker import walk_at
from eigenwalker.display import view
from tests.viewer_pages import four_axes, settle, wait_until

anywidget = pytest.importorskip("anywidget", reason="the extra notebook is not installed")

# The least that anywidget's front end needs of the base classes of Jupyter's widgets: a model with values that says
# when they change, and a view with an element. The host, as JupyterLab does, takes all keys that come to it.
HOST = """
window.parts = {};
class Model {
  constructor(values) { this.values = values; this.listeners = []; this.changed = {}; }
  initialize() {}
  get(name) { return this.values[name]; }
  set(name, value) {
    const changes = typeof name === "string" ? { [name]: value } : name;
    for (const [key, one] of Object.entries(changes)) {
      this.values[key] = one;
      this.changed[key] = one;
      this.trigger(`change:${key}`, this, one);
    }
  }
  on(name, callback, context) { this.listeners.push({ name, callback, context }); }
  once(name, callback, context) { this.on(name, callback, context); }
  off(name, callback, context) {
    this.listeners = this.listeners.filter((one) =>
      (name && one.name !== name) || (callback && one.callback !== callback) || (context && one.context !== context));
  }
  trigger(name, ...rest) {
    for (const one of [...this.listeners]) if (one.name === name) one.callback.apply(one.context, rest);
  }
  save_changes() { toPython(this.changed); this.changed = {}; }
  send() {}
}
class View {
  constructor(model, el) { Object.assign(this, { model, el, $el: { empty: () => el.replaceChildren() } }); }
  remove() { this.el.remove(); }
}
window.define = (needs, make) => (window.parts = make({ DOMWidgetModel: Model, DOMWidgetView: View }));
window.show = async (state) => {
  window.model ??= new window.parts.AnyModel(state);
  if (!window.begun) await model.initialize(state, {});
  window.begun = true;
  const el = document.body.appendChild(document.createElement("div"));
  const shown = new window.parts.AnyView(model, el);
  await shown.render();
  return shown;
};
document.addEventListener("keydown", (event) => event.preventDefault());
"""


@pytest.fixture
def shown():
    model, walks = four_axes()
    return view(model, walks[:3], alphas={"happy": 2})


@pytest.fixture
def page(browser, shown, tmp_path):
    """Yield a notebook in which the widget is shown, connected with Python."""
    notebook = tmp_path / "notebook.html"
    notebook.write_text("<!DOCTYPE html><meta charset=utf-8><title>notebook</title><body></body>", encoding="utf-8")
    widget, said = shown.widget(), []
    page = browser.new_context(viewport={"width": 1000, "height": 800}, reduced_motion="reduce").new_page()
    page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.expose_function("toPython", widget.set_state)
    page.goto(notebook.as_uri())
    page.add_script_tag(content=HOST)
    page.add_script_tag(content=(Path(anywidget.__file__).parent / "nbextension" / "index.js").read_text("utf-8"))
    names = ["_esm", "_css", "_anywidget_id", "_markup", "_contents", "alphas"]
    page.evaluate("async (state) => { window.shown = await show(state) }", widget.get_state(names))
    page.locator(".eigenwalker .trait").first.wait_for()
    yield page
    page.context.close()
    assert not said


def _to_browser(page, shown):
    page.evaluate("(state) => model.set(state)", shown.widget().get_state(["alphas"]))


def _numbers(page):
    return [float(field.input_value()) for field in page.locator(".trait .number").all()]


def test_alphas_go_to_the_browser(page, shown):
    assert _numbers(page)[2] == 2
    shown.alphas = {"gender": -1.5, "weight": 0}
    _to_browser(page, shown)
    assert _numbers(page)[:2] == [-1.5, 0]
    held = [switch.is_checked() for switch in page.locator(".trait .hold input").all()]
    assert held == [True, True, False, False]


def test_alphas_come_from_the_browser(page, shown):
    seen = []
    shown.widget().observe(lambda change: seen.append(change["new"]), "alphas")
    page.locator(".trait .range").nth(3).press("ArrowRight")
    wait_until(page, lambda: list(shown.alphas) == ["happy", "nervous"])
    assert shown.alphas["happy"] == 2
    assert seen[-1] == shown.alphas
    page.get_by_label("hold happy").uncheck()
    wait_until(page, lambda: list(shown.alphas) == ["nervous"])


def test_the_alphas_in_python_are_the_walk_on_the_page(page, shown):
    model, _ = four_axes()
    page.locator(".trait .range").first.press("ArrowLeft")
    wait_until(page, lambda: "gender" in shown.alphas)
    points = page.evaluate(
        "() => { const v = document.querySelector('.eigenwalker').viewer; return [...v.walker.shown] }"
    )
    assert walk_at(model, shown.alphas).positions[0].ravel() == pytest.approx(points, abs=1e-9)


def test_arrow_keys_are_not_swallowed_by_the_notebook(page):
    before = _numbers(page)[0]
    page.locator(".trait .range").first.press("ArrowRight")
    assert _numbers(page)[0] > before
    azimuth = "document.querySelector('.eigenwalker').viewer.scene.azimuth"
    page.locator("canvas").press("ArrowRight")
    assert page.evaluate(azimuth) == 35
    assert page.locator("[data-lm-suppress-shortcuts]").count() == 1


def test_two_views_of_a_widget_follow_each_other(page):
    page.evaluate("async () => { window.second = await show() }")
    page.locator(".eigenwalker").nth(1).locator(".trait").first.wait_for()
    page.locator(".eigenwalker").nth(1).locator(".trait .range").first.press("End")
    settle(page)
    assert page.locator(".eigenwalker").first.locator(".trait .number").first.input_value() == "6.00"


def test_a_view_that_is_removed_does_nothing_more(page):
    """Its listeners are gone, and no frame is asked for."""
    viewer = "document.querySelector('.eigenwalker').viewer"
    page.evaluate(f"() => {{ window.gone = {viewer}; window.gone.play(true); window.shown.remove(); }}")
    page.wait_for_timeout(100)
    phase = page.evaluate("() => gone.walker.phase")
    page.evaluate("() => model.set('alphas', { gender: 1 })")
    page.wait_for_timeout(100)
    assert page.evaluate("() => gone.walker.phase") == phase
    assert page.evaluate("() => gone.alphas") == {"happy": 2}


def test_wrong_alphas_are_refused_in_python(shown):
    widget = shown.widget()
    with pytest.raises(ValueError, match="no trait 'mood'"):
        widget.alphas = {"mood": 1}
    with pytest.raises(ValueError, match=r"happy = 99 is no number from -6 to 6"):
        shown.alphas = {"happy": 99}
    assert shown.alphas == widget.alphas == {"happy": 2.0}


def test_a_notebook_is_offered_the_widget_and_the_page(shown):
    bundle, _ = shown._repr_mimebundle_()
    assert {"application/vnd.jupyter.widget-view+json", "text/html", "text/plain"} == set(bundle)
    assert shown.widget() is shown.widget()


def test_what_is_saved_has_the_alphas_of_the_widget(shown, tmp_path):
    shown.widget().alphas = {"weight": 1.25}
    shown.save(tmp_path / "walker.html")
    assert '"alphas":{"weight":1.25}' in (tmp_path / "walker.html").read_text(encoding="utf-8")
