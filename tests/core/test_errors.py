"""Errors and messages: what they say, and that they still know what they were made of."""

from __future__ import annotations

import copy
import copyreg
import errno
import json
import pickle
import weakref
from pathlib import Path

import numpy as np
import pytest
from terrainav.core import errors
from terrainav.core.errors import InvalidInput, Message, OptionName, PartError, SourceError, TerrAInavError
from terrainav.core.imagery.http.transport import TransportError
from terrainav.core.imagery.policy import Policy, TermsError

from tests.support.errors import refused

RAISE = Message("raise {0}", OptionName("error_budget"))
MESSAGES = [
    Message("plain {braces} and all"),
    Message("{0:g} of {1!r} at {2:,.1f}", 0.5, "x", 1234.5),
    Message("{0}: {1}", Message("tile {0}", 3), InvalidInput("no {0}", "air", remedy=RAISE)),
    OptionName("max_images"),
]
ERRORS = [
    InvalidInput("zoom {0}: must be {1:g} or more", -1, 0.0, field="zoom", remedy=RAISE),
    SourceError("is gone"),
    TransportError("no answer from {0}", "host", late=True),
    TermsError("OSM", Policy("ask", 5), 10, ("world",)),
]


def test_a_message_is_its_english_sentence():
    message = MESSAGES[1]
    assert message == "0.5 of 'x' at 1,234.5"
    assert (message.template, message.values) == ("{0:g} of {1!r} at {2:,.1f}", (0.5, "x", 1234.5))
    assert json.dumps(message) == json.dumps(str(message))
    assert {message: 1}["0.5 of 'x' at 1,234.5"] == 1


def test_a_template_without_values_is_taken_as_it_is():
    assert MESSAGES[0] == MESSAGES[0].template == "plain {braces} and all"
    assert Message("{{z}} of {0}", "url") == "{z} of url"


@pytest.mark.parametrize("message", MESSAGES)
@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_copies_of_messages_know_the_same(message, copied):
    made = copied(message)
    assert made == message
    assert type(made) is type(message)
    if isinstance(message, Message):
        assert made.template == message.template
        assert list(map(str, made.values)) == list(map(str, message.values))
        assert list(map(type, made.values)) == list(map(type, message.values))
    else:
        assert made.name == message.name


def test_an_option_is_named_as_the_command_takes_it():
    option = OptionName("max_images")
    assert (option, option.name, option.in_brackets) == ("--max-images", "max_images", " (--max-images)")


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_errors_go_from_process_to_process(error):
    made = pickle.loads(pickle.dumps(error))
    assert type(made) is type(error)
    assert str(made) == str(error)
    assert (made.message.template, made.field, made.remedy) == (
        error.message.template,
        error.field,
        error.remedy,
    )
    assert made.__dict__.keys() == error.__dict__.keys()


def test_an_error_says_what_helps():
    error = ERRORS[0]
    assert str(error) == "zoom -1: must be 0 or more; raise --error-budget"
    assert error.message == "zoom -1: must be 0 or more"
    assert (error.remedy, error.remedy.values) == ("raise --error-budget", (OptionName("error_budget"),))
    assert SourceError("is gone").remedy is None
    assert str(TerrAInavError()) == ""


def test_what_is_wrapped_is_taken_over():
    error = ERRORS[0]
    again = PartError(error)
    assert (str(again), again.field, again.remedy) == (str(error), "zoom", error.remedy)
    assert again.message.values == error.message.values
    assert PartError(error, field="other", remedy="wait").field == "other"
    assert Message(MESSAGES[1]).values == MESSAGES[1].values
    # As a message, an error says all of it.
    assert Message(error) == str(error)
    assert Message(SourceError("is {0}", "gone")).template == "is {0}"


def test_an_error_within_a_message_keeps_its_parts_and_no_trace():
    class Held:
        """Something large that was under way."""

    def fail():
        held = Held()
        seen.append(weakref.ref(held))
        raise InvalidInput("no {0}", "air", field="agl_m", remedy=RAISE)

    seen = []
    try:
        fail()
    except InvalidInput as wrong:
        message = Message("file: {0}", wrong)
    assert message == "file: no air; raise --error-budget"
    (kept,) = message.values
    assert (kept.field, kept.message.values, kept.remedy) == ("agl_m", ("air",), RAISE)
    assert seen[0]() is None


def test_values_are_kept_as_what_they_are_or_as_text():
    values = (Path("a"), np.float32(0.5), np.int64(7), OSError(errno.EIO, "torn"), (1, 2), None)
    message = Message(" ".join(f"{{{place}}}" for place in range(len(values))), *values)
    assert message == f"a 0.5 7 {values[3]} (1, 2) None"
    assert message.values == ("a", np.float32(0.5), np.int64(7), str(values[3]), "(1, 2)", "None")
    # What an error of another kind says in a message is one.
    assert Message("{0}", ValueError(MESSAGES[1])).values[0].template == MESSAGES[1].template


def test_a_copy_is_our_own_also_where_a_library_copies_errors_otherwise(monkeypatch):
    error = PartError("key of {0}", "key-1", field="agl_m", remedy=RAISE)
    # As tblib does for Dask, which has errors take their traces along.
    monkeypatch.setitem(copyreg.dispatch_table, PartError, lambda _: (lambda: error, ()))
    masked = error.map_texts(lambda text: text.replace("key", "***"))
    assert masked is not error
    assert (str(masked), masked.field) == ("key of ***-1; raise --error-budget", "agl_m")
    assert str(error) == "key of key-1; raise --error-budget"


def test_texts_of_values_are_masked_and_templates_are_not():
    error = PartError(
        "key of {0}: {1} {2}",
        "key-1",
        InvalidInput("key {0} {1}", "key-2", 3, remedy=Message("use key {0}", "key-3")),
        OptionName("zoom"),
    )
    masked = error.map_texts(lambda text: text.replace("key", "***"))
    assert str(masked) == "key of ***-1: key ***-2 3; use key ***-3 --zoom"
    assert masked.message.template == error.message.template
    assert "***" not in str(error)
    assert type(masked) is PartError
    assert Message("key-4 it said").map_texts(lambda text: text.replace("key", "***")) == "***-4 it said"


def test_messages_in_a_row():
    joined = Message.joined("; ", MESSAGES[:2])
    assert joined == f"{MESSAGES[0]}; {MESSAGES[1]}"
    assert joined.values == tuple(MESSAGES[:2])
    assert not Message.joined(", ", [])


def test_every_kind_of_error_has_one_root():
    kinds = [kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, Exception)]
    assert all(issubclass(kind, TerrAInavError) for kind in kinds)
    with refused("no {0}", "air", field="agl_m"):
        raise InvalidInput("no {0}", "air", field="agl_m")
