"""What holds for the core's tests: properties are tried with the same examples every time, on slow machines, too."""

from __future__ import annotations

from hypothesis import settings

from tests.support.thinning import examples

settings.register_profile("same every time", derandomize=True, deadline=None, max_examples=examples(100))
settings.load_profile("same every time")
