"""Attacks by chance: what they have in common.

A target takes what somebody else may have made, and does with it what the program does. Whatever it is given, only
errors that are raised on purpose may come out, within `LONGEST_S` of the processor and `MOST_BYTES`. A module of
targets is one of `MODULES`, with a function ``targets()``; what is found is added to its corpus, which is tried first.
"""

from __future__ import annotations

import contextlib
import copy
import gc
import importlib
import json
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import hypothesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from terrainav.core.errors import TerrAInavError

MODULES = ("missions", "files", "imagery", "commands")
LONGEST_S, MOST_BYTES = 5.0, 1 << 30

# What has ended programs before, as bytes between others, and as values of JSON.
TOKENS = (
    *(
        b"\x00",
        b"\xff\xfe",
        b"\xef\xbb\xbf",
        b"\xed\xa0\x80",
        b"\r",
        b"\n",
        b'"',
        b"\\",
        b"\\ud800",
        b"\x1b[31m",
    ),
    *(b"[" * 5000, b'{"a":' * 5000, b"<" * 5000, b"9" * 400, b"9" * 5000, b"1e999", b"-1e308", b"1e-320"),
    *(b"NaN", b"Infinity", b"null", b"true", b"[]", b"{}", b'""', b"-", b"--", b"_", b",", b" ", b"0", b"-0"),
    *("²", "١", "−", "\u2028", "é", "../../etc/passwd", "{key}"),
)
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 2**31, 2**63, 2**64, 10**400, -(10**400)),
    *(0.0, -0.0, 0.5, 1e-320, 1e-9, 1e9, 1e155, 1e308, -1e308, float("nan"), float("inf"), -float("inf")),
    *("", " ", "0", "1e999", "nan", "²", "\ud800", "a\nb", "\x00", "x" * 5000, "{key}", "../..", "satellite"),
    *([], {}, [[]], [None], {"a": None}, [1, 2], [1, 2, 3], [0.1] * 4, "[" * 200, [[[[1, 2]]]]),
)


class TooSlowError(Exception):
    """An example took longer than `LONGEST_S`."""


class TooLargeError(Exception):
    """An example took more memory than `MOST_BYTES`."""


@dataclass
class Target:
    """What is attacked, and with what.

    Parameters
    ----------
    name : str
    attack : callable
        Does with an example what the program does with such a thing.
    strategy : SearchStrategy
    corpus : tuple
        Examples that are tried first: what was found once.
    quick : int
        Examples of the quick draw, which is a part of every run of the tests.
    examples, accepted, slowest_s : int, int, float
        Of the draws so far; ``accepted`` are those that were not refused: most that are easily refused test little.
    """

    name: str
    attack: Callable[[Any], object]
    strategy: st.SearchStrategy[Any]
    corpus: tuple[Any, ...] = ()
    quick: int = 20
    examples: int = field(default=0, init=False)
    accepted: int = field(default=0, init=False)
    slowest_s: float = field(default=0.0, init=False)

    def run(self, example: Any) -> None:
        """Attack once; raises whatever may not come out."""
        before, start_s = peak_bytes(), time.process_time()
        with contextlib.suppress(TerrAInavError):
            self.attack(example)
            self.accepted += 1
        taken_s = time.process_time() - start_s
        self.examples += 1
        self.slowest_s = max(self.slowest_s, taken_s)
        if taken_s > LONGEST_S:
            raise TooSlowError(f"{taken_s:.1f} s")
        if peak_bytes() - before > MOST_BYTES:
            raise TooLargeError(f"{(peak_bytes() - before) / 1e9:.1f} GB")

    def draw(self, examples: int, seed: int | None = None) -> None:
        """Attack with the corpus, then with so many examples: the same every time, or those of a seed."""
        for example in self.corpus if seed is None else ():
            self.run(example)

        @settings(
            max_examples=examples,
            database=None,
            deadline=None,
            derandomize=seed is None,
            # An example that hangs is not made smaller, which would hang for hours.
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        @given(self.strategy)
        def attacked(example: Any) -> None:
            self.run(example)

        (attacked if seed is None else hypothesis.seed(seed)(attacked))()


def all_targets() -> Iterator[Target]:
    """Targets of all modules."""
    for name in MODULES:
        yield from importlib.import_module(f"tests.fuzz.{name}").targets()


def any_of(attempts: Iterable[Callable[[], object]]) -> None:
    """Make all attempts; the example counts as accepted where one of them was not refused."""
    refused = [_refusal(attempt) for attempt in attempts]
    if all(refused):
        raise refused[0]


def _refusal(attempt: Callable[[], object]) -> TerrAInavError | None:
    try:
        attempt()
    except TerrAInavError as wrong:
        return wrong
    return None


def peak_bytes() -> int:
    """Most memory that this process has had so far; 0 on Windows."""
    if sys.platform == "win32":
        return 0
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


@st.composite
def mutated(draw: Any, *samples: str | bytes) -> bytes:
    """Bytes of a sample with pieces cut out, doubled or put in; or any bytes."""
    chosen = draw(st.sampled_from((*samples, b"")))
    data = chosen.encode("utf-8") if isinstance(chosen, str) else chosen
    for _ in range(draw(st.integers(0, 4))):
        start = draw(st.integers(0, len(data)))
        end = draw(st.integers(start, min(start + 20, len(data))))
        token = draw(st.sampled_from(TOKENS) | st.binary(max_size=8))
        token = token.encode("utf-8") if isinstance(token, str) else token
        data = data[:start] + token + data[draw(st.sampled_from((start, end))) :]
    return data


def as_text(data: bytes) -> str:
    """Text of bytes, as a program is given it where they are none."""
    return data.decode("utf-8", "surrogateescape")


@st.composite
def altered(draw: Any, *documents: Any) -> Any:
    """A document of JSON in which a few values, anywhere, are others, too many or gone."""
    document = [copy.deepcopy(draw(st.sampled_from(documents)))]
    for _ in range(draw(st.integers(1, 3))):
        holder, key = draw(st.sampled_from(list(_places(document))))
        what = draw(st.integers(0, 9))
        if what == 0 and isinstance(holder, dict):
            del holder[key]
        elif what == 1 and isinstance(holder, dict):
            holder[draw(st.sampled_from(("type", "a", "", "schema", "\ud800", "x" * 300)))] = None
        elif what == 2 and isinstance(holder, list) and holder is not document:
            holder.append(holder[key])
        else:
            number = st.floats() | st.integers() | st.text(max_size=5)
            holder[key] = copy.deepcopy(draw(st.sampled_from(VALUES) | number))
    return document[0]


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every place in a document: what holds it, and its index or name there."""
    keys: Any = value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        yield value, key
        yield from _places(value[key])


def as_json(document: Any) -> bytes:
    """Text of a document, with what JSON has no words for as Python's json writes it."""
    return json.dumps(document).encode("ascii")


def settled() -> None:
    """Free what examples have left, so that peaks are those of one."""
    gc.collect()
