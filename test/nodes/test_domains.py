"""Tests that run side by side never meet in one domain."""

import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

from .domains import DOMAINS, held_domain

HOLDER = """
import sys
from contextlib import ExitStack
from pathlib import Path
from domains import held_domain
with ExitStack() as stack:
    print(*(stack.enter_context(held_domain(Path(sys.argv[1]))) for _ in range(60)), flush=True)
    input()
"""


def test_each_domain_is_held_once_and_free_again_afterwards(tmp_path: Path) -> None:
    for _ in range(2):
        with ExitStack() as stack:
            assert sorted(stack.enter_context(held_domain(tmp_path)) for _ in DOMAINS) == [*DOMAINS]
            with pytest.raises(RuntimeError, match='other tests hold all domains'):
                stack.enter_context(held_domain(tmp_path))


def test_another_process_takes_another_domain_and_leaves_it_when_it_is_killed(tmp_path: Path) -> None:
    other = subprocess.Popen(
        [sys.executable, '-c', HOLDER, tmp_path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        cwd=Path(__file__).parent,
    )
    assert other.stdout is not None
    theirs = {int(word) for word in other.stdout.readline().split()}
    with ExitStack() as stack:
        ours = {stack.enter_context(held_domain(tmp_path)) for _ in range(41)}
        assert theirs | ours == {*DOMAINS}
    other.kill()
    other.communicate()
    with ExitStack() as stack:
        assert len({stack.enter_context(held_domain(tmp_path)) for _ in DOMAINS}) == len(DOMAINS)
