"""msg_docs/ says what the wiring table says."""

import importlib.util
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_pages_are_those_of_the_wiring_table() -> None:
    source = ROOT / 'scripts' / 'make_msg_docs.py'
    spec = importlib.util.spec_from_file_location('make_msg_docs', source)
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    found = {file.name: file.read_text(encoding='utf-8') for file in (ROOT / 'msg_docs').iterdir()}
    assert found == script.pages(), 'run: python scripts/make_msg_docs.py'
