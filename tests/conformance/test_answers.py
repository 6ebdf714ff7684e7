"""The channel of answers: nothing counts but the one answer that bears the key of the question."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator

import pytest

from fmukit.conformance.answers import Listener, answer


class Talk:
    """A listener, and the other ends of its pipes."""

    def __init__(self) -> None:
        asked, questions = os.pipe()
        answers, self.channel = os.pipe()
        self.questions = os.fdopen(asked, "rb", buffering=0)
        self.listener = Listener(os.fdopen(questions, "wb"), os.fdopen(answers, "rb"))

    def key(self) -> str:
        return str(json.loads(self.questions.readline())["key"])

    def say(self, data: bytes) -> None:
        os.write(self.channel, data)
        while self.listener.listen(0.2):
            pass


@pytest.fixture
def talk() -> Iterator[Talk]:
    talk = Talk()
    yield talk
    os.close(talk.channel)


def test_an_answer_is_heard_in_pieces(talk: Talk) -> None:
    talk.listener.ask("L1")
    text = json.dumps({"key": talk.key(), "status": "fail", "seen": ["\u00e4", "b"]}).encode()
    talk.say(b"\n" + text[:20])
    assert talk.listener.answer() is None
    talk.say(text[20:] + b"\n")
    assert talk.listener.answer() == ("fail", ("\u00e4", "b"))
    assert talk.listener.strays == []


@pytest.mark.parametrize(
    "line",
    [
        b'{"key": "", "status": "pass", "seen": []}',
        b'{"key": "KEY", "status": "perfect", "seen": []}',
        b'{"key": "KEY", "status": "pass"}',
        b'{"rule": "L1", "status": "pass", "seen": []}',
        b'["KEY"]',
        b"null",
        b"[" * 100_000,
        b"\xff\xfe\x00",
        b"{",
    ],
)
def test_anything_else_is_a_stray(line: bytes, talk: Talk) -> None:
    talk.listener.ask("L1")
    key = talk.key()
    for start in range(0, len(line), 4096):
        talk.say(line.replace(b"KEY", key.encode())[start : start + 4096])
    answer(talk.channel, key, "fail", ["what was seen"])
    talk.say(b"")
    assert talk.listener.answer() == ("fail", ("what was seen",))
    assert len(talk.listener.strays) == 1


def test_a_second_answer_and_one_of_an_old_key_do_not_count(talk: Talk) -> None:
    talk.listener.ask("L1")
    key = talk.key()
    answer(talk.channel, key, "fail", ["first"])
    answer(talk.channel, key, "pass", [])
    talk.say(b"")
    assert talk.listener.answer() == ("fail", ("first",))
    talk.listener.ask("L2")
    assert talk.key() != key
    answer(talk.channel, key, "pass", [])
    talk.say(b"")
    assert talk.listener.answer() is None
    assert len(talk.listener.strays) == 2
