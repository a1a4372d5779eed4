"""Measurements against named peers: ``python -m benchmarks.linearize``, ``.frequency``, ``.memory`` and ``.read``.

Each prints the machine, the peers it ran beside, ratios with errors, and which targets are met; ``--short`` is a quick
run of the same. The peers that are not dependencies come with ``pip install ".[bench]"``; one that does not import is
a row with the reason. ``python -m pytest benchmarks`` compares results with theirs, and ``python -m benchmarks.fuzz``
reads 200,000 damaged files.
"""
