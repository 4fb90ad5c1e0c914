"""What holds for the core's tests: properties are tried with the same examples every time, on slow machines, too."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("same every time", derandomize=True, deadline=None)
settings.load_profile("same every time")
