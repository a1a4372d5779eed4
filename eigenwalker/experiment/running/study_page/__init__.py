"""The page of a study: markup, style and scripts are real files here, `study_page` makes one page of them."""

from eigenwalker.experiment.running.study_page.assembly import study_page

__all__ = ["study_page"]
