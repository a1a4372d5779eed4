"""Measurements against named peers: ``python -m benchmarks.linearize``, ``.frequency`` and ``.memory``.

Each prints the machine, the peers it ran beside, ratios with errors, and which targets are met; ``--short`` is a quick
run of the same. The peers that are not dependencies come with ``pip install ".[bench]"``; one that does not import is
a row with the reason.
"""
