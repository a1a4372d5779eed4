"""Measurements against named peers: ``python -m benchmarks.linearize``, and `frequency` and `memory`, each ``[--short]``.

Each prints the machine, the peers it ran beside, ratios with errors, and which targets are met. The peers that are not
dependencies come with ``pip install ".[bench]"``; one that does not import is a row with the reason.
"""
