"""Signals come through where they do no harm."""

import signal
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from omni_vehicle_ros.bags.mcap.file_writer import McapFile
from omni_vehicle_ros.bags.mcap.stream import read_messages
from omni_vehicle_ros.ending import ENDING, Uninterrupted
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.simulation import simulate


class Came(Exception):
    """What the handler raises."""


@pytest.fixture(autouse=True)
def raising_handler() -> Iterator[None]:
    def handler(number: int, frame: object) -> None:
        for each in ENDING:
            signal.signal(each, signal.SIG_IGN)
        raise Came

    before = {number: signal.signal(number, handler) for number in ENDING}
    yield
    for number, earlier in before.items():
        signal.signal(number, earlier)


@pytest.mark.parametrize('number', ENDING)
def test_a_signal_waits_for_its_delivery(number: signal.Signals) -> None:
    with Uninterrupted() as signals:
        signals.deliver()
        signal.raise_signal(number)
        with pytest.raises(Came):
            signals.deliver()
    # What the handler has set stands: the context does not give it back a second time.
    assert signal.getsignal(number) is signal.SIG_IGN


def test_a_signal_waits_for_the_end() -> None:
    steps = []
    with pytest.raises(Came), Uninterrupted():
        signal.raise_signal(signal.SIGINT)
        steps.append('done')
    assert steps == ['done']


def test_other_threads_get_no_signals() -> None:
    failures = []

    def work() -> None:
        try:
            with Uninterrupted() as signals:
                signals.deliver()
        except ValueError as error:
            failures.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert not failures


def test_a_signal_amid_a_write_loses_no_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    handed = []
    write = McapFile.write

    def interrupted_write(self: McapFile, name: str, data: bytes, *times: int) -> None:
        handed.append((name, data))
        if len(handed) == 500:
            signal.raise_signal(signal.SIGTERM)
        write(self, name, data, *times)

    monkeypatch.setattr(McapFile, 'write', interrupted_write)
    with pytest.raises(Came):
        simulate(load_scenario('demo'), tmp_path / 'bag')
    stream = read_messages(tmp_path / 'bag')
    assert [(message.topic, message.data) for message in stream] == handed
    assert stream.complete
    assert 500 < len(handed) < 2000
