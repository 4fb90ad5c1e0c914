"""The command itself: whatever it is given, it ends with a code of its own and one line."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator

from hypothesis import strategies as st
from terrainav.core.cli import main
from terrainav.core.cli.exits import BAD_INPUT, DONE, FAILED
from terrainav.core.mission.options import OPTIONS

from tests.fuzz.missions import COORDS
from tests.fuzz.support import Target, as_text, mutated

#: Those that write somewhere, or ask a server.
_LEFT_OUT = ("area", "source", "cache_dir", "data_dir", "coords")


def command(arguments: list[str]) -> None:
    said = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):
        try:
            code = main(["plan", "--max-images", "200", *arguments])
        except SystemExit as ended:
            code = ended.code
    assert code in (DONE, BAD_INPUT, FAILED), f"code {code}: {said.getvalue()}"


def targets() -> Iterator[Target]:
    options = st.sampled_from([option for option in OPTIONS if option.name not in _LEFT_OUT])
    words = mutated("0.5", "10", "64", "satellite", "2024-06-21", "1e-9").map(as_text)

    @st.composite
    def given(draw):
        arguments = ["--coords", as_text(draw(mutated(*COORDS[:2])))]
        for option in draw(st.lists(options, max_size=3)):
            count = 0 if option.flag else option.count[1] if option.count else 1
            usual = option.choices or ("1", "0", "30", "0.5", "18", "640", "100")
            arguments.append("--" + option.name.replace("_", "-"))
            arguments += draw(st.lists(st.sampled_from(usual) | words, min_size=count, max_size=count))
        return arguments

    huge = "1" + "0" * 400
    yield Target(
        "terrainav plan",
        command,
        given(),
        (
            ["--coords", COORDS[0], "--img-size", "60000", "60000", "3"],
            ["--coords", COORDS[0], "--max-px", huge],
            ["--coords", COORDS[0], "--image-px", huge, "--zoom", huge],
        ),
    )
