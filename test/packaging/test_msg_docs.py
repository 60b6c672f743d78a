"""msg_docs/ says what the wiring table says, and docs/faults.md what the vocabulary of faults does."""

import importlib.util
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).parents[2]


def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / 'scripts' / f'{name}.py')
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_pages_are_those_of_the_wiring_table() -> None:
    found = {file.name: file.read_text(encoding='utf-8') for file in (ROOT / 'msg_docs').iterdir()}
    assert found == script('make_msg_docs').pages(), 'run: python scripts/make_msg_docs.py'


def test_the_page_of_faults_has_the_tables_of_the_vocabulary() -> None:
    text = (ROOT / 'docs' / 'faults.md').read_text(encoding='utf-8')
    assert text == script('make_fault_docs').page(text), 'run: python scripts/make_fault_docs.py'
